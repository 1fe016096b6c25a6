"""Every operation of `denavit edit` on every available URDF: done, refused with the reason, wrong. Prints Markdown tables.

    python tests/oracle/edits.py [EVERY] [FIRST]      # one file in EVERY, from FIRST (0) on

Four readers decide what is right: yourdfpy (poses of all links, mimic joints followed), pinocchio (poses of all links, total mass,
its centre, principal moments, and the joint-space inertia with a floating base, which does not depend on the frames or the
root), MuJoCo (links, shapes, each link's mass and centre, joint ranges), and `denavit diff` of the file before and the file
that was edited there and back. Missing meshes are made here, so that each operation on meshes has something to read.
"""

import logging
import os
import re
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

import mujoco
import numpy as np
import pinocchio
import trimesh
import yourdfpy
from lxml import etree
from scipy.spatial import ConvexHull, cKDTree
from scipy.spatial.transform import Rotation

import corpus
from built import denavit
from kinematics import distance

MOVING = ("revolute", "continuous", "prismatic")
SAME = 1e-9  # of the robot's size, and rad
NOT_MOVED = 3e-6  # m: MuJoCo leaves out what moves a frame by less than 1e-6
MASSES = 1e-7  # of the largest number
ROUNDED = 5e-3  # error of literals such as 1.57, accumulated along a chain
CONFIGURATIONS = 2  # the first at 0
LEAST_SEEN = 1e-6  # kg: MuJoCo's bound on the mass of a link that moves
PACKAGES = corpus.SOURCES["example-robot-data"].parents[1]
GRIPPER = """<robot name="gripper">
  <link name="palm"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <visual><geometry><box size="0.1 0.2 0.3"/></geometry></visual></link>
  <link name="finger"/>
  <joint name="slide" type="prismatic"> <parent link="palm"/> <child link="finger"/> <axis xyz="0 1 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/> </joint>
</robot>
"""
MOST_BYTES = 2_000_000
WORLD = "the link world"
COMPILER = (
    '<mujoco><compiler fusestatic="false" discardvisual="false" balanceinertia="true" inertiafromgeom="false" boundmass="1e-6" boundinertia="1e-12"/></mujoco>'
)


logging.disable(logging.CRITICAL)
# Otherwise it writes a log beside the program.
mujoco.set_mju_user_warning(lambda words: None)


def identity(name):
    return name


@dataclass
class Case:
    """An operation, and what must be true afterwards."""

    name: str
    words: list
    # Poses of links are relative to this one, by its old name.
    base: str
    link: object = identity
    # The joint's new name, its sense, and the offset of its value.
    joint: object = lambda name: (name, 1.0, 0.0)
    # Transform of points in the base frame.
    space: np.ndarray = field(default_factory=lambda: np.eye(3))
    scale: float = 1.0
    # Whether link frames stay; otherwise each may differ by a step that does not depend on joint values.
    frames: bool = True
    # Links that keep their masses; None: only the robot's total.
    links: set | None = None
    # Whether each link keeps its mass and its shapes: not if links are merged.
    each: bool = True
    shapes: bool = True
    collisions: bool = True
    # The motion from base to tip is that of another file.
    actual: tuple | None = None
    # The operations that undo it.
    back: list | None = None
    # Tolerance of poses, rad and times the robot's size.
    near: float = SAME


class Description:
    """A URDF's text as XML: names, and the tree of links."""

    def __init__(self, path):
        self.root = etree.parse(str(path), etree.XMLParser(remove_comments=True, huge_tree=True)).getroot()
        self.links = [link.get("name") for link in self.root.findall("link")]
        self.joints = {}
        for joint in self.root.findall("joint"):
            parent, child = joint.find("parent"), joint.find("child")
            if parent is not None and child is not None:
                self.joints[joint.get("name")] = (joint.get("type"), parent.get("link"), child.get("link"), joint.find("mimic") is not None)
        children = {child for _, _, child, _ in self.joints.values()}
        roots = [link for link in self.links if link not in children]
        self.base = roots[0] if roots else None

    def below(self, link):
        found, new = {link}, [link]
        while new:
            at = new.pop()
            for _, parent, child, _ in self.joints.values():
                if parent == at and child not in found:
                    found.add(child)
                    new.append(child)
        return found

    def way(self, link):
        """Joints from the root to a link."""
        by_child = {child: name for name, (_, _, child, _) in self.joints.items()}
        way = []
        while link in by_child:
            way.append(by_child[link])
            link = self.joints[by_child[link]][1]
        return way[::-1]


def numbers(element, name, default):
    text = element.get(name) if element is not None else None
    return np.array([float(word) for word in text.split()]) if text else np.array(default, float)


