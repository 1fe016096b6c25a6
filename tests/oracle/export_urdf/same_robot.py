"""Whether a URDF and its canonical export are the same robot: by yourdfpy, by pinocchio, and element by element."""

import hashlib
import logging
import os
import sys
import warnings
from functools import lru_cache
from pathlib import Path

import numpy as np
from lxml import etree

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from fk import reason, span  # noqa: E402
from kinematics import ACTUATED, Tree  # noqa: E402

# Joint vectors per file; the test in Rust takes 100.
VECTORS = int(os.environ.get("DENAVIT_EXPORT_VECTORS", "5"))


# Both exports of a file are compared one after the other: the original is read once.
@lru_cache(maxsize=1)
def tree_of(path):
    return Tree(path)


@lru_cache(maxsize=1)
def original_by_yourdfpy(path):
    """The robot and its poses at all joint vectors."""
    robot = Yourdfpy(path)
    return robot, [robot.poses(values) for values in vectors(path)]


@lru_cache(maxsize=1)
def original_by_pinocchio(path):
    return of_pinocchio(path)


def of_pinocchio(path):
    """A model and its data."""
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(path))
    return model, model.createData()


def quiet():
    """Silences the C++ libraries, which complain on standard error about files whose errors are recorded anyway."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    logging.disable(logging.CRITICAL)
    warnings.simplefilter("ignore")


@lru_cache(maxsize=1)
def vectors(path, count=VECTORS):
    """Joint values by name, drawn within the limits of the original file."""
    tree = tree_of(path)
    rng = np.random.default_rng(int.from_bytes(hashlib.sha256(Path(path).read_bytes()).digest()[:8], "big"))
    drivers = [joint for joint in tree.joints if joint.kind in ACTUATED]
    return [{joint.name: float(rng.uniform(*span(joint))) for joint in drivers} for _ in range(count)]


def slides_by_its_length(path):
    """yourdfpy moves a slide by the axis as written, without normalizing: in such files its motion differs from URDF."""
    return any(j.kind == "prismatic" and abs(np.linalg.norm(j.axis) - 1) > 1e-12 for j in tree_of(path).joints)


class Yourdfpy:
    """All parts of the links, in the root's frame, as yourdfpy places them."""

    def __init__(self, path):
        import yourdfpy

        self.robot = yourdfpy.URDF.load(str(path), load_meshes=False, build_collision_scene_graph=False)
        self.root = self.robot.base_link
        below = {}
        for joint in self.robot.robot.joints:
            below.setdefault(joint.parent, []).append(joint.child)
        self.edges, waiting = [], [self.root]
        while waiting:
            parent = waiting.pop()
            self.edges += [(parent, child) for child in below.get(parent, [])]
            waiting += below.get(parent, [])

    def poses(self, values):
        """root_from_link by link name, from the edges of yourdfpy's scene."""
        self.robot.update_cfg({name: values[name] for name in self.robot.actuated_joint_names if name in values})
        edges = self.robot.scene.graph.transforms.edge_data
        poses = {self.root: np.eye(4)}
        for parent, child in self.edges:
            poses[child] = poses[parent] @ edges[(parent, child)].get("matrix", np.eye(4))
        return poses

    def held(self, link):
        """[(what, local pose)] and (mass, centre, tensor in the link's frame) of a link."""
        held = self.robot.link_map[link]
        local = lambda part: np.eye(4) if part.origin is None else part.origin  # noqa: E731
        parts = [("visual", local(part)) for part in held.visuals or []]
        parts += [("collision", local(part)) for part in held.collisions or []]
        if held.inertial is None:
            return parts, None
        centre = local(held.inertial)
        tensor = np.zeros((3, 3)) if held.inertial.inertia is None else held.inertial.inertia
        return parts, (held.inertial.mass or 0.0, centre[:3, 3], centre[:3, :3] @ tensor @ centre[:3, :3].T)


