"""A chain of joints: forward kinematics, Jacobians, joint values, tables."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from denavit import _denavit
from denavit._frozen import Frozen
from denavit._given import joint_values, whole
from denavit._shown import Shown
from denavit.errors import ArgumentError
from denavit.table import Table

if TYPE_CHECKING:
    from denavit.fit import Fit
    from denavit.robot import Robot
    from denavit.run import Plan, Simulation

Array = NDArray[np.float64]

JointValues = ArrayLike | Mapping[str, Any]
"""Joint values: an array whose last axis is the coordinates in order, or values by joint name (a mapping, a data frame)."""

_MOST_THREADS = 4096
_MOST_ROWS = 10**9
_BRANCHES = np.array(_denavit.branch_names(), dtype=np.object_)


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


@dataclass(frozen=True, slots=True)
class Solutions:
    """The result of `Chain.ik`: for each pose all branches, nearest to the start first, those outside the limits last.

    Attributes:
        q: Joint values, rad and m, shape ``(..., branches, n)``; NaN where a pose has fewer branches than another. A pose that
            is not reached has the nearest that was found.
        mask: Which of them reach their pose within the limits, shape ``(..., branches)``.
        reached: Which poses are reached, within the limits or not, shape ``(...,)``.
        method: How they were found.
    """

    q: Array
    mask: NDArray[np.bool_]
    reached: NDArray[np.bool_]
    method: str
    _codes: NDArray[np.int8] = field(repr=False)

    @property
    def names(self) -> NDArray[np.object_]:
        """Name of each branch, or ``None`` where the arm's class has no names; shape ``(..., branches)``."""
        return _BRANCHES[self._codes]

    @property
    def best(self) -> Array:
        """The first solution of each pose, shape ``(..., n)``."""
        return self.q[..., 0, :]

    def __len__(self) -> int:
        return len(self.q)


