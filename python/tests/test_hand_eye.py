"""Hand-eye calibration from arrays of poses."""

import numpy as np
import pytest

import denavit as dn

CHAIN = dn.load("robots/universal_robots/ur5e.urdf").chain()


def rows(on_hand: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    robot = CHAIN.fk(CHAIN.sample(20, seed=2))
    base, tip = CHAIN.fk([0.5, -1, 1, 0.3, 0.2, 0.1]), CHAIN.fk([2, -2, 0.4, 1, 1, 1])
    tip[:3, 3] *= 0.1
    seen = np.linalg.inv(robot @ tip) @ base if on_hand else np.linalg.inv(base) @ robot @ tip
    return robot, seen, base, tip


@pytest.mark.parametrize("on_hand", [False, True])
def test_both_places_come_out(on_hand: bool) -> None:
    robot, seen, base, tip = rows(on_hand)
    found = dn.hand_eye(robot, seen, on_hand=on_hand)
    np.testing.assert_allclose(found.base, base, atol=1e-9)
    np.testing.assert_allclose(found.tip, tip, atol=1e-9)
    np.testing.assert_allclose(found.instrument, tip if on_hand else base, atol=1e-9)
    assert found.unknown is None
    assert not found.rejected.any()
    assert found.to_json()["schema"] == "denavit.hand_eye/1"
    assert str(found).startswith("hand-eye calibration of 20 pairs of poses")


def test_what_cannot_be_is_refused() -> None:
    robot, seen, _, _ = rows(False)
    with pytest.raises(dn.ArgumentError, match="the same number of poses"):
        dn.hand_eye(robot, seen[:5])
    with pytest.raises(dn.ArgumentError, match="seen has shape"):
        dn.hand_eye(robot, seen[:, :3])
    with pytest.raises(dn.ArgumentError, match="do not agree"):
        dn.hand_eye(robot, seen, on_hand=True)
