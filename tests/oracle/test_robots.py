"""The robots of this repository compared with their vendors' D-H tables and, if any, the vendors' URDFs."""

import json
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
import yourdfpy

from kinematics import DhTable, PoeList, Tree, distance, rot_z, translation

WORKSPACE = Path(__file__).resolve().parents[2]
ROBOTS = WORKSPACE / "robots"
SHARED = WORKSPACE.parent / "shared"
SAMPLES = 200
HALF, QUARTER = np.pi, np.pi / 2


@dataclass
class Table:
    """A vendor table and its frames, senses and zeros in our URDF: q_table = sense q + zero."""

    urdf: str
    table: str
    base: str
    tip: str
    base_from_table: np.ndarray = field(default_factory=lambda: np.eye(4))
    table_from_tip: np.ndarray = field(default_factory=lambda: np.eye(4))
    sense: tuple = None
    zero: tuple = None


@dataclass
class VendorUrdf:
    """A vendor's URDF of the same arm: (base, tip) in ours and in theirs, and the largest distance in m (SOURCE.md says why)."""

    ours: str
    frames: tuple
    theirs: str
    their_frames: tuple
    metres: float


BAXTER_BASE = translation(0.055695, 0, 0.011038)
TABLES = [
    Table("universal_robots/ur5e", "universal_robots/ur5e_dh", "base", "tool0"),
    Table("universal_robots/ur5", "universal_robots/ur5_dh", "base", "tool0"),
    Table("universal_robots/ur10", "universal_robots/ur10_dh", "base", "tool0"),
    Table("universal_robots/ur10e", "universal_robots/ur10e_dh", "base", "tool0"),
    Table("franka/panda", "franka/panda_dh", "panda_link0", "panda_link7"),
    Table("franka/panda", "franka/panda_dh", "panda_link0", "panda_link8", table_from_tip=translation(0, 0, 0.107)),
    Table("kuka/iiwa14", "kuka/iiwa14_dh", "base_link", "tool0"),
    Table("abb/irb120", "abb/irb120_dh", "base_link", "tool0", table_from_tip=rot_z(HALF)),
    Table("unimation/puma560", "unimation/puma560_dh", "base_link", "tool0"),
    Table("stanford/stanford_arm", "stanford/stanford_arm_dh", "base_link", "tool0"),
    Table("ufactory/xarm7", "ufactory/xarm7_dh", "link_base", "link_eef"),
    Table("adept/cobra600", "adept/cobra600_dh", "base_link", "tool0"),
    Table(
        "kuka/kr16_2_on_rail",
        "kuka/kr16_2_dh",
        "carriage",
        "tool0",
        table_from_tip=rot_z(HALF),
        sense=(-1, 1, 1, -1, 1, -1),
        zero=(0, QUARTER, -QUARTER, 0, 0, 0),
    ),
    Table("rethink/baxter", "rethink/baxter_left_arm_dh", "left_arm_mount", "left_wrist", BAXTER_BASE),
    Table("rethink/baxter", "rethink/baxter_right_arm_dh", "right_arm_mount", "right_wrist", BAXTER_BASE),
]

