"""Hand-eye calibration: the poses of instrument and target from pairs of poses only."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from typing import Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from denavit import _denavit
from denavit.errors import ArgumentError

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class HandEye:
    """A hand-eye calibration; made by `hand_eye`.

    Attributes:
        on_hand: Whether the instrument is on the hand.
        base: What is fixed to the base, shape ``(4, 4)``: base_from_instrument, or base_from_target where the instrument is on
            the hand.
        tip: What is fixed to the tip, shape ``(4, 4)``: tip_from_target, or tip_from_instrument where the instrument is on the
            hand.
        base_std: Standard deviations of x, y, z (m) and of turns about x, y, z (rad), shape ``(6,)``.
        tip_std: The same of `tip`.
        rejected: Rows that were left out as gross outliers, shape ``(N,)``.
        unknown: What the poses do not determine, in words; ``None`` if they determine everything.
    """

    on_hand: bool
    base: Array
    tip: Array
    base_std: Array
    tip_std: Array
    rejected: NDArray[np.bool_]
    unknown: str | None
    _json: dict[str, Any] = field(repr=False)
    _text: str = field(repr=False)

    @property
    def instrument(self) -> Array:
        """Pose of the instrument in the base frame, or in the tip frame if it is on the hand; shape ``(4, 4)``."""
        return self.tip if self.on_hand else self.base

    def to_json(self) -> dict[str, Any]:
        """What `denavit hand-eye --json` prints."""
        return cast("dict[str, Any]", json.loads(json.dumps(self._json)))

    def __str__(self) -> str:
        return self._text


def hand_eye(robot: ArrayLike, seen: ArrayLike, *, on_hand: bool = False) -> HandEye:
    """Hand-eye calibration without joint readings (AX = XB, AX = YB); `denavit hand-eye`.

    Args:
        robot: base_from_tip at each standstill, m, shape ``(N, 4, 4)``.
        seen: instrument_from_target there, m, shape ``(N, 4, 4)``.
        on_hand: The instrument is on the hand and the target is fixed; otherwise the other way round.

    Raises:
        ArgumentError: The shapes do not match, there are fewer than three poses, or the motions do not agree.

    Examples:
        >>> import denavit as dn
        >>> chain = dn.load("robots/universal_robots/ur5e.urdf").chain()
        >>> robot = chain.fk(chain.sample(20, seed=1))
        >>> camera = chain.fk([1, -1, 1, 0, 0, 0])
        >>> found = dn.hand_eye(robot, np.linalg.inv(camera) @ robot)
        >>> bool(np.allclose(found.instrument, camera)), found.unknown
        (True, None)
    """
    pairs = [_denavit.pose_matrices("robot", robot), _denavit.pose_matrices("seen", seen)]
    if pairs[0].ndim != 3 or pairs[0].shape != pairs[1].shape:
        shapes = " and ".join(str(matrices.shape) for matrices in pairs)
        raise ArgumentError(f"robot and seen have shapes {shapes}; give both the same number of poses, shape (N, 4, 4)")
    text, answer = _denavit.hand_eye(pairs[0].reshape(-1, 16), pairs[1].reshape(-1, 16), on_hand)
    report = json.loads(answer)
    base, tip = (
        next(value for name, value in report.items() if name.startswith(prefix)) for prefix in ("base_from_", "tip_from_")
    )
    unknown = report["unknown"]
    return HandEye(
        on_hand=on_hand,
        base=np.array(base["matrix"]),
        tip=np.array(tip["matrix"]),
        base_std=np.array(base["std"]),
        tip_std=np.array(tip["std"]),
        rejected=np.array([row["rejected"] for row in report["residuals"]], dtype=np.bool_),
        unknown=None if unknown is None else unknown["message"],
        _json=report,
        _text=text,
    )
