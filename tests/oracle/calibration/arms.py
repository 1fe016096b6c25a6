"""Four arms written as URDF from published figures: nominal, and with manufacturing errors.

Lengths m, angles rad, masses kg. A joint is (name, type, xyz, rpy, axis, (lower, upper)); a link is (mass, centre of
mass in its own frame). Sources: Universal Robots' table of D-H parameters and masses for the UR5e; KUKA's drawing and
the public description of the LBR iiwa 14 R820; Epson's drawing of a 600 mm SCARA (masses from its data sheet's total,
split over the links); KUKA's drawing of the KR 6 R900 on a linear unit (masses split the same way).
"""

from dataclasses import dataclass, replace
from math import pi

import numpy as np
import pinocchio as pin


@dataclass(frozen=True)
class Joint:
    name: str
    kind: str
    xyz: tuple
    rpy: tuple
    axis: tuple
    limits: tuple


@dataclass(frozen=True)
class Arm:
    """Joints from base to tip; `links[i]` = (mass, centre of mass) of the link after joint i; the tip is on the last link."""

    name: str
    joints: tuple
    links: tuple
    tip_xyz: tuple
    tip_rpy: tuple


def _from_standard_dh(name, rows, masses, limits, names):
    """An arm from distal D-H rows (theta offset, d, alpha, a) and (mass, centre in D-H frame i)."""
    joints, links, origin = [], [], pin.SE3.Identity()
    for i, (offset, d, alpha, a) in enumerate(rows):
        turned = pin.SE3(pin.rpy.rpyToMatrix(0, 0, offset), np.zeros(3))
        placement = origin * turned
        rpy = tuple(pin.rpy.matrixToRpy(placement.rotation))
        joints.append(Joint(names[i], "revolute", tuple(placement.translation), rpy, (0, 0, 1), limits[i]))
        link_from_next = pin.SE3(pin.rpy.rpyToMatrix(alpha, 0, 0), np.array([a, 0.0, d]))
        mass, centre = masses[i]
        links.append((mass, tuple(link_from_next.act(np.array(centre)))))
        origin = link_from_next
    return Arm(name, tuple(joints), tuple(links), tuple(origin.translation), tuple(pin.rpy.matrixToRpy(origin.rotation)))