def stacked(robot, links, rigid):
    """(what, link numbers, local poses) of shapes and kept frames; the same of centres of mass; masses and tensors."""
    what, at, local, heavy, masses, centres, tensors = [], [], [], [], [], [], []
    for number, link in enumerate(links):
        parts, inertia = robot.held(link)
        parts = parts + ([("frame", np.eye(4))] if link in rigid else [])
        what += [(link, kind) for kind, _ in parts]
        at += [number] * len(parts)
        local += [pose for _, pose in parts]
        if inertia is not None:
            heavy.append(number)
            masses.append(inertia[0])
            centres.append(inertia[1])
            tensors.append(inertia[2])
    shape = lambda rows, size: np.array(rows, float).reshape(-1, *size)  # noqa: E731
    whole = lambda rows: np.array(rows, int)  # noqa: E731
    return what, (whole(at), shape(local, (4, 4))), (whole(heavy), shape(masses, ()), shape(centres, (3,)), shape(tensors, (3, 3)))


def by_yourdfpy(original, exported, frames_too):
    """(largest difference relative to the robot's size, of tensors relative to themselves, of masses)."""
    (before, all_poses), after = original_by_yourdfpy(original), Yourdfpy(exported)
    links = list(before.robot.link_map)
    rigid = set(links) if frames_too else fixed_leaves(original)
    what, one, inertia = stacked(before, links, rigid)
    twins, other, twin_inertia = stacked(after, links, rigid)
    assert what == twins and list(inertia[0]) == list(twin_inertia[0])
    masses = np.abs(inertia[1] - twin_inertia[1]).max(initial=0.0)
    worst, tensors, size = 0.0, 0.0, None
    for values, own in zip(vectors(original), all_poses, strict=True):
        poses = [np.array([robot.get(link) for link in links]) for robot in (own, after.poses(values))]
        size = size or max(1e-3, np.linalg.norm(poses[0][:, :3, 3], axis=1).max())
        placed = [pose[at] @ local for pose, (at, local) in zip(poses, (one, other))]
        reach = np.maximum(size, np.linalg.norm(placed[0][:, :3, 3], axis=1))
        metres = np.linalg.norm(placed[0][:, :3, 3] - placed[1][:, :3, 3], axis=1) / reach
        # For two nearly equal rotations the Frobenius norm is √2 times the angle between them.
        turns = np.linalg.norm(placed[0][:, :3, :3] - placed[1][:, :3, :3], axis=(1, 2)) / np.sqrt(2)
        heavy = [pose[part[0]] for pose, part in zip(poses, (inertia, twin_inertia))]
        centres = [
            np.einsum("nij,nj->ni", pose[:, :3, :3], part[2]) + pose[:, :3, 3]
            for pose, part in zip(heavy, (inertia, twin_inertia))
        ]
        spans = np.maximum(size, np.linalg.norm(centres[0], axis=1))
        moved = np.linalg.norm(centres[0] - centres[1], axis=1) / spans
        worst = max([worst, *metres.tolist(), *turns.tolist(), *moved.tolist()])
        turned = [
            pose[:, :3, :3] @ part[3] @ pose[:, :3, :3].transpose(0, 2, 1)
            for pose, part in zip(heavy, (inertia, twin_inertia))
        ]
        lengths = np.maximum(np.linalg.norm(turned[0], axis=(1, 2)), 1e-300)
        tensors = max([tensors, *(np.linalg.norm(turned[0] - turned[1], axis=(1, 2)) / lengths).tolist()])
    return worst, tensors, masses


def fixed_leaves(path):
    """Links on fixed joints that carry nothing: they keep their frames."""
    tree = tree_of(path)
    return {link for link in tree.leaves if link in tree.above and tree.above[link].kind == "fixed"}


def by_pinocchio(original, exported):
    """Largest relative differences of the mass matrix and of the gravity torque; None without a joint that moves."""
    import pinocchio

    models, datas = zip(original_by_pinocchio(original), of_pinocchio(exported), strict=True)
    if models[0].nv == 0:
        return None
    worst = np.zeros(2)
    assert sorted(models[0].names) == sorted(models[1].names)
    columns = [order(model, models[0]) for model in models]
    for values in vectors(original):
        matrices, torques = [], []
        for model, data, column in zip(models, datas, columns, strict=True):
            q = configuration(pinocchio, model, values)
            matrix = pinocchio.crba(model, data, q)
            matrix = np.triu(matrix) + np.triu(matrix, 1).T
            matrices.append(matrix[np.ix_(column, column)])
            torques.append(pinocchio.computeGeneralizedGravity(model, data, q)[column].copy())
        lever = sum(inertia.mass for inertia in models[0].inertias) * 9.81 * max(
            1e-3, *(np.linalg.norm(place.translation) for place in models[0].jointPlacements)
        )
        worst[0] = max(worst[0], np.linalg.norm(matrices[0] - matrices[1]) / max(np.linalg.norm(matrices[0]), 1e-300))
        scale = max(np.linalg.norm(torques[0]), lever)
        worst[1] = max(worst[1], np.linalg.norm(torques[0] - torques[1]) / max(scale, 1e-300))
    return worst


