"""To and from the packages beside this one, each tested against the real package."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import denavit as dn


def real(name: str) -> Any:
    return pytest.importorskip(name, reason=f"skipped, because {name} is not installed")


def test_yourdfpy_both_ways(ur5e: dn.Robot, chain: dn.Chain) -> None:
    yourdfpy = real("yourdfpy")
    theirs = chain.to_yourdfpy()
    assert isinstance(theirs, yourdfpy.URDF)
    for q in chain.sample(10):
        theirs.update_cfg(dict(zip(chain.joints, q, strict=True)))
        np.testing.assert_allclose(chain.fk(q), theirs.get_transform("tool0", "base"), atol=1e-12)
    assert dn.diff(ur5e, dn.load(theirs), only="kinematics").same


def test_pinocchio_has_the_same_kinematics_and_mass_matrix() -> None:
    pinocchio = real("pinocchio")
    path = "robots/franka/panda.urdf"
    robot = dn.load(path)
    mine, theirs = robot.chain().to_pinocchio(), pinocchio.buildModelFromXML(robot.urdf, mimic=True)
    assert mine == theirs
    q = pinocchio.neutral(theirs)
    a, b = mine.createData(), theirs.createData()
    np.testing.assert_array_equal(pinocchio.crba(mine, a, q), pinocchio.crba(theirs, b, q))


@pytest.mark.parametrize("convention", ["distal", "proximal"])
def test_roboticstoolbox_in_both_conventions(chain: dn.Chain, convention: Any) -> None:
    rtb = real("roboticstoolbox")
    theirs = chain.to_roboticstoolbox(convention)
    assert isinstance(theirs, rtb.DHRobot)
    assert theirs.mdh == (convention == "proximal")
    for q in chain.sample(10):
        np.testing.assert_allclose(chain.fk(q), theirs.fkine(q).A, atol=1e-12)
        np.testing.assert_allclose(chain.jacobian(q, "tip")[[3, 4, 5, 0, 1, 2]], theirs.jacob0(q), atol=1e-12)


def test_rotations_of_scipy_and_poses_of_spatialmath(chain: dn.Chain) -> None:
    rotations, spatialmath = real("scipy.spatial.transform"), real("spatialmath")
    T = chain.fk(chain.sample(5))
    again = rotations.Rotation.from_matrix(T[:, :3, :3]).as_matrix()
    np.testing.assert_allclose(again, T[:, :3, :3], atol=1e-14)
    assert len(spatialmath.SE3(list(T), check=True)) == 5


def test_robot_descriptions_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    real("robot_descriptions")
    import sys
    import types

    described = types.ModuleType("robot_descriptions.my_arm_description")
    described.URDF_PATH = "robots/universal_robots/ur5e.urdf"  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, described.__name__, described)
    assert dn.load("my_arm_description").name == "ur5e"
    with pytest.raises(dn.ReadError):
        dn.load("no_such_arm_description")


def test_a_robot_that_robot_descriptions_lists_is_a_source() -> None:
    listed = real("robot_descriptions._descriptions").DESCRIPTIONS
    assert "ur5e_description" in listed
    # Reading one of these clones a repository, which no test does: what is read is the path that such a module names, above.


def test_urchin_both_chains_agree(ur5e: dn.Robot, chain: dn.Chain) -> None:
    urchin = real("urchin")
    theirs = urchin.URDF.load(ur5e.file)
    again = dn.load(theirs)
    assert dn.diff(ur5e, again, only="kinematics").same
    for q in chain.sample(5):
        placed = theirs.link_fk(dict(zip(chain.joints, q, strict=True)), use_names=True)
        expected = np.linalg.inv(placed["base"]) @ placed["tool0"]
        np.testing.assert_allclose(again.chain("base", "tool0").fk(q), expected, atol=1e-9)