class Chain(Shown, Frozen):
    """A chain of joints from a base link to a tip link; made by `Robot.chain`.

    Joint values are arrays whose last axis has one value for each of the n coordinates (rad, m): shape ``(n,)`` for one
    configuration, ``(N, n)`` or more axes for many. C-contiguous float64 arrays are not copied; the interpreter is
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
    _made_by = "a chain belongs to a robot: use robot.chain(base, tip)"
    _native: _denavit.Chain
    _robot: Robot

    @classmethod
    def _of(cls, robot: Robot, native: _denavit.Chain) -> Chain:
        return cls._with(_native=native, _robot=robot)

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, self._key()

    def _key(self) -> tuple[Robot, str, str, bool]:
        return self._robot, self.base, self.tip, self.exact

    def __len__(self) -> int:
        return len(self._native.coordinates())

    def __repr__(self) -> str:
        return f"<denavit.Chain of {self.name!r}: {self.base} → {self.tip}, {len(self)} coordinates>"

    @property
    def robot(self) -> Robot:
        """The robot of this chain."""
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
        """Whether every number was read exactly as written."""
        return self._native.exact

    @property
    def size(self) -> float:
        """The robot's size, m: the length along its axes, and the travel of its slides."""
        return self._native.size

    @property
    def coordinates(self) -> tuple[Coordinate, ...]:
        """The coordinates that move it, in order."""
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
        """What was read differently from what is written."""
        return tuple(self._native.notes)

    @property
    def tip_moves_at_most(self) -> float:
        """The largest motion of the tip due to what the notes describe, m."""
        return self._native.tip_moves_at_most

    @property
    def n(self) -> int:
        """Number of coordinates."""
        return len(self)

    @property
    def limits(self) -> Array:
        """Lowest and highest value of each coordinate, rad or m, shape ``(n, 2)``; -inf and inf where none is stated."""
        ends = [
            (-np.inf if entry.lower is None else entry.lower, np.inf if entry.upper is None else entry.upper)
            for entry in self.coordinates
        ]
        return np.array(ends, dtype=np.float64).reshape(-1, 2)

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

    def fk(self, q: JointValues, out: Array | None = None, *, threads: int = 1) -> Array:
        """Forward kinematics: base_from_tip.

        Args:
            q: Joint values, rad and m, shape ``(..., n)``; a data frame or mapping by joint names.
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
        if type(q) is not np.ndarray:
            q = joint_values("q", q, self.joints)
        return self._native.fk(q, out, threads if threads == 1 else whole("threads", threads, 0, _MOST_THREADS))

    def ik(self, poses: ArrayLike, q0: JointValues | None = None) -> Solutions:
        """Inverse kinematics: every branch that reaches each pose; `denavit ik`.

        Args:
            poses: base_from_tip, m, shape ``(..., 4, 4)``.
            q0: Joint values near which the first solution is searched, rad and m; by default 0. Each next pose starts from the
                first solution of the previous one, so that a path keeps its branch.

        Raises:
            ArgumentError: The shapes do not go together, a number is not finite, or an upper left part is not a rotation.

        Examples:
            >>> import denavit as dn
            >>> chain = dn.load("robots/universal_robots/ur5e.urdf").chain()
            >>> found = chain.ik(chain.fk([0.3, -1.2, 1.4, -0.5, -1.3, 0.2]))
            >>> found.q.shape, bool(found.reached)
            ((8, 6), True)
        """
        values, codes, mask, reached, method = self._native.ik(poses, None if q0 is None else self._one(q0))
        return Solutions(values, mask, reached, method, codes)

    def _one(self, q0: JointValues) -> list[float]:
        """Joint values of one configuration, or what is wrong with them."""
        n = len(self.joints)
        values = np.asarray(joint_values("q0", q0, self.joints), dtype=np.float64)
        if values.shape != (n,):
            raise ArgumentError(f"q0 has shape {values.shape}; give one value for each of the {n} joints")
        if not np.isfinite(values).all():
            raise ArgumentError("q0 contains a number that is not finite")
        given: list[float] = values.tolist()
        return given

    def tips(self, q: JointValues, out: Array | None = None, *, threads: int = 1) -> Array:
        """Position of the tip's origin in the base frame, m, shape ``(..., 3)``; faster than `fk`, and as exact."""
        if type(q) is not np.ndarray:
            q = joint_values("q", q, self.joints)
        return self._native.tips(q, out, threads if threads == 1 else whole("threads", threads, 0, _MOST_THREADS))

    def jacobian(
        self,
        q: JointValues,
        frame: Literal["space", "world", "body", "local", "tip", "local_world_aligned"] = "space",
        out: Array | None = None,
        *,
        order: Literal["angular_first", "linear_first"] = "angular_first",
        threads: int = 1,
    ) -> Array:
        """Jacobians, per unit of each coordinate.

        Args:
            q: Joint values, rad and m, shape ``(..., n)``.
            frame: ``space`` (pinocchio's ``world``): the tip's twist in the base frame; ``body`` (``local``): in its own frame
                (Lynch, Park 2017, ch. 5); ``tip`` (``local_world_aligned``): its angular velocity and the velocity of its
                origin along the base frame's axes (geometric Jacobian). The world is the chain's base frame.
            out: C-contiguous float64 array of shape ``(..., 6, n)`` for the result.
            order: ``angular_first``: rows ω, then v, as in Lynch and Park; ``linear_first``: v, then ω, as in pinocchio and
                roboticstoolbox.
            threads: Threads to share the work among; 0: as many as there are cores.

        Returns:
            Shape ``(..., 6, n)``.
        """
        if type(q) is not np.ndarray:
            q = joint_values("q", q, self.joints)
        if order not in ("angular_first", "linear_first"):
            raise ArgumentError(f"order is {order!r}; write angular_first or linear_first")
        found = self._native.jacobian(q, frame, out, threads if threads == 1 else whole("threads", threads, 0, _MOST_THREADS))
        if order == "linear_first":
            found[...] = found[..., [3, 4, 5, 0, 1, 2], :]
        return found

    def sample(self, count: int, seed: int = 0) -> Array:
        """Random joint values within the limits, rad and m, shape ``(count, n)``; same seed, same values."""
        return self._native.sample(whole("count", count, 0, _MOST_ROWS), whole("seed", seed))

    def table(
        self,
        convention: str | None = None,
        *,
        gauge: Literal["simple", "paper"] | None = None,
        tolerance: float = 1e-6,
    ) -> Table:
        """The chain's Denavit-Hartenberg table; `denavit table`.

        Args:
            convention: How the numbers are grouped: ``distal`` (also ``standard``, ``sdh``, ``DH``), ``proximal``
                (``modified``, ``mdh``, ``craig``), ``paper`` or ``hayati``; by default as the source does, else ``distal``.
            gauge: Rule for choices that the geometry does not determine; by default as the source does, else the fewest numbers.
            tolerance: Neighbouring axes closer to parallel than this are made parallel, rad; 0: none.
        """
        return Table._of(self, self._native.table(convention, gauge, tolerance), (convention, gauge, tolerance))

    def plan(
        self,
        count: int,
        *,
        measure: Literal["positions", "poses", "distances"] = "positions",
        candidates: ArrayLike | None = None,
        spread: int = 1000,
        box: Sequence[float] = (),
        target: Sequence[float] = (0.1, 0.0, 0.1),
        anchor: Sequence[float] | None = None,
        prior: str | os.PathLike[str] | Fit | None = None,
        tell_apart: Fit | None = None,
        seed: int = 0,
    ) -> Plan:
        """Choose the poses to measure that make the robot best observable; `denavit plan`.

        With ``tell_apart`` it chooses those that distinguish the possible causes of a fit or, if there is only one,
        those that make its prediction most certain.

        Args:
            count: Poses to choose.
            measure: What will be measured.
            candidates: Joint values to choose from, rad and m, shape ``(N, n)``; by default spread over the joint limits.
            spread: How many to spread.
            box: Box in which the target must stay, base frame, m: ``x0, x1, y0, y1, z0, z1``.
            target: Where the target sits on the tip, m.
            anchor: Position of the anchor of a distance instrument, base frame, m; by default the arm's size away.
            prior: An earlier calibration of this robot, as a fit or as its JSON file: poses are chosen for what they add.
            tell_apart: A fit of this chain. The kind of measurement and the target are then those of its last row; measure the
                poses in their order, and append them to the rows of the fit.
            seed: Of the spread candidates and of the random poses that the plan is compared with.

        Raises:
            ArgumentError: Fewer candidates than poses are left within the limits and the box, or an argument is invalid.
        """
        from denavit.fit import earlier
        from denavit.run import plan
        from denavit.run import tell_apart as chosen_for

        if tell_apart is not None:
            if measure != "positions" or tuple(target) != (0.1, 0.0, 0.1) or anchor is not None or prior is not None:
                raise ArgumentError("tell_apart: leave out measure, target, anchor and prior; they come from the fit")
            if [c.name for c in tell_apart._chain.coordinates] != [c.name for c in self.coordinates]:
                raise ArgumentError("tell_apart: this is a fit of a chain with other joints")
            return chosen_for(tell_apart, count, candidates, spread, box, seed)

        return plan(self, count, measure, candidates, spread, box, target, anchor, earlier(prior), seed)

    def simulate(
        self,
        rows: int = 100,
        *,
        q: ArrayLike | Plan | None = None,
        test: int | None = None,
        measure: Literal["positions", "poses", "distances"] = "positions",
        targets: int = 1,
        seed: int = 0,
        geometry_error: tuple[float, float] = (1e-3, 1e-3),
        noise: tuple[float, float] = (5e-5, 5e-5),
        outliers: float = 0.0,
        effect: Sequence[str] = (),
        effects: Fit | None = None,
        columns: Sequence[str] = (),
        camera: str | os.PathLike[str] | None = None,
        board: str | None = None,
        on_hand: bool = False,
        pixel_noise: float = 0.2,
        range_noise: float = 0.0,
        angle_noise: float = 0.0,
        repeatability: float | Mapping[str, float] = 0.0,
    ) -> Simulation:
        """Make measurements of a robot that differs from its drawing, for trials and teaching; `denavit simulate`.

        Args:
            rows: Rows to measure, at random joint values within the limits.
            q: Joint values to measure at, rad and m, shape ``(N, n)``, or a plan, instead of random ones.
            test: Rows of the same robot, measured later, as test data.
            measure: What is measured.
            targets: Targets on the tip that a position measurement sees.
            seed: Same seed, same data.
            geometry_error: How far each axis is from its drawing, standard deviations: m and rad.
            noise: Of each measured component, standard deviations: m, and rad for poses.
            outliers: Fraction of rows with a gross error of 5 to 50 mm.
            effect: Effects by name, place and strength, such as ``joint_compliance@elbow_joint=0.1mm``.
            effects: A fit whose effects are also simulated.
            columns: What is recorded beside the measurements: ``time``, ``temperature``, ``payload``, …
            camera: A camera measures, at random joint values in which it sees its board: its file of intrinsics, YAML as
                ROS (``camera_info``) or OpenCV write it.
            board: The board that the camera sees: squares across and down, and the edge of a square, such as ``7x5:30mm``.
            on_hand: The camera sits on the hand and the board stands still, not the other way round.
            pixel_noise: Of each component of a pixel, standard deviation, px.
            range_noise: Along the instrument's line of sight beside `noise`, standard deviation, m.
            angle_noise: Of the direction in which the instrument sees the target beside `noise`, standard deviation, rad.
            repeatability: Repeatability of the joints, standard deviation, rad (m for slides): one number for
                all, or numbers by joint name.

        Examples:
            >>> import denavit as dn
            >>> chain = dn.load("robots/universal_robots/ur5e.urdf").chain()
            >>> run = chain.simulate(50, seed=1, test=20)
            >>> len(run.data), len(run.test)
            (50, 20)
        """
        from denavit.run import simulate

        chosen = (measure, targets, seed, geometry_error, noise, outliers, effect, effects, columns)
        seen = (camera, board, on_hand, pixel_noise)
        return simulate(self, rows, q, test, *chosen, *seen, (range_noise, angle_noise), repeatability)

    def to_jax(self) -> Any:
        """Forward kinematics as a function of jax: ``f(q)`` of shape ``(n,)`` gives base_from_tip, shape ``(4, 4)``, m.

        It can be compiled, mapped (`jax.vmap`) and differentiated both ways; its derivative is this chain's Jacobian. Numbers
        are those of jax: 32 bits unless ``jax_enable_x64`` is set.
        """
        from denavit.bridges.jax import to_jax

        return to_jax(self)

    def to_yourdfpy(self) -> Any:
        """The robot as `yourdfpy` reads it; of URDF sources only."""
        from denavit.bridges.robots import to_yourdfpy

        return to_yourdfpy(self._robot)

    def to_pinocchio(self) -> Any:
        """The robot as a model of `pinocchio`, with masses and inertias; of URDF sources only.

        Joints that mimic another follow it there, too.

        Raises:
            ExportError: The installed pinocchio cannot couple them so.
        """
        from denavit.bridges.robots import to_pinocchio

        return to_pinocchio(self._robot)

    def to_roboticstoolbox(self, convention: Literal["distal", "proximal"] = "distal") -> Any:
        """The chain as a `roboticstoolbox.DHRobot` of standard (distal) or modified (proximal) links."""
        from denavit.bridges.robots import to_roboticstoolbox

        return to_roboticstoolbox(self.table(convention))


def _again(robot: Robot, base: str, tip: str, exact: bool) -> Chain:
    return robot.chain(base, tip, exact=exact)
