"""Inverse kinematics: every branch leads back to its pose."""

from __future__ import annotations

import numpy as np
import pytest

import denavit as dn

UR5E = "robots/universal_robots/ur5e.urdf"


@pytest.fixture(scope="module")
def chain() -> dn.Chain:
    return dn.load(UR5E).chain("base", "tool0")


def test_every_branch_leads_back_to_its_pose(chain: dn.Chain) -> None:
    rng = np.random.default_rng(1)
    poses = chain.fk(rng.uniform(-3, 3, (50, 6)))
    found = chain.ik(poses)
    assert found.q.shape[0] == 50 and found.q.shape[2] == 6 and found.mask.shape == found.q.shape[:2] == found.names.shape
    assert found.reached.all() and found.mask.any(axis=1).all() and len(found) == 50
    for row in range(50):
        branches = found.q[row][found.mask[row]]
        assert np.abs(chain.fk(branches) - poses[row]).max() < 1e-9
    assert "parallel" in found.method
    named = np.isfinite(found.q[..., 0])
    assert all((name is not None) == there for name, there in zip(found.names.flat, named.flat, strict=True))
    assert all(len(set(row[there])) == there.sum() for row, there in zip(found.names, named, strict=True) if there.sum() <= 8)
    assert chain.ik(np.zeros((0, 4, 4))).q.shape == (0, 0, 6)


def test_a_path_keeps_its_branch_and_one_pose_has_no_leading_axis(chain: dn.Chain) -> None:
    start = np.array([0.3, -1.2, 1.4, -0.5, -1.3, 0.2])
    path = start + np.linspace(0, 0.5, 40)[:, None]
    assert np.abs(chain.ik(chain.fk(path), q0=start).best - path).max() < 1e-8
    one = chain.ik(chain.fk(start), q0=dict(zip(chain.joints, start, strict=True)))
    assert one.q.shape == (8, 6) and bool(one.reached) and np.allclose(one.best, start)


def test_what_is_no_pose_is_refused_and_what_is_far_has_a_nearest(chain: dn.Chain) -> None:
    far = np.eye(4)
    far[0, 3] = 9.0
    found = chain.ik(far)
    assert not found.reached and not found.mask.any() and np.isfinite(found.best).all()
    for wrong in (np.eye(3), "x", np.full((4, 4), np.nan), np.diag([1.0, 2.0, 1.0, 1.0]), [[1, 2], [3]]):
        with pytest.raises(dn.ArgumentError, match="pose"):
            chain.ik(wrong)
    with pytest.raises(dn.ArgumentError, match="q0"):
        chain.ik(far, q0=[1.0, 2.0])
