"""MJCF read and written by denavit, compared with MuJoCo's reading of the same MJCF.

`python mjcf.py` prints the counts in docs/formats.md; `python mjcf.py FILE…` prints a line for each file.

Read: denavit converts an MJCF to a URDF, and every body and site is where MuJoCo puts it, at random joint values, with the same mass,
centre and tensor. Written: denavit converts a URDF to an MJCF, MuJoCo compiles it, and every link of the URDF is where the numpy model
of `kinematics.py` puts it. Back: this MJCF becomes a URDF again, and `denavit diff` calls both the same. Mesh files may be
missing: MuJoCo gets a tetrahedron instead of each, and masses that only a mesh determines are left out.
"""

import collections
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from lxml import etree

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parent))

import built  # noqa: E402
import corpus  # noqa: E402
from sdf import Urdf  # noqa: E402

VECTORS = 4
# Relative to the robot's size; for masses and tensors relative to their own size.
NEAR = 1e-9
# Mass of a moving body without mass.
LEAST = 1e-12


def denavit(*arguments):
    """(standard output, lines of standard error); raises with its message."""
    run = subprocess.run([built.denavit(), *map(str, arguments)], capture_output=True, text=True)
    if run.returncode:
        raise ValueError((run.stderr.strip() or run.stdout.strip()).splitlines()[0][:300])
    return run.stdout, run.stderr.splitlines()


def compiled(path):
    """MuJoCo's model, with a tetrahedron instead of each mesh."""
    import mujoco

    spec = mujoco.MjSpec.from_file(str(path))
    for mesh in spec.meshes:
        mesh.file, mesh.uservert, mesh.userface = "", [0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1], [0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3]
    for texture in list(spec.textures):
        spec.delete(texture)
    for material in spec.materials:
        material.textures = [""] * len(material.textures)
    return spec.compile()


class Mujoco:
    """A compiled model: poses of its bodies and sites, and masses."""

    def __init__(self, model):
        import mujoco

        self.lib, self.model, self.data = mujoco, model, mujoco.MjData(model)
        name = lambda kind, index: mujoco.mj_id2name(model, kind, index)  # noqa: E731
        self.joints = [(name(mujoco.mjtObj.mjOBJ_JOINT, j), j) for j in range(model.njnt)]
        self.bodies = [name(mujoco.mjtObj.mjOBJ_BODY, b) for b in range(model.nbody)]
        self.sites = [name(mujoco.mjtObj.mjOBJ_SITE, s) for s in range(model.nsite)]
        one = {int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE)}
        self.one = {n: j for n, j in self.joints if n and int(model.jnt_type[j]) in one}
        if model.njnt > 1 and not self.one:
            raise ValueError("no joint of the model moves")

    def set(self, values):
        # Ball and free joints stay at their values in the model.
        self.data.qpos[:] = self.model.qpos0
        for name, value in values.items():
            self.data.qpos[self.model.jnt_qposadr[self.one[name]]] = value
        self.lib.mj_kinematics(self.model, self.data)

    def frames(self):
        found = {}
        for kind, names in (("body", self.bodies), ("site", self.sites)):
            p = self.data.xpos if kind == "body" else self.data.site_xpos
            r = self.data.xmat if kind == "body" else self.data.site_xmat
            for index, name in enumerate(names):
                if name:
                    pose = np.eye(4)
                    pose[:3, :3], pose[:3, 3] = r[index].reshape(3, 3), p[index]
                    found.setdefault(name, pose)
        return found

    def inertias(self):
        for index in range(1, self.model.nbody):
            turn = np.zeros(9)
            self.lib.mju_quat2Mat(turn, self.model.body_iquat[index])
            turn = turn.reshape(3, 3)
            tensor = turn @ np.diag(self.model.body_inertia[index]) @ turn.T
            yield self.bodies[index], self.model.body_mass[index], self.model.body_ipos[index], tensor