def disturbed(robot, tip, to):
    """A file in which the joints on the way to the tip are turned by about 0.1 mrad and moved by about 0.1 mm."""
    copy = etree.fromstring(etree.tostring(robot.root))
    random = np.random.default_rng(3)
    way = [name for name in robot.way(tip) if robot.joints[name][0] in MOVING]
    for joint in copy.findall("joint"):
        if joint.get("name") in way:
            origin = joint.find("origin")
            if origin is None:
                origin = etree.SubElement(joint, "origin")
            xyz = numbers(origin, "xyz", [0, 0, 0]) + 1e-4 * random.uniform(-1, 1, 3)
            rpy = numbers(origin, "rpy", [0, 0, 0]) + 1e-4 * random.uniform(-1, 1, 3)
            origin.set("xyz", " ".join(map(repr, map(float, xyz))))
            origin.set("rpy", " ".join(map(repr, map(float, rpy))))
    # Only the chain, so that it is the file's own chain.
    kept = set()
    for name in robot.way(tip):
        kept |= set(robot.joints[name][1:3])
    on_way = set(robot.way(tip))
    for child in list(copy):
        if not (child.tag == "link" and child.get("name") in kept or child.tag == "joint" and child.get("name") in on_way):
            copy.remove(child)
    to.write_bytes(etree.tostring(copy))


