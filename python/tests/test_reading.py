"""What is given is read as what it says: units, conventions and column names, never by a guess; or it is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import denavit as dn

UR5E = "robots/universal_robots/ur5e.urdf"
CONVENTIONS = ("distal", "proximal", "paper", "hayati")
ROBOTS = [
    UR5E,
    "robots/franka/panda.urdf",
    "robots/denso/hsr065_screw_spline.urdf",
    "robots/kuka/kr16_2_on_rail.urdf",
    "robots/robotiq/2f_85.urdf",
]
pandas = pytest.importorskip("pandas", reason="skipped, because pandas is not installed")


def test_numbers_of_a_mapping_are_rad_and_m_whatever_their_size() -> None:
    long = dn.load({"theta": [0, 0], "d": [8, 0], "alpha": [np.pi / 2, 0], "a": [0, 15.0]}).chain()
    np.testing.assert_allclose(long.tips([0, 0]), [15, 0, 8], atol=1e-12)
    turned = dn.load({"theta": [0, 7.0], "d": [0, 0], "alpha": 0, "a": [1, 1]}).chain()
    np.testing.assert_allclose(turned.tips([0, 0]), [1 + np.cos(7), np.sin(7), 0], atol=1e-12)
    frame = pandas.DataFrame({"theta": [0, 90.0], "d": [400.0, 0], "alpha": 0.0, "a": [1000.0, 2000.0]})
    tip = dn.load(frame).chain().tips([0, 0])
    np.testing.assert_allclose(tip, [1000 + 2000 * np.cos(90), 2000 * np.sin(90), 400], atol=1e-9)


def test_headings_state_units_as_those_of_a_file_do() -> None:
    columns = {"θ (deg)": [0, 90], "d_mm": [400, 0], "Alpha [rad]": 0.0, "a": [1, 2]}
    expected = [1, 2, 0.4]
    np.testing.assert_allclose(dn.load(columns).chain().tips([0, 0]), expected, atol=1e-12)
    np.testing.assert_allclose(dn.load(pandas.DataFrame(columns)).chain().tips([0, 0]), expected, atol=1e-12)
    stated = dn.load({"theta": [0, 90], "d": [400, 0], "alpha": 0, "a": [1000, 2000]}, table_units="mm,deg")
    np.testing.assert_allclose(stated.chain().tips([0, 0]), expected, atol=1e-12)
    half = dn.load({"theta": [0, 90], "d": [0.4, 0], "alpha": 0, "a": [1, 2]}, table_units="deg")
    np.testing.assert_allclose(half.chain().tips([0, 0]), expected, atol=1e-12)


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_table_as_a_frame_is_the_same_robot_in_every_convention(robot: str, convention: str) -> None:
    chain = dn.load(robot).chain()
    table = chain.table(convention)
    frame = table.to_pandas()
    q = chain.sample(20)
    expected = table.chain.fk(q)
    for source in (
        frame,
        frame.reset_index(),
        frame.reset_index().to_dict("list"),
        frame.reset_index().to_dict("records"),
        table,
    ):
        again = dn.load(source).chain()
        assert again.n == chain.n
        np.testing.assert_allclose(again.fk(q), expected, atol=1e-9 * max(1, chain.size))
        assert again.table().convention == convention


def test_a_frame_without_its_base_row_still_says_its_convention() -> None:
    frame = dn.load(UR5E).chain().table("proximal").to_pandas()
    assert dn.load(frame.drop(index=["base", "tool"])).chain().table().convention == "proximal"
    unnamed = frame.rename_axis(None)
    np.testing.assert_allclose(dn.load(unnamed).chain().tips([0] * 6), dn.load(UR5E).chain().tips([0] * 6), atol=1e-12)


def test_labels_of_a_frame_are_never_dropped() -> None:
    numbers = {"theta": [0.0, 0.0], "d": [0.0, 0.0], "alpha": [0.0, 0.0], "a": [1.0, 2.0]}
    assert dn.load(pandas.DataFrame(numbers, index=["shoulder", "elbow"])).chain().joints == ("shoulder", "elbow")
    with pytest.raises(dn.ArgumentError, match="index"):
        dn.load(pandas.DataFrame(numbers | {"joint": ["a", "b"]}, index=["shoulder", "elbow"]))
    twice = pandas.DataFrame(np.zeros((2, 5)), columns=["theta", "d", "alpha", "a", "a"])
    with pytest.raises(dn.DenavitError, match="two columns"):
        dn.load(twice)
    with pytest.raises(dn.DenavitError, match="same column"):
        dn.load({"theta": [0, 0], "θ": [1, 1], "d": 0, "alpha": 0, "a": 1})


@pytest.mark.parametrize(
    "wrong",
    [
        {"theta": 0, "d": 0, "alpha": 0, "a": [1, 2], "colour": "red"},
        {"theta": 0, "d": 0, "alpha": 0, "a": [1, 2], "joint": ["a\nb", "c"]},
        {"theta": 0, "d": 0, "alpha": 0, "a": [1, 2], "row": ["#1", "2"]},
        {"theta": 0, "d": 0, "alpha": 0, "a": [1, object()]},
        {"theta": np.zeros((2, 2)), "d": 0, "alpha": 0, "a": 0},
        {"theta": 0, "d": 0, "alpha": 0, "a": [1, 2j]},
        {"theta": 0, "d": 0, "alpha": 0, "a": 10**400},
        {"theta": 0, "d": 0, "alpha": 0, "a": [10**400, 1]},
    ],
)
def test_what_no_table_has_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(dn.DenavitError):
        dn.load(wrong)


def test_options_that_notes_name_are_keywords(tmp_path: Path) -> None:
    file = tmp_path / "vendor.csv"
    file.write_text("joint,theta,d,alpha,a\nj1,0,400,90,25\nj2,0,0,0,560\n")
    guessed = dn.load(file)
    assert any("table_units=" in note for note in guessed.notes)
    assert any("table_convention=" in note for note in guessed.notes)
    stated = dn.load(file, table_units="mm,deg", table_convention="mdh")
    assert not any("not stated" in note for note in stated.notes)
    assert stated.chain().table().convention == "proximal"
    metres = dn.load(file, table_units="m,rad")
    assert metres.chain().size > 500
    # The page reads the text alone.
    assert dn.load(metres._self_contained, file="vendor.csv").chain().size == pytest.approx(metres.chain().size)
    with pytest.raises(dn.ArgumentError, match="not a unit"):
        dn.load(file, table_units="furlong")
    with pytest.raises(dn.ArgumentError, match="same"):
        dn.load(file, convention="distal", table_convention="distal")
    with pytest.raises(dn.DenavitError):
        dn.load(
            {"row": ["base", "1", "tool"], "kind": ["proximal", "", ""], "theta": 0, "d": 0, "alpha": 0, "a": 1},
            convention="distal",
        )


@pytest.mark.parametrize(
    ("word", "convention"),
    [
        ("mdh", "proximal"),
        ("MDH", "proximal"),
        ("craig", "proximal"),
        ("sdh", "distal"),
        ("DH", "distal"),
        ("standard", "distal"),
    ],
)
def test_one_list_of_convention_words(word: str, convention: str, chain: dn.Chain) -> None:
    assert chain.table(word).convention == convention
    rows = {"theta": 0, "d": 0, "alpha": 0, "a": [1, 2]}
    assert dn.load(rows, convention=word).chain().table().convention == convention
    assert dn.load(rows, table_convention=word).chain().table().convention == convention
    assert chain.table("distal").match("robots/universal_robots/ur5e_dh.csv", convention="dh").exact


def test_joint_values_with_names_are_put_in_order(chain: dn.Chain) -> None:
    q = chain.sample(5, seed=3)
    named = pandas.DataFrame(q, columns=chain.joints)
    backwards = named[list(chain.joints)[::-1]].assign(time=1.0)
    for given in (named, backwards, backwards.to_dict("list"), {joint: q[:, at] for at, joint in enumerate(chain.joints)}):
        np.testing.assert_array_equal(chain.fk(given), chain.fk(q))
        np.testing.assert_array_equal(chain.tips(given), chain.tips(q))
        np.testing.assert_array_equal(chain.jacobian(given), chain.jacobian(q))
    np.testing.assert_array_equal(chain.tips(backwards.iloc[0]), chain.tips(q[0]))
    np.testing.assert_array_equal(chain.tips(dict(zip(chain.joints[::-1], q[0][::-1], strict=True))), chain.tips(q[0]))
    np.testing.assert_array_equal(chain.tips(pandas.DataFrame(q)), chain.tips(q))
    np.testing.assert_array_equal(chain.tips(q.tolist()), chain.tips(q))


@pytest.mark.parametrize("columns", [["q1", "q2", "q3", "q4", "q5", "q6"], ["shoulder_pan_joint"] * 6, [5, 4, 3, 2, 1, 0]])
def test_names_that_are_no_joints_are_refused(columns: list[Any], chain: dn.Chain) -> None:
    frame = pandas.DataFrame(chain.sample(3), columns=columns)
    for call in (chain.fk, chain.tips, chain.jacobian):
        with pytest.raises(dn.ArgumentError):
            call(frame)
    with pytest.raises(dn.ArgumentError, match="structured"):
        chain.fk(np.zeros(3, dtype=[(joint, "f8") for joint in chain.joints]))


def test_a_gripper_of_pinocchio_stays_coupled() -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="skipped, because pinocchio is not installed")
    robot = dn.load("robots/franka/panda.urdf")
    model = robot.chain().to_pinocchio()
    assert model.nv == 8
    data = model.createData()
    for tip in ("panda_leftfinger", "panda_rightfinger"):
        chain = robot.chain(tip=tip)
        frames = model.getFrameId(chain.base), model.getFrameId(tip)
        for q in chain.sample(5):
            pinocchio.framesForwardKinematics(model, data, q)
            base, end = (data.oMf[frame].homogeneous for frame in frames)
            np.testing.assert_allclose(np.linalg.inv(base) @ end, chain.fk(q), atol=1e-9)


def test_a_slide_that_follows_a_turn_stays_coupled_in_pinocchio() -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="skipped, because pinocchio is not installed")
    chain = dn.load("robots/denso/hsr065_screw_spline.urdf").chain()
    model = chain.to_pinocchio()
    data, frames = model.createData(), (model.getFrameId(chain.base), model.getFrameId(chain.tip))
    names = [str(name) for name in model.names]
    for q in chain.sample(5):
        theirs = pinocchio.neutral(model)
        for name, value in zip(chain.joints, q, strict=True):
            joint = model.joints[names.index(name)]
            theirs[joint.idx_q : joint.idx_q + joint.nq] = [np.cos(value), np.sin(value)] if joint.nq == 2 else [value]
        pinocchio.framesForwardKinematics(model, data, theirs)
        base, end = (data.oMf[model_frame].homogeneous for model_frame in frames)
        np.testing.assert_allclose(np.linalg.inv(base) @ end, chain.fk(q), atol=1e-9)


def test_followers_that_pinocchio_cannot_couple_are_refused_and_never_freed() -> None:
    pytest.importorskip("pinocchio", reason="skipped, because pinocchio is not installed")
    with pytest.raises(dn.ExportError, match="mimics another"):
        dn.load("robots/robotiq/2f_85.urdf").chain().to_pinocchio()


def test_what_the_canonical_robot_must_have_said_of_it_is_said() -> None:
    text = Path(UR5E).read_text().replace("1.5707963267948966", "1.5708")
    robot = dn.load(text, file="cut.urdf").canonical()
    assert any("1.5708" in note for note in robot.notes)
    kept = dn.load(UR5E).canonical(keep_link_frames=True)
    assert dn.diff(kept, dn.load(UR5E).canonical(link_frames="keep")).same


MJCF = """<mujoco model="arm"><worldbody><body name="base"><geom size=".1"/><body name="tip" pos="0 0 .5">
  <joint name="j" axis="0 1 0" range="-90 90"/><geom size=".1"/></body></body></worldbody></mujoco>"""
SDF = """<sdf version="1.9"><model name="arm"><link name="base"/><link name="tip"><pose>0 0 .5 0 0 0</pose></link>
  <joint name="j" type="revolute"><parent>base</parent><child>tip</child><axis><xyz>0 1 0</xyz>
  <limit><lower>-1.5707963267948966</lower><upper>1.5707963267948966</upper></limit></axis></joint></model></sdf>"""


@pytest.mark.parametrize(("name", "text"), [("arm.xml", MJCF), ("arm.sdf", SDF)], ids=["MJCF", "SDF"])
def test_mjcf_and_sdf_are_robots(name: str, text: str, tmp_path: Path) -> None:
    (tmp_path / name).write_text(text, encoding="utf-8")
    chain = dn.load(str(tmp_path / name)).chain()
    turned = chain.fk([np.pi / 2])
    np.testing.assert_allclose(np.asarray(turned)[:3, 3], [0, 0, 0.5], atol=1e-12)
    np.testing.assert_allclose(np.asarray(turned)[:3, 0], [0, 0, -1], atol=1e-12)