UR5E = _from_standard_dh(
    "six_axis",
    [(0, 0.1625, pi / 2, 0), (0, 0, 0, -0.425), (0, 0, 0, -0.3922),
     (0, 0.1333, pi / 2, 0), (0, 0.0997, -pi / 2, 0), (0, 0.0996, 0, 0)],
    [(3.761, (0, -0.02561, 0.00193)), (8.058, (0.2125, 0, 0.11336)), (2.846, (0.15, 0, 0.0265)),
     (1.37, (0, -0.0018, 0.01634)), (1.3, (0, 0.0018, 0.01634)), (0.365, (0, 0, -0.001159))],
    [(-2.8, 2.8), (-2.9, -0.2), (-2.3, 2.3), (-2.8, 2.8), (-2.8, 2.8), (-2.8, 2.8)],
    ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"])

_H = pi / 2
IIWA14 = Arm(
    "seven_axis",
    tuple(Joint(f"a{i + 1}", "revolute", xyz, rpy, (0, 0, 1), limits) for i, (xyz, rpy, limits) in enumerate([
        ((0, 0, 0.1575), (0, 0, 0), (-2.6, 2.6)), ((0, 0, 0.2025), (_H, 0, pi), (-1.8, 1.8)),
        ((0, 0.2045, 0), (_H, 0, pi), (-2.6, 2.6)), ((0, 0, 0.2155), (_H, 0, 0), (-1.8, 1.8)),
        ((0, 0.1845, 0), (-_H, pi, 0), (-2.6, 2.6)), ((0, 0, 0.2155), (_H, 0, 0), (-1.8, 1.8)),
        ((0, 0.081, 0), (-_H, pi, 0), (-2.8, 2.8))])),
    ((5.76, (0, -0.03, 0.12)), (6.35, (0.0003, 0.059, 0.042)), (3.5, (0, 0.03, 0.13)), (3.5, (0, 0.067, 0.034)),
     (3.5, (0.0001, 0.021, 0.076)), (1.8, (0, 0.0006, 0.0004)), (1.2, (0, 0, 0.02))),
    (0, 0, 0.071), (0, 0, 0))

SCARA = Arm(
    "scara",
    (Joint("j1", "revolute", (0, 0, 0.25), (0, 0, 0), (0, 0, 1), (-2.2, 2.2)),
     Joint("j2", "revolute", (0.325, 0, 0.05), (0, 0, 0), (0, 0, 1), (-2.4, 2.4)),
     Joint("j3", "prismatic", (0.275, 0, -0.03), (pi, 0, 0), (0, 0, 1), (0.0, 0.2)),
     Joint("j4", "revolute", (0, 0, 0.04), (0, 0, 0), (0, 0, 1), (-2.9, 2.9))),
    ((6.5, (0.16, 0, 0.03)), (5.2, (0.12, 0, 0.06)), (1.4, (0, 0, -0.05)), (0.9, (0.02, 0.01, 0.02))),
    (0, 0, 0.03), (0, 0, 0))

RAIL = Arm(
    "rail_six_axis",
    (Joint("rail", "prismatic", (0, 0, 0.2), (0, 0, 0), (1, 0, 0), (0.0, 2.0)),
     Joint("a1", "revolute", (0, 0, 0.4), (0, 0, 0), (0, 0, 1), (-2.6, 2.6)),
     Joint("a2", "revolute", (0.025, 0, 0), (0, 0, 0), (0, 1, 0), (-2.2, 0.5)),
     Joint("a3", "revolute", (0.455, 0, 0), (0, 0, 0), (0, 1, 0), (-1.4, 2.4)),
     Joint("a4", "revolute", (0.0, 0, 0.035), (0, 0, 0), (1, 0, 0), (-2.8, 2.8)),
     Joint("a5", "revolute", (0.42, 0, 0), (0, 0, 0), (0, 1, 0), (-2.0, 2.0)),
     Joint("a6", "revolute", (0.08, 0, 0), (0, 0, 0), (1, 0, 0), (-2.9, 2.9))),
    ((25.0, (0, 0, 0.15)), (16.0, (0.01, 0, -0.05)), (12.5, (0.21, -0.02, 0)), (8.0, (0.04, 0.0, 0.02)),
     (5.0, (0.2, 0, 0)), (2.1, (0.02, 0, 0)), (0.4, (0.01, 0, 0))),
    (0.02, 0, 0), (0, _H, 0))

ARMS = {arm.name: arm for arm in (UR5E, IIWA14, SCARA, RAIL)}


def perturbed(arm, rng, angle, length):
    """The arm with every joint origin turned by about `angle` rad and moved by about `length` m on each axis."""
    def move(joint):
        origin = pin.SE3(pin.rpy.rpyToMatrix(*joint.rpy), np.array(joint.xyz, float))
        origin = origin * pin.SE3(pin.exp3(rng.normal(0, angle, 3)), rng.normal(0, length, 3))
        return replace(joint, xyz=tuple(origin.translation), rpy=tuple(pin.rpy.matrixToRpy(origin.rotation)))
    return replace(arm, joints=tuple(move(joint) for joint in arm.joints))


def to_urdf(arm, inertials=True):
    """URDF text; every number at full precision, inertia of a solid ball with a diameter of a tenth of a metre."""
    def numbers(values):
        return " ".join(repr(float(v) + 0.0) for v in values)
    lines = ['<?xml version="1.0"?>', f'<robot name="{arm.name}">', '  <link name="base"/>']
    parent = "base"
    for i, joint in enumerate(arm.joints):
        link = f"link_{i + 1}"
        mass, centre = arm.links[i]
        ball = 0.4 * mass * 0.05**2
        body = (f'<inertial><origin xyz="{numbers(centre)}"/><mass value="{mass}"/><inertia ixx="{ball}" ixy="0" ixz="0" '
                f'iyy="{ball}" iyz="0" izz="{ball}"/></inertial>') if inertials else ""
        lines += [f'  <link name="{link}">{body}</link>', f'  <joint name="{joint.name}" type="{joint.kind}">',
                  f'    <parent link="{parent}"/><child link="{link}"/>',
                  f'    <origin xyz="{numbers(joint.xyz)}" rpy="{numbers(joint.rpy)}"/><axis xyz="{numbers(joint.axis)}"/>',
                  f'    <limit lower="{joint.limits[0]}" upper="{joint.limits[1]}" effort="100" velocity="3"/>', '  </joint>']
        parent = link
    lines += ['  <link name="tip"/>', '  <joint name="tip_fixed" type="fixed">',
              f'    <parent link="{parent}"/><child link="tip"/>',
              f'    <origin xyz="{numbers(arm.tip_xyz)}" rpy="{numbers(arm.tip_rpy)}"/>', '  </joint>', '</robot>', '']
    return "\n".join(lines)