def order(model, like):
    """Velocity columns of a model's joints, in the order of another model's."""
    columns = []
    for name in like.names[1:]:
        joint = model.joints[model.getJointId(name)]
        columns.extend(range(joint.idx_v, joint.idx_v + joint.nv))
    return columns


def configuration(pinocchio, model, values):
    q = pinocchio.neutral(model)
    for name, value in values.items():
        joint = model.joints[model.getJointId(name)]
        if joint.nv == 1:
            q[joint.idx_q : joint.idx_q + joint.nq] = value if joint.nq == 1 else (np.cos(value), np.sin(value))
    return q


POSED = {"origin": {"xyz", "rpy"}, "axis": {"xyz"}, "frame": {"xyz", "rpy"}, "link1": {"xyz", "rpy"}, "link2": {"xyz", "rpy"}}
POSED["terminator"] = {"xyz"}


def different_elements(original, exported):
    """Elements, attributes, comments and texts that differ, except poses and elements that add a pose."""
    parser = etree.XMLParser(recover=True, remove_blank_text=False)
    twins = [etree.fromstring(Path(path).read_bytes().lstrip(), parser) for path in (original, exported)]
    found = []
    compare(*twins, found)
    return found


def tag_of(element):
    return etree.QName(element).localname if isinstance(element.tag, str) else str(element.tag)


def compare(before, after, found):
    tag = tag_of(before)
    posed = POSED.get(tag, set())
    attributes = lambda element: [(k, v) for k, v in element.attrib.items() if k not in posed]  # noqa: E731
    if tag != tag_of(after) or attributes(before) != attributes(after):
        found.append(f"<{tag}> in line {before.sourceline}")
    text = lambda element: (element.text or "").strip()  # noqa: E731
    # Given in the frame of the link, which may have moved: positions and directions of friction.
    if tag not in ("pose", "fdir1") and text(before) != text(after):
        found.append(f"text of <{tag}> in line {before.sourceline}")
    twins = list(after)
    for child in before:
        while twins and tag_of(twins[0]) in ("origin", "axis", "pose") and tag_of(child) != tag_of(twins[0]):
            twins.pop(0)
        if not twins:
            found.append(f"<{tag_of(child)}> in line {child.sourceline} is lost")
            return
        compare(child, twins.pop(0), found)
    found.extend(f"a new <{tag_of(twin)}> in <{tag}>" for twin in twins if tag_of(twin) not in ("origin", "axis", "pose"))


def examine(task):
    """One file with its exports, each as (file, whether it keeps the frames of links): what `compared` says of each."""
    original, exports = task
    return [compared(original, *export) for export in exports]


def compared(original, exported, frames_too):
    """Results of the comparisons, or the reason for having none."""
    result = {"file": str(original)}
    if not Path(exported).exists():
        return result | {"refused": True}
    try:
        if slides_by_its_length(original):
            result["yourdfpy skipped"] = "it slides by the length of an axis"
        else:
            result["yourdfpy"] = by_yourdfpy(original, exported, frames_too)
    except AssertionError:
        raise
    except Exception as error:  # noqa: BLE001 - that the program cannot read it is the result
        result["yourdfpy skipped"] = reason(error)
    try:
        result["pinocchio"] = by_pinocchio(original, exported)
    except AssertionError:
        raise
    except Exception as error:  # noqa: BLE001
        result["pinocchio skipped"] = reason(error)
    if not frames_too:
        result["elements"] = different_elements(original, exported)
    return result
