"""SDF read and written by denavit, compared with Drake's reading of the same SDF.

`python sdf.py` prints the counts in docs/formats.md; `python sdf.py FILE…` prints a line for each file.

Read: denavit converts an SDF to a URDF; every link is where Drake puts it, at joint values 0 and at random ones, with the same mass,
centre and tensor. Written: denavit converts a URDF to an SDF, Drake reads it, and every link of the URDF is where the numpy model of
`kinematics.py` puts it. Shapes, sensors and joints that close loops are removed before Drake reads the file.
"""

import collections
import functools
import logging
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
from lxml import etree

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import built  # noqa: E402
import corpus  # noqa: E402
from kinematics import Tree, exp_twist, numbers, rot_x, rot_y, rot_z, translation  # noqa: E402

VECTORS = 4
# Relative to the robot's size; in kg and kg·m².
NEAR = 1e-9
DRAKE = "{http://drake.mit.edu}"
# Elements that do not move a link.
APART = ("visual", "collision", "material", "sensor", "plugin", "gripper", "physics", "surface", "gazebo", "transmission")


def program(name):
    return built.target() / "debug" / "examples" / name


def converted(name, path):
    """(text, lines of standard error) of one of the example programs; raises with its message."""
    run = subprocess.run([program(name), path], capture_output=True, text=True)
    if run.returncode:
        raise ValueError(run.stderr.strip().splitlines()[-1][:300])
    return run.stdout[run.stdout.index("<?xml") :], run.stderr.splitlines()


def without(root, tags):
    for tag in tags:
        for element in list(root.iter(tag)):
            if element.getparent() is not None:
                element.getparent().remove(element)


def rotation(origin):
    """Rotation of an `<origin>`, from its angles or its quaternion."""
    if origin is None:
        return np.eye(3)
    if origin.get("quat_xyzw"):
        x, y, z, w = numbers(origin.get("quat_xyzw"), ())
        k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        return np.eye(3) + 2 * (w * k + k @ k) / (x * x + y * y + z * z + w * w)
    roll, pitch, yaw = numbers(origin.get("rpy"), (0, 0, 0))
    return (rot_z(yaw) @ rot_y(pitch) @ rot_x(roll))[:3, :3]