def compared(theirs, urdf, rng, stated=None, changed=()):
    """(frames, largest pose difference over size, masses, largest difference of mass, centre or tensor)."""
    worst, size, count = 0.0, 0.1, 0
    drivers = [name for name in theirs.one if name in urdf.by_name and urdf.by_name[name].mimic is None]
    for _ in range(VECTORS):
        own = {name: rng.uniform(-1, 1) for name in drivers}
        values = {name: urdf.value(name, own) if name in urdf.by_name else 0.0 for name in theirs.one}
        for name in values:
            # A slide that comes from a screw joint of the URDF.
            screw = name.removesuffix("_slide")
            if name not in urdf.by_name and screw in urdf.pitch:
                values[name] = urdf.value(screw, own) * urdf.pitch[screw]
        theirs.set(values)
        found, ours = theirs.frames(), urdf.poses(own)
        common = [name for name in ours if name in found and (name != "world" or urdf.root == "world")]
        missing = [name for name in ours if name not in found and name in urdf.links and stated is None]
        if missing:
            raise ValueError(f"link {missing[0]} is not in MuJoCo's model")
        to_ours = ours[common[0]] @ np.linalg.inv(found[common[0]])
        for name in common:
            worst = max(worst, np.abs(to_ours @ found[name] - ours[name]).max())
            size = max(size, np.linalg.norm(ours[name][:3, 3] - ours[common[0]][:3, 3]))
            count += 1
    heavy, masses = 0.0, 0
    for name, mass, centre, tensor in theirs.inertias():
        if (stated is not None and name not in stated) or name in changed or name not in urdf.links:
            continue
        own_mass, own_centre, own_tensor = urdf.inertia(name)
        if mass <= LEAST and own_mass <= LEAST:
            continue
        masses += 1
        if own_mass <= 0:
            heavy = max(heavy, 1.0)
            continue
        scale = np.linalg.norm(own_tensor) or 1.0
        off = [abs(mass - own_mass) / own_mass, np.abs(centre - own_centre).max(), np.linalg.norm(tensor - own_tensor) / scale]
        heavy = max(heavy, *off)
    return count, worst / size, masses, heavy


def stated_masses(path):
    """Names of the bodies whose mass does not come from a mesh, includes and classes as MuJoCo resolves them."""
    import mujoco

    spec = mujoco.MjSpec.from_file(str(path))
    mesh = int(mujoco.mjtGeom.mjGEOM_MESH)
    return {b.name for b in spec.bodies if b.explicitinertial or not any(int(g.type) == mesh for g in b.geoms)}


def read(path, rng):
    """A line of figures for one MJCF."""
    text, _ = denavit("export", path, "--to", "urdf")
    urdf = Urdf(etree.fromstring(text.encode()))
    return compared(Mujoco(compiled(path)), urdf, rng, stated_masses(path))


def losses(lines):
    """(what, reason without names and numbers) of every kind of loss, and the bodies whose inertia was changed."""
    kinds, changed = collections.Counter(), set()
    for line in lines:
        if found := re.match(r'note: lost: .*?:\d+: (\w+ "(?P<name>.*?)"|.*?): (?P<loss>.*)', line):
            loss = found["loss"]
            more = re.search(r"\(and (\d+) more like it\)$", loss)
            what = re.sub(r"\(and \d+ more like it\)$|\"[^\"]*\"|[-+]?\d[\d.e+-]*", "…", loss)
            what = " ".join(what.split())
            kinds[what.split(": ")[0] + ": " + what.split(": ", 1)[-1].rstrip("… ")[:90]] += 1 + (int(more[1]) if more else 0)
    return kinds, changed