WHEELS = Path(yourdfpy.__file__).parents[1]
EXAMPLE = WHEELS / "cmeel.prefix/share/example-robot-data/robots"
LIBRARY = WHEELS / "compas_fab/data/robot_library"
XACRO = WHEELS / "rtbdata/xacro"
VENDOR = SHARED / "vendor"
VENDOR_URDFS = [
    VendorUrdf("universal_robots/ur5e", ("base", "tool0"), VENDOR / "xacro/expected/ur5e.urdf", ("base_link_inertia", "tool0"), 1e-9),
    VendorUrdf(
        "universal_robots/ur10e",
        ("base", "tool0"),
        VENDOR / "robots/ros-industrial/ur10e.urdf",
        ("base_link_inertia", "tool0"),
        1e-9,
    ),
    VendorUrdf(
        "franka/panda",
        ("panda_link0", "panda_hand_tcp"),
        EXAMPLE / "panda_description/urdf/panda.urdf",
        ("panda_link0", "panda_hand_tcp"),
        1e-12,
    ),
    VendorUrdf(
        "kuka/iiwa14",
        ("base_link", "tool0"),
        XACRO / "kuka_description/kuka_lbr_iiwa/urdf/lbr_iiwa_14_r820.urdf",
        ("base_link", "tool0"),
        0.9e-3,
    ),
    VendorUrdf(
        "abb/irb120",
        ("base_link", "tool0"),
        LIBRARY / "abb_irb120_3_58/urdf/robot_description.urdf",
        ("base_link", "tool0"),
        1e-12,
    ),
    VendorUrdf(
        "kuka/kr16_2_on_rail",
        ("carriage", "tool0"),
        XACRO / "kuka_description/kuka_kr16/urdf/kr16_2.urdf",
        ("base_link", "tool0"),
        1e-12,
    ),
    VendorUrdf(
        "ufactory/xarm7",
        ("link_base", "link_eef"),
        EXAMPLE / "xarm_description/urdf/xarm7.urdf",
        ("link_base", "link_eef"),
        1e-5,
    ),
    VendorUrdf("rethink/baxter", ("torso", "left_hand"), VENDOR / "robots/oems/baxter.urdf", ("torso", "left_hand"), 1e-4),
    VendorUrdf("rethink/baxter", ("torso", "right_hand"), VENDOR / "robots/oems/baxter.urdf", ("torso", "right_hand"), 1e-4),
    VendorUrdf("rethink/baxter", ("torso", "head"), VENDOR / "robots/oems/baxter.urdf", ("torso", "head"), 1e-12),
    VendorUrdf(
        "robotiq/2f_85",
        ("base_link", "left_finger_tip"),
        VENDOR / "robots/robotiq/robotiq_2f_85.urdf",
        ("robotiq_85_base_link", "robotiq_85_left_finger_tip_link"),
        1e-4,
    ),
]


