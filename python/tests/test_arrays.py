"""Joint values in, poses and Jacobians out: shapes, copies, refusals, and numbers that yourdfpy and pinocchio give."""

from __future__ import annotations

import threading

import numpy as np
import pytest

import denavit as dn


def test_shapes_follow_those_of_the_joint_values(chain: dn.Chain) -> None:
    for leading in [(), (1,), (7,), (200,), (2, 3), (0,)]:
        q = chain.sample(int(np.prod(leading)), seed=3).reshape(*leading, 6)
        assert chain.fk(q).shape == (*leading, 4, 4)
        assert chain.tips(q).shape == (*leading, 3)
        assert chain.jacobian(q).shape == (*leading, 6, 6)
        assert np.array_equal(chain.fk(q)[..., :3, 3], chain.tips(q))


@pytest.mark.parametrize("threads", [0, 1, 2, 5])
def test_many_are_as_one_at_a_time(chain: dn.Chain, threads: int) -> None:
    q = chain.sample(500, seed=1)
    one = [np.stack([method(row) for row in q]) for method in (chain.fk, chain.tips, chain.jacobian)]
    many = [method(q, threads=threads) for method in (chain.fk, chain.tips, chain.jacobian)]
    for a, b in zip(one, many, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-14)


def test_results_go_into_out_without_a_copy(chain: dn.Chain) -> None:
    q = chain.sample(100)
    for method, shape in [(chain.fk, (100, 4, 4)), (chain.tips, (100, 3)), (chain.jacobian, (100, 6, 6))]:
        out = np.full(shape, np.nan)
        assert method(q, out=out) is out
        assert np.array_equal(out, method(q))


@pytest.mark.parametrize(
    ("out", "why"),
    [
        (np.zeros((10, 3), dtype=np.float32), "not an array of float64"),
        (np.zeros((9, 3)), r"shape \(9, 3\)"),
        (np.zeros((3, 10)).T, "is not C-contiguous"),
        ([[0.0] * 3] * 10, "not an array"),
    ],
)
def test_an_out_that_cannot_be_written_in_place_is_refused(chain: dn.Chain, out: object, why: str) -> None:
    with pytest.raises(dn.ArgumentError, match=why) as refused:
        chain.tips(chain.sample(10), out=out)  # type: ignore[arg-type]
    assert refused.value.hint == "give a C-contiguous float64 array of shape (10, 3)"


def test_a_read_only_out_and_one_that_is_the_joint_values_are_refused(chain: dn.Chain) -> None:
    frozen = np.zeros((10, 3))
    frozen.flags.writeable = False
    with pytest.raises(dn.ArgumentError, match="cannot be written"):
        chain.tips(chain.sample(10), out=frozen)
    shared = np.zeros(60)
    with pytest.raises(dn.ArgumentError, match="cannot be written"):
        chain.tips(shared.reshape(10, 6), out=shared[:30].reshape(10, 3))


def test_what_numpy_makes_an_array_of_is_taken(chain: dn.Chain) -> None:
    q = chain.sample(4)
    expected = chain.tips(q)
    for given in (q.tolist(), np.asfortranarray(q), q[::-1][::-1], q.astype(object)):
        assert np.array_equal(chain.tips(given), expected)
    for wrong in (q[:, :5], 1.0, "q", [["a"] * 6], None):
        with pytest.raises(dn.ArgumentError, match=r"^q is "):
            chain.tips(wrong)  # type: ignore[arg-type]


def test_samples_are_within_the_limits_and_repeat(chain: dn.Chain) -> None:
    q = chain.sample(1000, seed=5)
    assert (q >= chain.ranges[:, 0]).all()
    assert (q <= chain.ranges[:, 1]).all()
    assert np.array_equal(q, chain.sample(1000, seed=5))
    assert not np.array_equal(q, chain.sample(1000, seed=6))


def test_jacobians_are_the_derivatives_of_forward_kinematics(chain: dn.Chain) -> None:
    q, step = chain.sample(1, seed=2)[0], 1e-6
    pose = chain.fk(q)
    turned, p = pose[:3, :3], pose[:3, 3]
    space, body, tip = (chain.jacobian(q, frame) for frame in ("space", "body", "tip"))
    for k in range(6):
        ahead, behind = q.copy(), q.copy()
        ahead[k] += step
        behind[k] -= step
        rate = (chain.fk(ahead) - chain.fk(behind)) / (2 * step)
        spin = rate[:3, :3] @ turned.T
        omega = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
        np.testing.assert_allclose(tip[:, k], [*omega, *rate[:3, 3]], atol=1e-8)
        np.testing.assert_allclose(space[:, k], [*omega, *(rate[:3, 3] - np.cross(omega, p))], atol=1e-8)
        np.testing.assert_allclose(body[:, k], [*(turned.T @ omega), *(turned.T @ rate[:3, 3])], atol=1e-8)
    with pytest.raises(dn.ArgumentError, match=r"write space \(world\), body \(local\) or tip"):
        chain.jacobian(q, "base")  # type: ignore[arg-type]


def test_threads_of_python_share_a_chain(chain: dn.Chain) -> None:
    q = chain.sample(20_000)
    expected, results = chain.tips(q), []
    workers = [threading.Thread(target=lambda: results.append(chain.tips(q))) for _ in range(4)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    assert len(results) == 4
    assert all(np.array_equal(result, expected) for result in results)


def test_forward_kinematics_are_those_of_pinocchio(ur5e: dn.Robot, chain: dn.Chain) -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="skipped, because pinocchio is not installed")
    model = pinocchio.buildModelFromUrdf(ur5e.file)
    data = model.createData()
    tip = model.getFrameId("tool0")
    base = model.getFrameId("base")
    for q in chain.sample(50, seed=4):
        pinocchio.forwardKinematics(model, data, q)
        pinocchio.updateFramePlacements(model, data)
        expected = (data.oMf[base].inverse() * data.oMf[tip]).homogeneous
        np.testing.assert_allclose(chain.fk(q), expected, atol=1e-14)