def written(path, folder, rng):
    """(figures, losses, whether the round trip gives the same robot) for one URDF."""
    out, back, home = folder / "out.xml", folder / "back.urdf", folder / "home.urdf"
    for file in (out, back, home, Path(f"{out}.denavit.json")):
        file.unlink(missing_ok=True)
    _, said = denavit("export", path, "--fix-inertia", "-o", out)
    kinds, _ = losses(said)
    sidecar = Path(f"{out}.denavit.json")
    changed = set()
    if sidecar.exists():
        import json

        for loss in json.loads(sidecar.read_text())["losses"]:
            if loss["what"] == "its inertia":
                changed.add(loss["element"].split('"')[1])
    parser = etree.XMLParser(remove_comments=True, recover=True, huge_tree=True)
    urdf = Urdf(etree.fromstring(path.read_bytes(), parser))
    figures = compared(Mujoco(compiled(out)), urdf, rng, None, changed)
    if sidecar.exists():
        denavit("export", out, "-o", home)
        if home.read_bytes() != path.read_bytes():
            raise ValueError("the sidecar does not bring the URDF back")
        sidecar.unlink()
    denavit("export", out, "-o", back)
    verdict = subprocess.run(
        [built.denavit(), "diff", path, out, "--exact"], capture_output=True, text=True
    )
    return figures, kinds, verdict.returncode == 0, verdict.stdout


def models():
    """MJCF files from other sources, without scenes that only include them."""
    folder = Path(os.environ.get("DENAVIT_MJCF", corpus.SHARED / "vendor/mjcf"))
    return [path for path in sorted(folder.rglob("*.xml")) if "<worldbody>" in path.read_text()]


def main(files):
    rng = np.random.default_rng(0)
    if files:
        for path in map(Path, files):
            if path.suffix == ".urdf":
                with tempfile.TemporaryDirectory() as folder:
                    figures, kinds, same, said = written(path, Path(folder), rng)
                    print(path, *figures, "same" if same else said, dict(kinds))
            else:
                print(path, *read(path, rng))
        return
    exact, frames, masses, refused, off = 0, 0, 0, [], []
    found = models()
    for path in found:
        try:
            count, apart, weighed, heavy = read(path, rng)
        except Exception as why:  # noqa: BLE001
            refused.append(f"{path.parent.name}/{path.name}: {why}")
            continue
        frames, masses = frames + count, masses + weighed
        if apart <= NEAR and heavy <= NEAR:
            exact += 1
        else:
            off.append(f"{path.parent.name}/{path.name}: frames {apart:.1e}, masses {heavy:.1e}")
    print(f"read: {len(found)} MJCF files, {exact} as MuJoCo reads them ({frames} frames, {masses} masses), {len(refused)} not compared")
    print(*(f"  {line}" for line in [*off, *refused]), sep="\n")
    total, exact, same, refused, off, differ, kinds = 0, 0, 0, [], [], [], collections.Counter()
    with tempfile.TemporaryDirectory() as folder:
        for source, path in corpus.files():
            total += 1
            try:
                (count, apart, weighed, heavy), lost, back, said = written(path, Path(folder), rng)
            except Exception as why:  # noqa: BLE001
                refused.append(f"{source} {path.name}: {why}")
                continue
            kinds.update(lost.keys())
            if apart <= NEAR and heavy <= NEAR:
                exact += 1
            else:
                off.append(f"{source} {path.name}: frames {apart:.1e}, masses {heavy:.1e}")
            if back:
                same += 1
            else:
                differ.append(f"{source} {path.name}: {' | '.join(said.splitlines()[1:4])}")
    print(f"written: {total} URDF files, {exact} as the URDF says in MuJoCo, {same} the same by diff, {len(refused)} not compared")
    for title, lines in (("off", off), ("different", differ), ("not compared", refused)):
        print(f"{title}:", *(f"  {line}" for line in lines), sep="\n")
    print("losses, in how many files:")
    print(*(f"  {count:4} {kind}" for kind, count in kinds.most_common()), sep="\n")


if __name__ == "__main__":
    main(sys.argv[1:])
