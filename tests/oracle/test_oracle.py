"""The oracle itself: `kinematics.py` compared with poses computed by hand, and where yourdfpy and pinocchio deviate from URDF."""

import numpy as np
import pytest

from fk import Pinocchio, Yourdfpy, chains, span
from kinematics import Tree, distance


def robot(tmp_path, joints):
    path = tmp_path / "robot.urdf"
    links = "".join(f'<link name="{name}"/>' for name in "abcd" if f'link="{name}"' in joints)
    path.write_text(f'<robot name="r">{links}{joints}</robot>', encoding="utf-8")
    return path


def joint(name, kind, parent, child, inside=""):
    return f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'


LIMIT = '<limit lower="-2" upper="2" effort="1" velocity="1"/>'
Z = '<axis xyz="0 0 1"/>'
OFFSET = '<origin xyz="1 0 0"/>'
PARTS = {
    "no origin, no axis": joint("j", "continuous", "a", "b") + joint("k", "fixed", "b", "c", '<origin xyz="0 1 0"/>'),
    "axis of length 2": joint("j", "revolute", "a", "b", OFFSET + '<axis xyz="0 0 2"/>' + LIMIT)
    + joint("k", "fixed", "b", "c", OFFSET),
    "slide along an axis of length 2": joint("j", "prismatic", "a", "b", '<axis xyz="0 0 2"/>' + LIMIT)
    + joint("k", "fixed", "b", "c", OFFSET),
    "mimic with an offset": joint("j", "revolute", "a", "b", Z + LIMIT)
    + joint("k", "revolute", "b", "c", OFFSET + Z + LIMIT + '<mimic joint="j" multiplier="-2" offset="0.25"/>')
    + joint("l", "fixed", "c", "d", OFFSET),
    "mimic without numbers": joint("j", "revolute", "a", "b", Z + LIMIT)
    + joint("k", "revolute", "b", "c", OFFSET + Z + LIMIT + '<mimic joint="j"/>')
    + joint("l", "fixed", "c", "d", OFFSET),
    "mimic of a mimic": joint("j", "revolute", "a", "b", Z + LIMIT)
    + joint("k", "revolute", "b", "c", OFFSET + Z + LIMIT + '<mimic joint="j" multiplier="0.5" offset="0.1"/>')
    + joint("l", "revolute", "c", "d", OFFSET + Z + LIMIT + '<mimic joint="k" multiplier="-3" offset="0.2"/>'),
}


def plane(x, y, turn):
    """A pose in the x-y plane."""
    c, s = np.cos(turn), np.sin(turn)
    return np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, 0], [0, 0, 0, 1]])


def by_hand(part, q):
    """The pose of the last link, from the geometry."""
    if part == "no origin, no axis":
        c, s = np.cos(q), np.sin(q)
        return np.array([[1, 0, 0, 0], [0, c, -s, c], [0, s, c, s], [0, 0, 0, 1]])
    if part == "axis of length 2":
        return plane(1, 0, q) @ plane(1, 0, 0)
    if part == "slide along an axis of length 2":
        pose = plane(1, 0, 0)
        pose[2, 3] = q
        return pose
    if part == "mimic with an offset":
        return plane(0, 0, q) @ plane(1, 0, -2 * q + 0.25) @ plane(1, 0, 0)
    if part == "mimic without numbers":
        return plane(0, 0, q) @ plane(1, 0, q) @ plane(1, 0, 0)
    second = 0.5 * q + 0.1
    return plane(0, 0, q) @ plane(1, 0, second) @ plane(1, 0, -3 * second + 0.2)


SHORTFALLS = {
    (Yourdfpy, "slide along an axis of length 2"): "slides by q times the axis as written",
    (Yourdfpy, "mimic of a mimic"): "takes the mimicked joint to stand at 0",
}


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("program", [None, Yourdfpy, Pinocchio], ids=lambda p: p.__name__ if p else "numpy")
def test_pose_is_the_one_worked_out_by_hand(tmp_path, program, part):
    path = robot(tmp_path, PARTS[part])
    tree = Tree(path)
    tip = tree.leaves[0]
    witness = program(path) if program else None
    wrong = 0
    for q in (-1.3, 0.4, 1.7):
        if witness:
            witness.update(tree, {"j": q})
        pose = witness.pose("a", tip) if witness else tree.pose("a", tip, {"j": q})
        wrong += max(distance(pose, by_hand(part, q))) > 1e-12
    assert wrong == (3 if (program, part) in SHORTFALLS else 0)


def test_chain_below_a_floating_joint_starts_at_its_child(tmp_path):
    path = robot(tmp_path, joint("f", "floating", "a", "b") + joint("j", "continuous", "b", "c") + joint("k", "fixed", "c", "d"))
    assert chains(Tree(path)) == ([("b", "d")], [])


def test_mimic_of_a_missing_joint_or_of_itself_is_an_error_and_not_a_pose(tmp_path):
    for driver in ("nobody", "k"):
        joints = joint("j", "continuous", "a", "b") + joint("k", "continuous", "b", "c", f'<mimic joint="{driver}"/>')
        pairs, errors = chains(Tree(robot(tmp_path, joints)))
        assert pairs == [] and len(errors) == 1 and errors[0][0] == "c"


def test_values_come_from_the_limits_kept_to_a_turn_and_ten_metres(tmp_path):
    wide = '<limit lower="-1000" upper="1000" effort="1" velocity="1"/>'
    joints = (
        joint("j", "revolute", "a", "b", LIMIT) + joint("k", "revolute", "b", "c", wide) + joint("l", "prismatic", "c", "d", wide)
    )
    tree = Tree(robot(tmp_path, joints))
    assert [span(tree.by_name[name]) for name in "jkl"] == [(-2, 2), (-2 * np.pi, 2 * np.pi), (-10, 10)]
