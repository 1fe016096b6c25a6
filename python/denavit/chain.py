"""A chain of joints: forward kinematics, Jacobians, joint values, tables."""

from __future__ import annotations

import json
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from denavit import _denavit
from denavit.table import Table

if TYPE_CHECKING:
    from denavit.robot import Robot

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Coordinate:
    """One number that moves a chain: the value of a joint that is not a mimic.

    Attributes:
        name: The joint's name.
        quantity: ``angle`` (rad) or ``length`` (m).
        lower: Lowest value, rad or m; ``None`` where none is stated.
        upper: Highest value, rad or m.
        velocity: Highest speed, rad/s or m/s.
        effort: Highest torque or force, N·m or N.
        continuous: Turns without end.
    """

    name: str
    quantity: Literal["angle", "length"]
    lower: float | None = None
    upper: float | None = None
    velocity: float | None = None
    effort: float | None = None
    continuous: bool = False


class Chain:
    """A chain of joints from a base link to a tip link; made by `Robot.chain`.

    Joint values are arrays whose last axis has one value for each of the n coordinates (rad, m): shape ``(n,)`` for one
    configuration, ``(N, n)`` or more axes for many. Arrays of float64 that lie in order are not copied; the interpreter is
    unlocked while many configurations are computed.

    Examples:
        >>> import denavit as dn
        >>> chain = dn.load("robots/universal_robots/ur5e.urdf").chain("base", "tool0")
        >>> chain
        <denavit.Chain of 'ur5e': base → tool0, 6 coordinates>
        >>> Q = chain.sample(1000, seed=0)
        >>> Q.shape, chain.fk(Q).shape, chain.tips(Q).shape, chain.jacobian(Q).shape
        ((1000, 6), (1000, 4, 4), (1000, 3), (1000, 6, 6))
    """

    __slots__ = ("_native", "_robot")
    _native: _denavit.Chain
    _robot: Robot

    def __init__(self, *_: object) -> None:
        raise TypeError("a chain is one of a robot: use robot.chain(base, tip)")

    @classmethod
    def _of(cls, robot: Robot, native: _denavit.Chain) -> Chain:
        self = object.__new__(cls)
        object.__setattr__(self, "_native", native)
        object.__setattr__(self, "_robot", robot)
        return self

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"a Chain does not change; {name} cannot be set")

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._robot, self.base, self.tip, self.exact)

    def _key(self) -> tuple[Robot, str, str, bool]:
        return self._robot, self.base, self.tip, self.exact

    def __eq__(self, other: object) -> bool:
        return self._key() == other._key() if isinstance(other, Chain) else NotImplemented

    def __hash__(self) -> int:
        return hash(self._key())

    def __len__(self) -> int:
        return len(self._native.coordinates())

    def __repr__(self) -> str:
        return f"<denavit.Chain of {self.name!r}: {self.base} → {self.tip}, {len(self)} coordinates>"

    @property
    def robot(self) -> Robot:
        """The robot that it is a chain of."""
        return self._robot

    @property
    def name(self) -> str:
        """The robot's name."""
        return self._native.name

    @property
    def base(self) -> str:
        """Base link."""
        return self._native.base

    @property
    def tip(self) -> str:
        """Tip link."""
        return self._native.tip

    @property
    def exact(self) -> bool:
        """Whether every number was taken as it is written."""
        return self._native.exact

    @property
    def size(self) -> float:
        """The robot's size, m: the length along its axes, and the travel of its slides."""
        return self._native.size

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The numbers that move it, in order."""
        return tuple(Coordinate(*entry) for entry in self._native.coordinates())  # type: ignore[arg-type]

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the coordinates."""
        return tuple(entry[0] for entry in self._native.coordinates())

    @property
    def ranges(self) -> Array:
        """Lowest and highest value of each coordinate, rad or m, shape ``(n, 2)``.

        Where no limits are stated: [-π, π] rad, [-1, 1] m.
        """
        return self._native.ranges().reshape(-1, 2)

    @property
    def notes(self) -> tuple[str, ...]:
        """What was read otherwise than it is written."""
        return tuple(self._native.notes)

    @property
    def tip_moves_at_most(self) -> float:
        """The most by which what the notes describe moves the tip, m."""
        return self._native.tip_moves_at_most

    def screws(self) -> Array:
        """Screw axes in the base frame at zero, shape ``(joints, 6)``: ``[ω, v]``, as in Lynch and Park."""
        return np.array([joint["twist"] for joint in self.poe()["joints"]], dtype=np.float64).reshape(-1, 6)

    def home(self) -> Array:
        """base_from_tip with every joint value 0, shape ``(4, 4)``, m."""
        return np.array(self.poe()["home"], dtype=np.float64)

    def poe(self) -> dict[str, Any]:
        """Screw axes and home pose: the JSON of ``denavit poe --format json``."""
        found: dict[str, Any] = json.loads(self._native.poe("json"))
        return found

    def fk(self, q: ArrayLike, out: Array | None = None, *, threads: int = 1) -> Array:
        """Forward kinematics: base_from_tip.

        Args:
            q: Joint values, rad and m, shape ``(..., n)``.
            out: C-contiguous float64 array of shape ``(..., 4, 4)`` for the result.
            threads: Threads to share the work among; 0: as many as there are cores.

        Returns:
            Homogeneous matrices, m, shape ``(..., 4, 4)``.

        Raises:
            ArgumentError: The shapes do not go together, or `out` is no such array.

        Examples:
            >>> import denavit as dn
            >>> chain = dn.load("robots/universal_robots/ur5e.urdf").chain()
            >>> chain.fk([0, 0, 0, 0, 0, 0]).round(4)[:3, 3]
            array([-0.8172, -0.2329,  0.0628])
        """
        return self._native.fk(q, out, threads)

    def tips(self, q: ArrayLike, out: Array | None = None, *, threads: int = 1) -> Array:
        """Where the tip's origin is in the base frame, m, shape ``(..., 3)``; quicker than `fk`, and as exact."""
        return self._native.tips(q, out, threads)

    def jacobian(
        self,
        q: ArrayLike,
        frame: Literal["space", "body", "tip"] = "space",
        out: Array | None = None,
        *,
        threads: int = 1,
    ) -> Array:
        """Jacobians, angular rows first, per unit of each coordinate.

        Args:
            q: Joint values, rad and m, shape ``(..., n)``.
            frame: ``space``: the tip's twist in the base frame; ``body``: in its own frame (Lynch, Park 2017, ch. 5);
                ``tip``: its angular velocity and the velocity of its origin along the base frame's axes (geometric Jacobian).
            out: C-contiguous float64 array of shape ``(..., 6, n)`` for the result.
            threads: Threads to share the work among; 0: as many as there are cores.

        Returns:
            Shape ``(..., 6, n)``.
        """
        return self._native.jacobian(q, frame, out, threads)

    def sample(self, count: int, seed: int = 0) -> Array:
        """Random joint values within the limits, rad and m, shape ``(count, n)``; same seed, same values."""
        return self._native.sample(count, seed)

    def table(
        self,
        convention: Literal["distal", "standard", "proximal", "modified", "craig", "paper", "hayati"] | None = None,
        *,
        gauge: Literal["simple", "paper"] | None = None,
        tolerance: float = 1e-6,
    ) -> Table:
        """The chain's Denavit-Hartenberg table; `denavit table`.

        Args:
            convention: How the numbers are grouped; by default as the source does, else ``distal`` (standard).
            gauge: How to choose what the geometry leaves free; by default as the source does, else the fewest numbers.
            tolerance: Neighbouring axes closer to parallel than this are made parallel, rad; 0: none.
        """
        return Table._of(self, self._native.table(convention, gauge, tolerance), (convention, gauge, tolerance))

    def to_yourdfpy(self) -> Any:
        """The robot as `yourdfpy` reads it; of URDF sources only."""
        from denavit.bridges.robots import to_yourdfpy

        return to_yourdfpy(self._robot)

    def to_pinocchio(self) -> Any:
        """The robot as a model of `pinocchio`, with masses and inertias; of URDF sources only."""
        from denavit.bridges.robots import to_pinocchio

        return to_pinocchio(self._robot)

    def to_roboticstoolbox(self, convention: Literal["distal", "proximal"] = "distal") -> Any:
        """The chain as a `roboticstoolbox.DHRobot` of standard (distal) or modified (proximal) links."""
        from denavit.bridges.robots import to_roboticstoolbox

        return to_roboticstoolbox(self.table(convention))


def _again(robot: Robot, base: str, tip: str, exact: bool) -> Chain:
    return robot.chain(base, tip, exact=exact)