def load(path):
    """yourdfpy's robot, without meshes."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return yourdfpy.URDF.load(str(path), load_meshes=False, build_collision_scene_graph=False)


def samples(tree, names, seed=1):
    rng = np.random.default_rng(seed)
    limits = [tree.by_name[name].limits or (-np.pi, np.pi) for name in names]
    return [np.array([rng.uniform(low, high) for low, high in limits]) for _ in range(SAMPLES)]


@pytest.mark.parametrize("case", TABLES, ids=lambda case: f"{case.table.split('/')[1]}-{case.tip}")
def test_urdf_agrees_with_the_vendor_table(case):
    path = ROBOTS / f"{case.urdf}.urdf"
    table, tree, robot = DhTable(ROBOTS / f"{case.table}.csv"), Tree(path), load(path)
    names = tree.drivers(case.base, case.tip)
    assert names == table.joints
    assert ["prismatic" if tree.by_name[n].kind == "prismatic" else "revolute" for n in names] == table.kinds
    sense, zero = np.array(case.sense or np.ones(len(names))), np.array(case.zero or np.zeros(len(names)))
    worst = np.zeros(2)
    for q in samples(tree, names):
        expected = case.base_from_table @ table.pose(sense * q + zero) @ case.table_from_tip
        robot.update_cfg(dict(zip(names, q)))
        worst = np.maximum(worst, distance(robot.get_transform(case.tip, case.base), expected))
    print(f"{case.table}: {SAMPLES} poses, worst {worst[0]:.1e} m, {worst[1]:.1e} rad")
    assert max(worst) < 1e-12


@pytest.mark.parametrize("case", VENDOR_URDFS, ids=lambda case: f"{case.ours.split('/')[1]}-{case.frames[1]}")
def test_urdf_agrees_with_the_vendor_urdf(case):
    if not case.theirs.exists():
        pytest.skip(f"skipped, because {case.theirs} is missing")
    ours, theirs = Tree(ROBOTS / f"{case.ours}.urdf"), Tree(case.theirs)
    names, their_names = ours.drivers(*case.frames), theirs.drivers(*case.their_frames)
    assert len(names) == len(their_names)
    worst = np.zeros(2)
    for q in samples(ours, names):
        pose, expected = ours.pose(*case.frames, dict(zip(names, q))), theirs.pose(*case.their_frames, dict(zip(their_names, q)))
        worst = np.maximum(worst, distance(pose, expected))
    print(f"{case.ours}: {SAMPLES} poses, worst {worst[0]:.1e} m, {worst[1]:.1e} rad from {case.theirs.name}")
    assert worst[0] < case.metres and worst[1] < max(1e-9, 5 * case.metres)


@pytest.mark.parametrize("model", ["nominal", "actual"])
def test_poe_list_gives_the_reference_pose_of_the_paper(model):
    reference = SHARED / "puma560_reference.json"
    if not reference.exists():
        pytest.skip(f"skipped, because {reference} is missing")
    expected = np.array(json.loads(reference.read_text())[f"fk_{model}_q45deg"])
    expected[:3, 3] /= 1000
    poe = PoeList(ROBOTS / f"unimation/puma560_{model}_poe.csv")
    assert max(distance(poe.pose(np.full(6, np.pi / 4)), expected)) < 1e-14


def test_ball_screw_spline_lifts_its_shaft_by_one_lead_a_turn():
    path = ROBOTS / "denso/hsr065_screw_spline.urdf"
    tree = Tree(path)
    at = lambda turn: tree.pose("base_link", "tool0", {"joint_1": 0.3, "joint_2": -0.7, "joint_3": 0.1, "joint_4": turn})  # noqa: E731
    before, after = at(-np.pi), at(np.pi)
    assert np.allclose(after[:3, 3] - before[:3, 3], [0, 0, 0.02], atol=1e-15)
    assert np.allclose(after[:3, :3], before[:3, :3], atol=1e-15)


def test_ball_screw_scara_is_the_vendor_urdf_but_for_the_lift():
    path = VENDOR / "robots/denso/hsr065a1_n32_scara.urdf"
    if not path.exists():
        pytest.skip(f"skipped, because {path} is missing")
    ours, theirs = Tree(ROBOTS / "denso/hsr065_screw_spline.urdf"), Tree(path)
    names = ours.drivers("base_link", "tool0")
    assert names == theirs.drivers("base_link", "J4")
    for q in samples(ours, names):
        values = dict(zip(names, q))
        lift = translation(0, 0, 0.02 * q[3] / (2 * np.pi))
        assert max(distance(ours.pose("base_link", "tool0", values), theirs.pose("base_link", "J4", values) @ lift)) < 1e-12


def test_gripper_fingers_stay_upright_and_mirror_each_other():
    tree = Tree(ROBOTS / "robotiq/2f_85.urdf")
    for closing in np.linspace(0, 0.8, 9):
        left, right = (tree.pose("base_link", f"{side}_finger_tip", {"left_knuckle_joint": closing}) for side in ("left", "right"))
        assert np.allclose(left[:3, :3], np.eye(3), atol=1e-15)
        assert np.allclose(right[:3, :3], np.eye(3), atol=1e-15)
        assert np.allclose(left[:3, 3], [-right[0, 3], 0, right[2, 3]], atol=1e-15)


def test_every_robot_names_the_source_of_its_figures():
    for path in sorted(ROBOTS.glob("*/*.urdf")) + sorted(ROBOTS.glob("*/*.csv")):
        source = path.parent / "SOURCE.md"
        assert source.exists(), f"{source} is missing"
        assert path.name in source.read_text(encoding="utf-8"), f"{source} does not name {path.name}"
