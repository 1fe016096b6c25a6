"""Forward kinematics of URDF trees, D-H tables and POE lists, written out in numpy.

Independent of denavit and of every library that it is compared with. Radians and metres throughout.
"""

import csv
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass

import numpy as np

ACTUATED = ("revolute", "continuous", "prismatic")


def rot_x(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1.0]])


def rot_y(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1.0]])


def rot_z(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])


def translation(x, y, z):
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def exp_twist(twist):
    """exp of [ω; v]: I + A + (1 - cos θ)/θ² A² + (θ - sin θ)/θ³ A³, A the 4x4 matrix of the twist, θ = |ω|."""
    (wx, wy, wz), v = twist[:3], twist[3:]
    a = np.zeros((4, 4))
    a[:3, :3] = [[0, -wz, wy], [wz, 0, -wx], [-wy, wx, 0]]
    a[:3, 3] = v
    angle = np.linalg.norm(twist[:3])
    if angle < 1e-8:
        return np.eye(4) + a + a @ a / 2
    half = np.sin(angle / 2) / angle
    return np.eye(4) + a + 2 * half**2 * a @ a + (angle - np.sin(angle)) / angle**3 * a @ a @ a


def distance(a, b):
    """(metres, radians) between two poses."""
    turn = a[:3, :3].T @ b[:3, :3]
    sine = np.linalg.norm([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    return float(np.linalg.norm(a[:3, 3] - b[:3, 3])), float(np.arctan2(sine, (np.trace(turn) - 1) / 2))


@dataclass
class Joint:
    name: str
    kind: str
    parent: str
    child: str
    origin: np.ndarray
    axis: np.ndarray
    limits: tuple
    mimic: tuple  # (joint, multiplier, offset) or None

    def motion(self, value):
        if self.kind in ("revolute", "continuous"):
            return exp_twist(np.concatenate([self.axis / np.linalg.norm(self.axis) * value, np.zeros(3)]))
        if self.kind == "prismatic":
            return translation(*(self.axis / np.linalg.norm(self.axis) * value))
        return np.eye(4)


def numbers(text, default):
    return np.array([float(word) for word in text.split()]) if text and text.strip() else np.array(default, float)


class Tree:
    """The joints of one URDF; missing elements get URDF's defaults (origin 0, axis 1 0 0, multiplier 1, offset 0)."""

    def __init__(self, path):
        robot = ElementTree.parse(path).getroot()
        if robot.tag.split("}")[-1] != "robot":
            raise ValueError(f"the root element is <{robot.tag}>, not <robot>")
        self.links = [link.get("name") for link in robot.findall("link")]
        self.joints = [self._joint(element) for element in robot.findall("joint")]
        self.by_name = {joint.name: joint for joint in self.joints}
        self.above = {joint.child: joint for joint in self.joints}
        self.roots = [link for link in self.links if link not in self.above]
        parents = {joint.parent for joint in self.joints}
        self.leaves = [link for link in self.links if link not in parents]

    @staticmethod
    def _joint(element):
        get = lambda tag, key, default=None: (  # noqa: E731
            element.find(tag).get(key, default) if element.find(tag) is not None else default
        )
        roll, pitch, yaw = numbers(get("origin", "rpy"), (0, 0, 0))
        origin = translation(*numbers(get("origin", "xyz"), (0, 0, 0))) @ rot_z(yaw) @ rot_y(pitch) @ rot_x(roll)
        mimic = None
        if element.find("mimic") is not None:
            mimic = (get("mimic", "joint"), float(get("mimic", "multiplier", 1)), float(get("mimic", "offset", 0)))
        limits = (get("limit", "lower"), get("limit", "upper"))
        return Joint(
            name=element.get("name"),
            kind=element.get("type"),
            parent=get("parent", "link"),
            child=get("child", "link"),
            origin=origin,
            axis=numbers(get("axis", "xyz"), (1, 0, 0)),
            limits=tuple(float(limit) for limit in limits) if None not in limits else None,
            mimic=mimic,
        )

    def chain(self, base, tip):
        joints = []
        link = tip
        while link != base:
            joint = self.above.get(link)
            if joint is None or joint in joints:
                raise ValueError(f'no chain leads from "{base}" to "{tip}"')
            joints.append(joint)
            link = joint.parent
        return joints[::-1]

    def driver(self, joint):
        """(driving joint, multiplier, offset): a chain of mimics multiplied out."""
        multiplier, offset, seen = 1.0, 0.0, set()
        while joint.mimic is not None:
            if joint.name in seen:
                raise ValueError(f'joint "{joint.name}" mimics itself')
            seen.add(joint.name)
            name, m, o = joint.mimic
            multiplier, offset = multiplier * m, offset + multiplier * o
            if name not in self.by_name:
                raise ValueError(f'joint "{joint.name}" mimics "{name}", which does not exist')
            joint = self.by_name[name]
        return joint, multiplier, offset

    def drivers(self, base, tip):
        """The actuated joints that move the chain, in order: mimics stand for the joint that drives them."""
        names = []
        for joint in self.chain(base, tip):
            if joint.kind in ACTUATED:
                name = self.driver(joint)[0].name
                if name not in names:
                    names.append(name)
        return names

    def pose(self, base, tip, values):
        """base_from_tip at {driver name: value}."""
        pose = np.eye(4)
        for joint in self.chain(base, tip):
            pose = pose @ joint.origin
            if joint.kind in ACTUATED:
                driver, multiplier, offset = self.driver(joint)
                pose = pose @ joint.motion(multiplier * values[driver.name] + offset)
        return pose


class DhTable:
    """A D-H table in CSV: rows of theta, d, alpha, a in rad and m, or theta_deg, d_mm, alpha_deg, a_mm."""

    def __init__(self, path):
        lines = open(path, encoding="utf-8").read().splitlines()
        comments = [line[1:].strip() for line in lines if line.startswith("#")]
        self.convention = next(c.split(":")[1].strip() for c in comments if c.startswith("convention:"))
        rows = list(csv.DictReader(line for line in lines if not line.startswith("#")))
        self.joints = [row["joint"] for row in rows]
        self.kinds = [row["kind"] for row in rows]
        self.rows = [
            (
                self._cell(row, "theta", "theta_deg", np.pi / 180),
                self._cell(row, "d", "d_mm", 1e-3),
                self._cell(row, "alpha", "alpha_deg", np.pi / 180),
                self._cell(row, "a", "a_mm", 1e-3),
            )
            for row in rows
        ]

    @staticmethod
    def _cell(row, plain, scaled, factor):
        return float(row[plain]) if plain in row else float(row[scaled]) * factor

    def pose(self, q):
        pose = np.eye(4)
        for (theta, d, alpha, a), kind, value in zip(self.rows, self.kinds, q, strict=True):
            turn, slide = (theta, d + value) if kind == "prismatic" else (theta + value, d)
            joint = rot_z(turn) @ translation(0, 0, slide)
            link = rot_x(alpha) @ translation(a, 0, 0)
            pose = pose @ (joint @ link if self.convention == "distal" else link @ joint)
        return pose


class PoeList:
    """Joint twists and the twist of the home pose, in CSV."""

    def __init__(self, path):
        rows = list(csv.DictReader(line for line in open(path, encoding="utf-8") if not line.startswith("#")))
        twist = lambda row: np.array([float(row[key]) for key in ("wx", "wy", "wz", "vx", "vy", "vz")])  # noqa: E731
        self.twists = [twist(row) for row in rows if row["row"] != "tool"]
        self.home = exp_twist(next(twist(row) for row in rows if row["row"] == "tool"))

    def pose(self, q):
        pose = np.eye(4)
        for twist, value in zip(self.twists, q, strict=True):
            pose = pose @ exp_twist(twist * value)
        return pose @ self.home
