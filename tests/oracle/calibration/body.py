"""A flexible arm at rest: pinocchio's gravity and forward kinematics, effects that move joints, frames and instrument.

An effect is a function of (Moment, Give) that adds to the Give; elastic effects read the gravity load of the last
iterate, and the state is iterated until it converges (static equilibrium).
"""

from dataclasses import dataclass, field

import numpy as np
import pinocchio as pin

from arms import to_urdf

STILL = 1e-12  # rad or m: tolerance of convergence, the change in one iterate


@dataclass
class Moment:
    """The conditions while one row is measured."""

    row: int
    q: np.ndarray
    velocity: np.ndarray
    approach: np.ndarray
    time: float
    temperature: float
    payload: float
    # from the iterate before: gravity's generalised force, and the force [N] and moment [N m] that each joint
    # carries, in the joint's frame
    gravity: np.ndarray = None
    carried: list = None
    tip: np.ndarray = None
    placements: list = None


@dataclass
class Give:
    """Changes by the effects in a row: joint values, frames before and after each joint, base, target, instrument."""

    joint: np.ndarray
    before: list
    after: list
    base: pin.SE3 = field(default_factory=pin.SE3.Identity)
    target: np.ndarray = field(default_factory=lambda: np.zeros(3))
    anchor: np.ndarray = field(default_factory=lambda: np.zeros(3))
    zero: float = 0.0
    scale: float = 0.0
    lengths: float = 0.0


class Body:
    """A pinocchio model of a flexible arm."""

    def __init__(self, arm):
        self.arm = arm
        self.model = pin.buildModelFromXML(to_urdf(arm))
        self.data = self.model.createData()
        self.n = self.model.nq
        self.origins = [self.model.jointPlacements[i].copy() for i in range(self.n + 1)]
        self.tip_id = self.model.getFrameId("tip")
        self.tip_origin = self.model.frames[self.tip_id].placement.copy()
        self.last_inertia = self.model.inertias[self.n].copy()
        self.axes = [np.array(joint.axis, float) for joint in arm.joints]
        self.revolute = [joint.kind == "revolute" for joint in arm.joints]

    def _rest(self, moment, give):
        """Places the arm with these changes, and stores loads and poses in `moment`."""
        model, data = self.model, self.data
        for i in range(1, self.n + 1):
            before = give.before[i - 1]
            origin = self.origins[i] if give.lengths == 0.0 else pin.SE3(
                self.origins[i].rotation, self.origins[i].translation * (1 + give.lengths))
            placed = origin * before
            if i > 1:
                placed = give.after[i - 2] * placed
            else:
                placed = give.base * placed
            model.jointPlacements[i] = placed
        tip = self.tip_origin if give.lengths == 0.0 else pin.SE3(
            self.tip_origin.rotation, self.tip_origin.translation * (1 + give.lengths))
        tip = give.after[self.n - 1] * tip
        if moment.payload > 0:
            model.inertias[self.n] = self.last_inertia + pin.Inertia(moment.payload, tip.translation, 1e-9 * np.eye(3))
        else:
            model.inertias[self.n] = self.last_inertia
        q = moment.q + give.joint
        moment.gravity = pin.rnea(model, data, q, np.zeros(self.n), np.zeros(self.n)).copy()
        moment.carried = [(data.f[i].linear.copy(), data.f[i].angular.copy()) for i in range(1, self.n + 1)]
        pin.forwardKinematics(model, data, q)
        moment.placements = [data.oMi[i].copy() for i in range(1, self.n + 1)]
        moment.tip = data.oMi[self.n] * tip

    def equilibrium(self, moment, effects):
        """Iterates effects and loads to convergence; returns the Give."""
        give = self.nothing()
        self._rest(moment, give)
        last = moment.tip.translation + 0
        for _ in range(60):
            give = self.nothing()
            for effect in effects:
                effect(self, moment, give)
            self._rest(moment, give)
            moved = np.abs(moment.tip.translation - last).max()
            last = moment.tip.translation + 0
            if moved < STILL:
                return give
        raise RuntimeError("the arm does not come to rest: an elastic effect is too soft")

    def nothing(self):
        identity = pin.SE3.Identity
        return Give(np.zeros(self.n), [identity() for _ in range(self.n)], [identity() for _ in range(self.n)])