class Urdf:
    """Poses and masses of the links of a URDF."""

    def __init__(self, root):
        self.joints, self.pitch = [], {}
        for element in root:
            if element.tag in ("joint", f"{DRAKE}joint"):
                joint = Tree._joint(element)
                joint.origin[:3, :3] = rotation(element.find("origin"))
                pitch = element.find(f"{DRAKE}screw_thread_pitch")
                if pitch is not None:
                    self.pitch[joint.name] = float(pitch.get("value")) / (2 * np.pi)
                self.joints.append(joint)
        self.by_name = {joint.name: joint for joint in self.joints}
        self.links = {link.get("name"): link for link in root.findall("link")}
        children = {joint.child for joint in self.joints}
        self.root = next(name for name in [*self.links, "world"] if name not in children)
        self.below = collections.defaultdict(list)
        for joint in self.joints:
            self.below[joint.parent].append(joint)

    def value(self, joint, values):
        multiplier, offset, name = 1.0, 0.0, joint
        while name in self.by_name and self.by_name[name].mimic is not None:
            name, factor, more = self.by_name[name].mimic
            offset += multiplier * more
            multiplier *= factor
        return multiplier * values.get(name, 0.0) + offset

    def poses(self, values):
        """root_from_link, by name."""
        found, waiting = {self.root: np.eye(4)}, [self.root]
        while waiting:
            link = waiting.pop()
            for joint in self.below[link]:
                value = self.value(joint.name, values)
                motion = joint.motion(value)
                if joint.kind == "screw":
                    axis = joint.axis / np.linalg.norm(joint.axis)
                    motion = exp_twist(np.concatenate([axis * value, axis * value * self.pitch[joint.name]]))
                found[joint.child] = found[link] @ joint.origin @ motion
                waiting.append(joint.child)
        return found

    def inertia(self, link):
        """(mass, centre, tensor about the centre in the link's axes)."""
        inertial = self.links[link].find("inertial") if link in self.links else None
        if inertial is None:
            return 0.0, np.zeros(3), np.zeros((3, 3))
        origin, mass, inertia = inertial.find("origin"), inertial.find("mass"), inertial.find("inertia")
        centre = numbers(origin.get("xyz") if origin is not None else None, (0, 0, 0))
        turn = rotation(origin)
        entry = lambda name: float(inertia.get(name, 0)) if inertia is not None else 0.0  # noqa: E731
        xx, xy, xz, yy, yz, zz = (entry(name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
        tensor = turn @ np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) @ turn.T
        return float(mass.get("value", 0)) if mass is not None else 0.0, centre, tensor


def physical(mass, tensor):
    """Whether a body can have this tensor: Drake replaces impossible ones."""
    a, b, c = np.sort(np.linalg.eigvalsh(tensor))
    return mass > 0 and a >= 0 and a + b >= c * (1 - 1e-6)


class Drake:
    """An SDF as Drake reads it."""

    def __init__(self, text):
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import MultibodyPlant

        logging.disable(logging.CRITICAL)
        self.plant = MultibodyPlant(0.0)
        parser = Parser(self.plant)
        parser.SetAutoRenaming(True)
        parser.AddModelsFromString(text, "sdf")
        self.plant.Finalize()
        self.context = self.plant.CreateDefaultContext()
        self.joints = [self.plant.get_joint(index) for index in self.plant.GetJointIndices()]

    def set(self, values):
        q = self.plant.GetPositions(self.context).copy()
        for joint in self.joints:
            start = joint.position_start()
            for index, name in enumerate(self.names(joint)):
                q[start + index] = values[name]
        self.plant.SetPositions(self.context, q)

    @staticmethod
    def names(joint):
        """Names of a joint's coordinates in denavit's URDF."""
        count, name = joint.num_positions(), joint.name()
        ends = {0: [], 1: [""], 2: ["_axis", "_axis2"], 3: ["_x", "_y", "_z"]}.get(count, [])
        return [name + end for end in ends]

    def scope(self, thing):
        model = self.plant.GetModelInstanceName(thing.model_instance()).split("::")[1:]
        return "::".join([*model, thing.name()])

    def frames(self):
        """world_from_frame of every body and frame, by name."""
        from pydrake.multibody.tree import FrameIndex

        found = {}
        for index in range(self.plant.num_frames()):
            frame = self.plant.get_frame(FrameIndex(index))
            if frame.name():
                found.setdefault(self.scope(frame), frame.CalcPoseInWorld(self.context).GetAsMatrix4())
        return found

    def inertias(self):
        from pydrake.multibody.tree import BodyIndex

        for index in range(1, self.plant.num_bodies()):
            body = self.plant.get_body(BodyIndex(index))
            inertia = body.default_spatial_inertia()
            centre = inertia.get_com()
            about = inertia.Shift(centre).CalcRotationalInertia().CopyToFullMatrix3() if body.default_mass() > 0 else 0
            yield self.scope(body), body.default_mass(), centre, about


def compared(drake, urdf, names, rng):
    """(poses, largest pose difference over size, size, largest inertia difference, links without a physical tensor)."""
    worst, size, count = 0.0, 0.1, 0
    coordinates = [name for joint in drake.joints for name in drake.names(joint)]
    for turn in range(1 + VECTORS):
        free = {name: rng.uniform(-1, 1) if turn else 0.0 for name in coordinates}
        own = {names.get(name, name): value for name, value in free.items()}
        values = {name: urdf.value(names.get(name, name), own) for name in coordinates}
        drake.set(values)
        theirs, ours = drake.frames(), urdf.poses(own)
        common = [name for name in ours if name in theirs and name != "world"]
        missing = [name for name in ours if name not in theirs and name in urdf.links and not name.startswith("world")]
        if turn == 0 and missing and not common:
            raise ValueError(f"no link is found: {missing[:3]}")
        base = common[0]
        to_ours = ours[base] @ np.linalg.inv(theirs[base])
        for name in common:
            worst = max(worst, np.abs(to_ours @ theirs[name] - ours[name]).max())
            size = max(size, np.linalg.norm(ours[name][:3, 3] - ours[base][:3, 3]))
            count += 1
    heavy, replaced = 0.0, 0
    for name, mass, centre, tensor in drake.inertias():
        own_mass, own_centre, own_tensor = urdf.inertia(name)
        if own_mass == 0 and mass == 0:
            continue
        if not physical(own_mass, own_tensor):
            replaced += 1
            continue
        heavy = max(heavy, abs(mass - own_mass), np.abs(centre - own_centre).max(), np.abs(tensor - own_tensor).max())
    return count, worst / size, size, heavy, replaced


def of_sdf(path):
    """An SDF: Drake's reading against ours."""
    urdf, _ = converted("sdf_to_urdf", path)
    tree = etree.fromstring(urdf.encode())
    loops = {j.get("name") for g in tree.findall("gazebo") if g.get("reference") is None for j in g.findall("joint")}
    raw = re.sub(rb"^.*?(?=<(sdf|gazebo)\b)", b"", Path(path).read_bytes(), count=1, flags=re.S)
    # Drake reads no root <gazebo>, which 1.2 has.
    raw = re.sub(rb"<gazebo version=.1.2.>", b"<sdf version='1.3'>", raw).replace(b"</gazebo>", b"</sdf>")
    root = etree.fromstring(raw)
    without(root, APART)
    links, names = {link.get("name") for link in root.iter("link")}, {}
    for joint in list(root.iter("joint")):
        name = joint.get("name")
        if name in loops or joint.get("type") == "gearbox":
            joint.getparent().remove(joint)
        elif name in links:
            # Old files use the same name for a link and a joint, which Drake refuses.
            joint.set("name", f"{name}__joint")
            names[f"{name}__joint"] = name
    result = compared(Drake(etree.tostring(root).decode()), Urdf(tree), names, np.random.default_rng(0))
    return (*result, len(loops))


@functools.cache
def joints_of(path):
    return Tree(path)


def of_urdf(path):
    """A URDF written as SDF: Drake's reading of it against numpy's of the URDF; and the losses."""
    sdf, losses = converted("urdf_to_sdf", path)
    root = etree.fromstring(sdf.encode())
    # A robot with the name of one of Drake's own does not matter for the conversion.
    without(root, APART)
    original = etree.parse(str(path)).getroot()
    urdf = Urdf(original)
    names = {}
    for loss in losses:
        if found := re.search(r'name of joint "(.*)": .*called "(.*)" there', loss):
            names[found[2]] = found[1]
    drake = Drake(etree.tostring(root).decode())
    lost = collections.Counter(kind_of(loss) for loss in losses)
    return (*compared(drake, urdf, names, np.random.default_rng(0)), lost)


def kind_of(loss):
    """A loss without its location and names."""
    what = re.sub(r"^.*?:\d+: ", "", loss)
    # The element that it stands in, twice where it is lost itself.
    what = re.sub(r'^(?:(?:link|joint) "[^"]*"|<[^>]*>(?: in gazebo[^:]*)?|\S+(?: of)? "[^"]*"|\S+): ', "", what)
    what = re.sub(r'"[^"]*"', "…", what)
    what = re.sub(r"<[^>]*> in gazebo[^:]*", "word of URDF's own in <gazebo>", what)
    return re.sub(r":? (SDF has no|it exists only|names of|SDF needs).*", "", what)[:90]


def sdf_files():
    folders = [corpus.SHARED / "vendor/sdf", corpus.SHARED / "wild", corpus.SITE_PACKAGES]
    return [path for folder in folders if folder.is_dir() for path in sorted(folder.rglob("*.sdf"))]


def report(out=print):
    """The counts; the results of both directions."""
    read, refused = {}, {}
    for path in sdf_files():
        try:
            read[path] = of_sdf(path)
        except Exception as error:  # noqa: BLE001 - refusals are counted by their message.
            refused[path] = str(error).replace("\n", " ")[:160]
    out(f"SDF read: {len(read)} of {len(read) + len(refused)} files compared with Drake")
    if read:
        out(
            f"  {sum(r[0] for r in read.values())} poses, largest difference {max(r[1] for r in read.values()):.1e} of the "
            f"robot's size; masses, centres, tensors: {max(r[3] for r in read.values()):.1e}; "
            f"{sum(r[5] for r in read.values())} joints close loops"
        )
    for path, why in refused.items():
        out(f"  not compared: {path.parent.name}/{path.name}: {why}")
    written, kinds, failed = {}, collections.Counter(), {}
    for _, path in corpus.files():
        try:
            written[path] = of_urdf(path)
            kinds.update(written[path][5].keys())
        except Exception as error:  # noqa: BLE001
            failed[path] = str(error).replace("\n", " ")[:160]
    near = [p for p, r in written.items() if r[1] <= NEAR and r[3] <= NEAR]
    out(f"URDF written: {len(written)} of {len(written) + len(failed)} files read by Drake, {len(near)} of them equal to {NEAR}")
    if written:
        out(f"  {sum(r[0] for r in written.values())} poses, largest difference {max(r[1] for r in written.values()):.1e} of the size; "
            f"inertia {max(r[3] for r in written.values()):.1e}; {sum(r[4] for r in written.values())} links have no physical tensor")
        out(f"  nothing lost: {sum(not r[5] for r in written.values())} files")
    for kind, count in kinds.most_common():
        out(f"  lost in {count:3} files: {kind}")
    for path, result in written.items():
        if path not in near:
            out(f"  differs: {path.name}: {result[1]:.1e} {result[3]:.1e}")
    for path, why in failed.items():
        out(f"  not compared: {path.name}: {why[-140:]}")
    return read, refused, written, failed


if __name__ == "__main__":
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    if sys.argv[1:]:
        for name in sys.argv[1:]:
            print(name, (of_sdf if name.endswith(".sdf") else of_urdf)(Path(name)))
    else:
        report()