def cases(robot, folder):
    """The operations to try on a robot; joints and links are picked by index."""
    base = robot.base
    moving = [name for name, (kind, _, _, mimic) in robot.joints.items() if kind in MOVING and not mimic]
    parents = {parent for _, parent, _, _ in robot.joints.values()}
    leaves = [link for link in robot.links if link not in parents]
    leaf = leaves[-1]
    middle = moving[len(moving) // 2] if moving else None
    found = []
    if middle:
        value = lambda sense, shift: lambda name: (name, sense, shift) if name == middle else (name, 1.0, 0.0)
        found.append(Case("flip", ["flip", middle], base, joint=value(-1.0, 0.0), back=["flip", middle]))
        found.append(Case("zero", ["zero", f"{middle}=0.25"], base, joint=value(1.0, -0.25), back=["zero", f"{middle}=-0.25"]))
    if leaf != base:
        found.append(Case("reroot", ["reroot", leaf], leaf, back=["reroot", base]))
    links = {leaf: "another_link"}
    joints = {middle: "another_joint"} if middle else {}
    words = [f"link:{old}={new}" for old, new in links.items()] + [f"joint:{old}={new}" for old, new in joints.items()]
    back = [f"link:{new}={old}" for old, new in links.items()] + [f"joint:{new}={old}" for old, new in joints.items()]
    found.append(
        Case("rename", ["rename", *words], base, link=lambda name: links.get(name, name),
             joint=lambda name: (joints.get(name, name), 1.0, 0.0), back=["rename", *back])
    )
    back = [f"link:p_{name}={name}" for name in robot.links] + [f"joint:p_{name}={name}" for name in robot.joints]
    found.append(
        Case("prefix", ["prefix", "p_"], base, link=lambda name: f"p_{name}", joint=lambda name: (f"p_{name}", 1.0, 0.0),
             back=["rename", *back])
    )
    found.append(Case("merge", ["merge"], base, each=False))
    (folder / "gripper.urdf").write_text(GRIPPER)
    attach = ["attach", str(folder / "gripper.urdf"), "--at", leaf, "--pose", "0.1,0,0.2,0,0,90deg", "--prefix", "gripper_"]
    found.append(Case("attach", attach, base, links=set(robot.links), back=["cut", "gripper_palm"]))
    if middle:
        child = robot.joints[middle][2]
        below = robot.below(child)
        found.append(Case("extract", ["extract", child], child, links=below))
        found.append(Case("cut", ["cut", child], base, links=set(robot.links) - below))
    for plane, at in (("xz", 1), ("yz", 0)):
        space = np.eye(3)
        space[at, at] = -1.0
        found.append(Case("mirror", ["mirror", plane], base, space=space, back=["mirror", plane]))
    if middle and (way := [name for name in robot.way(leaf) if robot.joints[name][0] in MOVING]):
        source = folder / "actual.urdf"
        disturbed(robot, leaf, source)
        first, last = robot.joints[way[0]][1], leaf
        found.append(
            Case("set-calibration", ["set-calibration", str(source)], base, frames=False, shapes=False, each=False, links=set(),
                 actual=(source, first, last))
        )
    found.append(Case("canonical", ["canonical"], base, frames=False))
    pose = "0.1,-0.2,0.3,10deg,20deg,-30deg"
    turn = Rotation.from_euler("xyz", [10, 20, -30], degrees=True).inv()
    place = [*(-turn.apply([0.1, -0.2, 0.3])), *turn.as_euler("xyz")]
    if leaf != base:
        found.append(Case("origin", ["origin", leaf, "--to", pose], base, frames=False, back=["origin", leaf, "--to", ",".join(map(repr, map(float, place)))]))
    found.append(Case("recentre", ["recentre"], base, frames=False))
    for shape in ("smallest", "hull"):
        found.append(Case("simplify-collision", ["simplify-collision", shape, "--to", "hulls"], base, collisions=False))
    found.append(Case("meshes", ["meshes", "--to", "copies"], base))
    found.append(Case("snap", ["snap"], base, near=ROUNDED))
    found.append(Case("scale", ["scale", "2"], base, scale=2.0, back=["scale", "0.5"]))
    # MuJoCo ignores a displacement below 1 µm; an inch is far above.
    found.append(Case("units", ["units", "in"], base, scale=0.0254))
    return found


# ---------------------------------------------------------------------------------------------------------------- meshes


def blob(seed):
    """The hull of a few points: a mesh that is not a box."""
    points = np.random.default_rng(seed).normal(size=(14, 3)) * [0.05, 0.08, 0.12] + [0.02, 0.0, 0.05]
    return trimesh.convex.convex_hull(points)


def collada(mesh):
    points = " ".join(repr(float(x)) for x in mesh.vertices.ravel())
    corners = " ".join(str(int(x)) for x in mesh.faces.ravel())
    return f"""<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
 <asset><unit meter="1" name="meter"/><up_axis>Z_UP</up_axis></asset>
 <library_geometries><geometry id="g"><mesh>
  <source id="p"><float_array id="a" count="{mesh.vertices.size}">{points}</float_array><technique_common>
   <accessor source="#a" count="{len(mesh.vertices)}" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor>
  </technique_common></source>
  <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
  <triangles count="{len(mesh.faces)}"><input semantic="VERTEX" source="#v" offset="0"/><p>{corners}</p></triangles>
 </mesh></geometry></library_geometries>
 <library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes>
 <scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def write_mesh(path, seed):
    path.parent.mkdir(parents=True, exist_ok=True)
    mesh = blob(seed)
    if path.suffix.lower() == ".dae":
        path.write_text(collada(mesh))
    elif path.suffix.lower() in (".stl", ".obj"):
        mesh.export(path, file_type=path.suffix.lower()[1:])
    else:
        path.write_text("a mesh in a form of its own\n")


def put_meshes(robot, path, packages):
    """Makes the missing mesh files, and all if they are large. Returns their paths by the names in the robot."""
    places = {}
    names = sorted({mesh.get("filename", "").strip() for mesh in robot.root.iter("mesh")})
    own = [PACKAGES / name.removeprefix("package://") for name in names if name.startswith("package://")]
    at_hand = sum(place.stat().st_size for place in own if place.is_file()) <= MOST_BYTES
    for seed, name in enumerate(names):
        if name.startswith("package://"):
            rest = name.removeprefix("package://")
            place = PACKAGES / rest
            if not (at_hand and place.is_file()):
                place = packages / rest
                (packages / rest.split("/")[0]).mkdir(parents=True, exist_ok=True)
                (packages / rest.split("/")[0] / "package.xml").write_text(f"<package><name>{rest.split('/')[0]}</name></package>")
        elif ":" in name or name.startswith("/") or not name:
            continue
        else:
            place = path.parent / name
        if not place.is_file():
            write_mesh(place, seed)
        places[name] = place
    return places


# --------------------------------------------------------------------------------------------------------------- readers


class NotRead(Exception):
    """A reader refuses the file."""


class Yourdfpy:
    """Poses of all links; mimic joints follow."""

    def __init__(self, path):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                self.robot = yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=True, load_collision_meshes=False)
        except Exception as error:
            raise NotRead(f"yourdfpy: {error}") from error
        if any(joint.type not in (*MOVING, "fixed") for joint in self.robot.robot.joints):
            raise NotRead("yourdfpy places no floating and no planar joint")
        if not all(joint.name for joint in self.robot.robot.joints):
            raise NotRead("joints have no names")
        self.joints = {joint.name for joint in self.robot.actuated_joints}
        self.known = {}
        # Starts at the root: a walk from the root to each link is slow.
        by_parent = {}
        for joint in self.robot.robot.joints:
            by_parent.setdefault(joint.parent, []).append(joint)
        self.order, new = [], [self.robot.base_link]
        while new:
            for joint in by_parent.get(new.pop(), ()):
                self.order.append(joint)
                new.append(joint.child)
        # A file may have links without a connection to its root.
        self.links = {self.robot.base_link, *(joint.child for joint in self.order)}

    def frames(self, values, base):
        q = {joint.name: values.get(joint.name, 0.0) for joint in self.robot.actuated_joints}
        asked = tuple(q.values())
        if asked not in self.known:
            self.robot.update_cfg(q)
            found = {self.robot.base_link: np.eye(4)}
            for joint in self.order:
                found[joint.child] = found[joint.parent] @ self.robot.get_transform(joint.child, joint.parent)
            self.known[asked] = found
        found = self.known[asked]
        inverse = np.linalg.inv(found[base])
        return {link: inverse @ pose for link, pose in found.items()}


class Pinocchio:
    """Poses of all links, and their total mass; every joint has a value of its own."""

    def __init__(self, path):
        try:
            self.model = pinocchio.buildModelFromUrdf(str(path), pinocchio.JointModelFreeFlyer())
        except Exception as error:
            raise NotRead(f"pinocchio: {error}") from error
        self.data = self.model.createData()
        of_body = [frame for frame in self.model.frames if frame.type == pinocchio.FrameType.BODY]
        self.bodies = {frame.name: self.model.getFrameId(frame.name, pinocchio.FrameType.BODY) for frame in of_body}
        self.links = set(self.bodies)
        one = [index for index in range(2, self.model.njoints) if self.model.joints[index].nv == 1]
        self.joints = {self.model.names[index] for index in one}
        self.where = {self.model.names[index]: index for index in one}

    def configuration(self, values):
        q = pinocchio.neutral(self.model)
        for name, index in self.where.items():
            joint, value = self.model.joints[index], values.get(name, 0.0)
            q[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        return q

    def frames(self, values, base):
        pinocchio.framesForwardKinematics(self.model, self.data, self.configuration(values))
        inverse = np.linalg.inv(self.data.oMf[self.bodies[base]].homogeneous)
        return {name: inverse @ self.data.oMf[index].homogeneous for name, index in self.bodies.items()}

    def matter(self, values, base, joints):
        """Mass, centre seen from the base, principal moments about it, joint-space inertia with a floating base."""
        q = self.configuration(values)
        pinocchio.framesForwardKinematics(self.model, self.data, q)
        to_base = np.linalg.inv(self.data.oMf[self.bodies[base]].homogeneous)
        pinocchio.ccrba(self.model, self.data, q, np.zeros(self.model.nv))
        mass = self.data.Ig.mass
        centre = to_base @ [*self.data.com[0], 1.0]
        moments = np.linalg.eigvalsh(self.data.Ig.inertia)
        pinocchio.crba(self.model, self.data, q)
        whole = np.triu(self.data.M) + np.triu(self.data.M, 1).T
        at = [self.model.joints[self.where[name]].idx_v for name in joints]
        floating = slice(0, 6)
        coupling = whole[np.ix_(range(6), at)]
        left = whole[np.ix_(at, at)] - coupling.T @ np.linalg.solve(whole[floating, floating], coupling)
        return mass, centre[:3], moments, left


class Mujoco:
    """Poses of all links and shapes, each link's mass and centre, joint ranges. A mesh counts as the box of its scale."""

    def __init__(self, path):
        try:
            root = etree.parse(str(path), etree.XMLParser(remove_comments=True, huge_tree=True)).getroot()
            for mesh in root.iter("mesh"):
                scale = np.abs(numbers(mesh, "scale", [1, 1, 1]))
                mesh.tag = "box"
                mesh.attrib.clear()
                mesh.set("size", " ".join(map(repr, map(float, scale))))
            # A link may have the name of MuJoCo's own first body.
            for element in root.iter("link", "parent", "child"):
                for name in ("name", "link"):
                    if element.get(name) == "world":
                        element.set(name, WORLD)
            for own in root.findall("mujoco"):
                root.remove(own)
            root.append(etree.fromstring(COMPILER))
            self.model = mujoco.MjModel.from_xml_string(etree.tostring(root).decode())
        except Exception as error:
            raise NotRead(f"MuJoCo: {error}") from error
        self.data = mujoco.MjData(self.model)
        kinds = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
        self.joints = {self.model.joint(index).name for index in range(self.model.njnt) if self.model.jnt_type[index] in kinds}
        self.links = {self.name(index) for index in range(1, self.model.nbody)}

    def name(self, index):
        name = self.model.body(index).name
        return "world" if name == WORLD else name

    def place(self, values, base):
        self.data.qpos[:] = self.model.qpos0
        for name in self.joints:
            self.data.qpos[self.model.joint(name).qposadr] = values.get(name, 0.0)
        mujoco.mj_kinematics(self.model, self.data)
        return np.linalg.inv(self.body(base))

    def at(self, link):
        return self.model.body(WORLD if link == "world" else link).id

    def body(self, name):
        pose = np.eye(4)
        at = self.at(name)
        pose[:3, :3], pose[:3, 3] = self.data.xmat[at].reshape(3, 3), self.data.xpos[at]
        return pose

    def frames(self, values, base):
        inverse = self.place(values, base)
        return {name: inverse @ self.body(name) for name in self.links}

    def masses(self, values, base):
        """By link: mass, centre, and tensor about the centre, along the base's axes."""
        inverse, found = self.place(values, base), {}
        for name in self.links:
            at = self.at(name)
            axes = inverse[:3, :3] @ self.data.ximat[at].reshape(3, 3)
            tensor = axes @ np.diag(self.model.body_inertia[at]) @ axes.T
            found[name] = (self.model.body_mass[at], inverse[:3, :3] @ self.data.xipos[at] + inverse[:3, 3], tensor)
        return found

    def shapes(self, values, base, visuals_only):
        """[(link, kind, centre, Q)] with Q of the half edges squared along the axes."""
        inverse, found = self.place(values, base), []
        for geom in range(self.model.ngeom):
            if visuals_only and self.model.geom_group[geom] != 1:
                continue
            kind, size = int(self.model.geom_type[geom]), self.model.geom_size[geom].copy()
            if kind == mujoco.mjtGeom.mjGEOM_SPHERE:
                size = np.full(3, size[0])
            elif kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
                size = np.array([size[0], size[0], size[1]])
            axes = inverse[:3, :3] @ self.data.geom_xmat[geom].reshape(3, 3)
            centre = inverse[:3, :3] @ self.data.geom_xpos[geom] + inverse[:3, 3]
            found.append((self.name(self.model.geom_bodyid[geom]), kind, centre, axes @ np.diag(size**2) @ axes.T))
        return found

    def range(self, name):
        joint = self.model.joint(name)
        return joint.range if self.model.jnt_limited[joint.id] else None

    def slides(self):
        return {name for name in self.joints if self.model.jnt_type[self.model.joint(name).id] == mujoco.mjtJoint.mjJNT_SLIDE}


STATED = re.compile(r"(offset: 0(\.0*)?|mechanicalReduction: 1(\.0*)?|actuator \"[^\"]*\") is (gone|new)$|^  (both|[ab]): ")
READERS = {"yourdfpy": Yourdfpy, "pinocchio": Pinocchio, "MuJoCo": Mujoco}


class Wrong(Exception):
    """The edited file is not as requested."""


def expect(holds, what):
    if not holds:
        raise Wrong(what)


# ---------------------------------------------------------------------------------------------------------------- checks


def configurations(reader, slides, case):
    """Old joint values and new ones."""
    random = np.random.default_rng(1)
    names = sorted(reader.joints)
    for index in range(CONFIGURATIONS):
        old = {name: 0.0 if index == 0 else random.uniform(-1, 1) for name in names}
        new = {}
        for name, value in old.items():
            other, sense, shift = case.joint(name)
            new[other] = sense * value * (case.scale if name in slides else 1.0) + shift
        yield old, new


def apart(a, b):
    """(metres, radians) between stacks of poses."""
    turn = np.swapaxes(a[:, :3, :3], 1, 2) @ b[:, :3, :3]
    sine = np.linalg.norm(np.stack([turn[:, 2, 1] - turn[:, 1, 2], turn[:, 0, 2] - turn[:, 2, 0], turn[:, 1, 0] - turn[:, 0, 1]]), axis=0) / 2
    return np.linalg.norm(a[:, :3, 3] - b[:, :3, 3], axis=1), np.arctan2(sine, (np.trace(turn, axis1=1, axis2=2) - 1) / 2)


def same_motion(before, after, slides, case, root):
    links = [link for link in sorted(before.links) if case.link(link) in after.links]
    expect(links, "no link is left")
    base, steps = case.link(case.base), None
    for old, new in configurations(before, slides, case):
        was, found = before.frames(old, case.base), after.frames(new, base)
        was = np.array([was[link] for link in links])
        found = np.array([found[case.link(link)] for link in links])
        expected = was.copy()
        expected[:, :3, :3] = case.space @ was[:, :3, :3] @ case.space
        expected[:, :3, 3] = was[:, :3, 3] @ (case.scale * case.space).T
        size = max(1.0, np.linalg.norm(expected[:, :3, 3], axis=1).max())
        if not case.frames:
            # Each frame may be another frame of its link: the step between them does not depend on joint values.
            now = np.linalg.inv(expected) @ root @ found
            steps = now if steps is None else steps
            expected, found = steps, now
        metres, radians = apart(expected, found)
        worst = int(np.argmax(metres + radians))
        holds = metres.max() < case.near * size and radians.max() < 10 * case.near
        expect(holds, f"link {links[worst]} is off by {metres[worst]:.2e} m, {radians[worst]:.2e} rad")


def same_matter(before, after, slides, case, root):
    within = max(MASSES, case.near)
    joints = sorted(before.joints & {name for name in before.joints if case.joint(name)[0] in after.joints})
    expect(len(joints) == len(before.joints), "joints are missing")
    new_joints = [case.joint(name)[0] for name in joints]
    units = np.array([case.scale if name in slides else 1.0 for name in joints])
    senses = np.array([case.joint(name)[1] for name in joints])
    for old, new in configurations(before, slides, case):
        try:
            was = before.matter(old, case.base, joints)
        except np.linalg.LinAlgError:
            return
        found = after.matter(new, case.link(case.base), new_joints)
        expect(abs(was[0] - found[0]) <= MASSES * was[0], f"the mass was {was[0]} and is {found[0]}")
        if was[0] == 0.0:
            return
        size = max(1.0, np.linalg.norm(was[1]) * case.scale)
        centre = root[:3, :3] @ found[1] + root[:3, 3]
        off = np.linalg.norm(case.scale * case.space @ was[1] - centre)
        expect(off < within * size, f"the centre of mass is off by {off:.2e} m")
        moments = case.scale**2 * was[2]
        off = np.abs(moments - found[2]).max()
        expect(off <= within * max(np.abs(moments).max(), 1e-6), f"the principal moments are off by {off:.2e} kg m²")
        # Lengths of slides count in their units.
        scales = senses / units
        inertia = case.scale**2 * was[3] * np.outer(scales, scales)
        if not joints or not np.isfinite(inertia).all() or np.abs(inertia).max() > 1e9:
            continue
        off = np.abs(inertia - found[3]).max()
        expect(off <= 10 * within * max(np.abs(moments).max(), np.abs(inertia).max(), 1e-6), f"the joint-space inertia is off by {off:.2e}")


def same_parts(before, after, slides, case, root):
    """MuJoCo: shapes, masses of the links, ranges. `root`: transform from the old base's frame to the new one's, if frames move."""
    space, within = case.scale * case.space, max(NOT_MOVED, case.near)
    base = case.link(case.base)
    kept = {link for link in before.links if case.link(link) in after.links}
    for old, new in configurations(before, slides, case):
        was, found = (
            before.shapes(old, case.base, not case.collisions),
            after.shapes(new, base, not case.collisions),
        )
        if case.each:
            was = [shape for shape in was if shape[0] in kept]
            names = {case.link(link) for link in kept}
            found = [shape for shape in found if shape[0] in names]
        turn, at = root[:3, :3], root[:3, 3]
        rows = [np.array([*(space @ centre), *(space @ q @ space.T).ravel()]) for _, _, centre, q in was]
        others = [np.array([*(turn @ centre + at), *(turn @ q @ turn.T).ravel()]) for _, _, centre, q in found]
        expect(len(rows) == len(others), f"there were {len(rows)} shapes and are {len(others)}")
        for kind in {shape[1] for shape in was}:
            one = [row for row, shape in zip(rows, was, strict=True) if shape[1] == kind]
            two = [row for row, shape in zip(others, found, strict=True) if shape[1] == kind]
            expect(len(one) == len(two), "shapes are of other kinds")
            size = max(1.0, max(np.abs(row).max() for row in one))
            for a, b in ((one, two), (two, one)):
                off = cKDTree(a).query(b)[0].max()
                expect(off < within * size, f"a shape is off by {off:.2e}")
        if not case.each:
            continue
        masses, new_masses = before.masses(old, case.base), after.masses(new, base)
        for link in kept - {case.base}:
            (mass, centre, tensor), (mass_now, centre_now, tensor_now) = masses[link], new_masses[case.link(link)]
            expect(abs(mass - mass_now) <= MASSES * mass, f"link {link}: its mass was {mass} and is {mass_now}")
            if mass <= LEAST_SEEN:
                continue
            off = np.linalg.norm(space @ centre - turn @ centre_now - at)
            expect(off < within * max(1.0, np.linalg.norm(space @ centre)), f"link {link}: its centre is off by {off:.2e} m")
            wanted = space @ tensor @ space.T
            off = np.abs(wanted - turn @ tensor_now @ turn.T).max()
            expect(off <= max(within * np.abs(wanted).max(), 1e-11), f"link {link}: its tensor is off by {off:.2e} kg m²")
    for name in before.joints:
        other, sense, shift = case.joint(name)
        if other not in after.joints:
            expect(case.links is not None, f"joint {name} is gone")
            continue
        was, found = before.range(name), after.range(other)
        expect((was is None) == (found is None), f"joint {name}: a range came or went")
        if was is not None:
            wanted = sorted(sense * was * (case.scale if name in slides else 1.0) + shift)
            expect(np.abs(wanted - found).max() < case.near * max(1.0, np.abs(wanted).max()), f"joint {name}: its range is {found}, not {wanted}")


def base_moved(robot, case):
    """The new base frame in the old one: `recentre` moves the root's frame to its centre of mass, without rotation."""
    step = np.eye(4)
    if case.name == "recentre":
        inertial = next(link for link in robot.root.findall("link") if link.get("name") == case.base).find("inertial")
        if inertial is not None and float(inertial.find("mass").get("value")) > 0:
            step[:3, 3] = numbers(inertial.find("origin"), "xyz", [0, 0, 0])
    return step


def encloses(before, after, places, folder):
    """Every corner of a collision mesh is inside its replacement. Returns the number of meshes."""
    meshes = 0
    for link in before.root.findall("link"):
        new = next(it for it in after.root.findall("link") if it.get("name") == link.get("name"))
        for old_shape, shape in zip(link.findall("collision"), new.findall("collision"), strict=True):
            mesh = old_shape.find("geometry/mesh")
            if mesh is None:
                continue
            place = places.get(mesh.get("filename").strip())
            geometry = shape.find("geometry")[0]
            loaded = corners(place)
            if loaded is None:
                continue
            points = placed(old_shape, loaded * numbers(mesh, "scale", [1, 1, 1]))
            inverse = np.linalg.inv(pose_of(shape))
            local = points @ inverse[:3, :3].T + inverse[:3, 3]
            size = max(1e-3, np.abs(points).max())
            if geometry.tag == "box":
                out = (np.abs(local) - numbers(geometry, "size", [0, 0, 0]) / 2).max()
            elif geometry.tag == "sphere":
                out = np.linalg.norm(local, axis=1).max() - float(geometry.get("radius"))
            elif geometry.tag == "cylinder":
                out = max(np.linalg.norm(local[:, :2], axis=1).max() - float(geometry.get("radius")), np.abs(local[:, 2]).max() - float(geometry.get("length")) / 2)
            else:
                mesh_of_hull = trimesh.load(folder / geometry.get("filename"), force="mesh", process=False)
                hull = ConvexHull(mesh_of_hull.vertices)
                local = local / numbers(geometry, "scale", [1, 1, 1])
                out = (local @ hull.equations[:, :3].T + hull.equations[:, 3]).max()
                size = max(1e-3, np.abs(local).max())
                expect(abs(mesh_of_hull.volume - hull.volume) < 1e-9 * hull.volume, f"{geometry.get('filename')} is no hull")
            expect(out <= 1e-7 * size, f"link {link.get('name')}: a corner of {mesh.get('filename')} is {out:.2e} outside of its {geometry.tag}")
            meshes += 1
    return meshes


def pose_of(shape):
    origin = shape.find("origin")
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xyz", numbers(origin, "rpy", [0, 0, 0])).as_matrix()
    pose[:3, 3] = numbers(origin, "xyz", [0, 0, 0])
    return pose


def placed(shape, points):
    pose = pose_of(shape)
    return points @ pose[:3, :3].T + pose[:3, 3]


def corners(place):
    if place is None or place.suffix.lower() not in (".stl", ".obj"):
        return None
    return np.asarray(trimesh.load(place, force="mesh", process=False).vertices)


def is_calibrated(after, case):
    """The edited robot moves from base to tip like the given file, up to constant steps at both ends: here, none at the base."""
    source, base, tip = case.actual
    actual, edited = Yourdfpy(source), Yourdfpy(after)
    steps = None
    random = np.random.default_rng(2)
    for _ in range(CONFIGURATIONS + 1):
        values = {name: random.uniform(-1, 1) for name in sorted(actual.joints)}
        step = np.linalg.inv(actual.frames(values, base)[tip]) @ edited.frames(values, base)[tip]
        steps = step if steps is None else steps
        metres, radians = distance(steps, step)
        expect(metres < 1e-8 and radians < 1e-8, f"the calibrated tip is off by {metres:.2e} m, {radians:.2e} rad")


@dataclass
class Result:
    """Result of one operation on one robot."""

    state: str
    reason: str = ""
    checked: tuple = ()
    came_back: str = ""


class Robot:
    """A file of the corpus in a folder of its own, with the meshes that it names, and its readers."""

    def __init__(self, path, folder):
        self.home = folder / "a/b/c/d/e/f/g"
        self.home.mkdir(parents=True)
        self.packages = folder / "packages"
        self.packages.mkdir()
        self.path = self.home / "robot.urdf"
        self.path.write_bytes(path.read_bytes())
        self.text = self.path.read_bytes()
        self.description = Description(self.path)
        self.places = put_meshes(self.description, self.path, self.packages)
        self.readers = {}
        for name, reader in READERS.items():
            try:
                self.readers[name] = reader(self.path)
            except NotRead:
                continue
        kinds = {name: kind for name, (kind, *_) in self.description.joints.items()}
        self.slides = {name for name, kind in kinds.items() if kind == "prismatic"}

    def edit(self, source, words, to):
        command = [denavit(), "edit", source, *words, "-o", to, "--package-path", str(self.packages), "--package-path", str(PACKAGES)]
        return subprocess.run(list(map(str, command)), capture_output=True, text=True, cwd=self.home)

    def asked(self):
        return cases(self.description, self.home)

    def tried(self, case, index):
        """Result of an operation: done, refused, or wrong."""
        to = self.home / f"edited_{index}.urdf"
        run = self.edit(self.path, case.words, to)
        if run.returncode == 2 and run.stderr.startswith("error: ") and not to.exists():
            if "the result would not be" in run.stderr:
                return Result("wrong", run.stderr.strip())
            return Result("refused", run.stderr.strip())
        if run.returncode != 0:
            return Result("wrong", f"exit code {run.returncode}: {run.stderr.strip()}")
        try:
            return Result("done", "", *self.checked(case, to, index))
        except Wrong as error:
            return Result("wrong", str(error))

    def checked(self, case, to, index):
        checked = []
        after = {}
        for name in self.readers:
            try:
                after[name] = READERS[name](to)
            except NotRead as error:
                raise Wrong(f"it cannot be read any more: {error}") from error
        if case.actual:
            if "yourdfpy" in after and {*case.actual[1:]} <= after["yourdfpy"].links:
                is_calibrated(to, case)
                checked.append("yourdfpy")
            return tuple(checked), ""
        root = base_moved(self.description, case)
        for name in self.readers:
            if case.base not in self.readers[name].links:
                continue
            same_motion(self.readers[name], after[name], self.slides, case, root)
            if name == "pinocchio" and case.links is None:
                same_matter(self.readers[name], after[name], self.slides, case, root)
            if name == "MuJoCo":
                same_parts(self.readers[name], after[name], self.slides, case, root)
            checked.append(name)
        if case.name == "simplify-collision" and encloses(self.description, Description(to), self.places, self.home):
            checked.append("trimesh")
        if case.name == "meshes":
            self.copied(Description(to))
        return tuple(checked), self.came_back(case, to, index)

    def copied(self, after):
        for one, two in zip(self.description.root.iter("mesh"), after.root.iter("mesh"), strict=True):
            place = self.places[one.get("filename").strip()]
            expect((self.home / two.get("filename")).read_bytes() == place.read_bytes(), f"{two.get('filename')} is another mesh")

    def came_back(self, case, to, index):
        if case.back is None:
            return ""
        again = self.home / f"again_{index}.urdf"
        run = self.edit(to, case.back, again)
        expect(run.returncode == 0, f"there, but not back: {run.stderr.strip()}")
        if again.read_bytes() == self.text:
            return "bytes"
        run = subprocess.run([denavit(), "diff", "--exact", self.path, again], capture_output=True, text=True)
        # A default value that is no longer written means the same transmission.
        found = [line for line in run.stdout.splitlines()[1:] if not STATED.search(line)]
        expect(run.returncode == 0 or not found, f"there and back is another robot: {run.stdout.strip()[:600]}")
        return "same"


def reason(words):
    """The reason in a refusal, without names and numbers."""
    said = words.splitlines()[0].removeprefix("error: ")
    said = re.sub(r'"[^"]*"', '"…"', said)
    said = re.sub(r"^\S*(/|\.urdf)\S*: ", "", said)
    said = re.sub(r"^(joint|link|material|mesh|<\w+>)[^:]*: ", "", said)
    return re.sub(r"\d+(\.\d+)?", "N", said)


def tried(path):
    """[(case's name, its words, its result)]; None if the file is not a robot."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            robot = Robot(path, Path(folder))
            asked = robot.asked()
        except (etree.XMLSyntaxError, IndexError, ValueError):
            return None
        return [(case.name, " ".join(case.words), robot.tried(case, index)) for index, case in enumerate(asked)]


def study(files):
    counts, reasons, wrong = {}, Counter(), []
    robots = 0
    with ProcessPoolExecutor(2 * os.cpu_count()) as pool:
        for (_, path), results in zip(files, pool.map(tried, [path for _, path in files]), strict=True):
            if results is None:
                print(f"no robot: {path}", file=sys.stderr)
                continue
            robots += 1
            if robots % 10 == 0:
                print(f"{robots} robots", file=sys.stderr, flush=True)
            for name, words, result in results:
                count = counts.setdefault(name, Counter())
                count.update([result.state, result.came_back, *result.checked])
                if result.state == "refused":
                    reasons[f"{name}: {reason(result.reason)}"] += 1
                if result.state == "wrong":
                    wrong.append(f"{path}: {words[:200]}: {result.reason}")
                    print(f"wrong: {wrong[-1]}", file=sys.stderr, flush=True)
    print(f"{robots} robots\n")
    readers = (*READERS, "trimesh")
    print(f"| operation | done | refused | wrong | there and back: same bytes | same by diff | {' | '.join(readers)} |")
    print("|---" * (6 + len(readers)) + "|")
    for name, count in counts.items():
        cells = [count[key] for key in ("done", "refused", "wrong", "bytes", "same", *readers)]
        print(f"| {name} | {' | '.join(map(str, cells))} |")
    total = Counter()
    for count in counts.values():
        total.update(count)
    cells = [total[key] for key in ("done", "refused", "wrong", "bytes", "same", *readers)]
    print(f"| all | {' | '.join(map(str, cells))} |\n")
    print("| refused | why |\n|---|---|")
    for why, number in reasons.most_common():
        print(f"| {number} | {why} |")
    return wrong


if __name__ == "__main__":
    every = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    first = int(sys.argv[2]) if len(sys.argv) > 2 else 0
    sys.exit(1 if study(corpus.files()[first::every]) else 0)
