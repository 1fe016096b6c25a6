"""The hidden effects, by their physics. Each function draws a place and a shape and returns a Hidden.

`act(size)` gives the function that acts on a row; size 1 is a first guess, and the generator scales it until the
displacement has the requested strength. `kind` and `places` are the truth for evaluating a tracer.
"""

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from body import Body


@dataclass
class Hidden:
    kind: str
    places: list
    act: object
    shape: dict
    needs: tuple = ()


def _pick(rng, arm, kinds=("revolute",), last=True):
    usable = [i for i, joint in enumerate(arm.joints) if joint.kind in kinds]
    if not last and len(usable) > 1:
        usable = usable[:-1]
    return int(rng.choice(usable))


def _across(axis):
    other = np.array([1.0, 0, 0]) if abs(axis[0]) < 0.9 else np.array([0, 1.0, 0])
    first = np.cross(axis, other)
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def _turn(vector):
    return pin.SE3(pin.exp3(vector), np.zeros(3))


def _move(vector):
    return pin.SE3(np.eye(3), vector)


def joint_scale(rng, arm):
    i = _pick(rng, arm, ("revolute", "prismatic"))
    def act(size):
        def on(body, moment, give):
            give.joint[i] += 1e-3 * size * moment.q[i]
        return on
    return Hidden("joint_scale", [arm.joints[i].name], act, {})


def helical_pitch(rng, arm):
    i = _pick(rng, arm)
    def act(size):
        def on(body, moment, give):
            give.after[i] = give.after[i] * _move(1e-4 * size * moment.q[i] * body.axes[i])
        return on
    return Hidden("helical_pitch", [arm.joints[i].name], act, {})


def transmission_error(rng, arm, motor=False):
    i = _pick(rng, arm)
    order = float(rng.choice([1.0, 2.0, 2.0, 3.0, 4.0, round(rng.uniform(1.6, 6.5), 2)]))
    ratio = None
    if motor:
        ratio = float(rng.choice([51, 81, 101, 121]))
        order = ratio * float(rng.choice([1, 2]))
    phase = rng.uniform(0, 2 * np.pi)
    def act(size):
        def on(body, moment, give):
            give.joint[i] += 1e-4 * size * np.sin(order * moment.q[i] + phase)
        return on
    return Hidden("transmission_error", [arm.joints[i].name], act, {"order": order, "gear_ratio": ratio})


def _loaded(rng, arm):
    """A joint under gravity load, and its largest torque, N m."""
    body = Body(arm)
    lower, upper = (np.array([joint.limits[k] for joint in arm.joints]) for k in (0, 1))
    torques = np.array([pin.computeGeneralizedGravity(body.model, body.data, rng.uniform(lower, upper)) for _ in range(200)])
    change = torques.std(axis=0)
    loaded = [i for i in range(len(arm.joints)) if change[i] > 0.02 * change.max() and change[i] > 1e-3]
    if not loaded:
        loaded = [2]  # a SCARA's quill: only the payload changes its load
    i = int(rng.choice(loaded))
    return i, float(np.abs(torques[:, i]).max())


def joint_compliance(rng, arm):
    i, _ = _loaded(rng, arm)
    def act(size):
        def on(body, moment, give):
            give.joint[i] -= 1e-5 * size * moment.gravity[i]
        return on
    return Hidden("joint_compliance", [arm.joints[i].name], act, {})


def backlash(rng, arm, side=None):
    i = _pick(rng, arm, ("revolute", "prismatic"))
    side = side or str(rng.choice(["approach", "row order", "gravity"]))
    if side == "gravity":
        # Gravity does not load joints with vertical axes.
        i = int(rng.choice([2, 3] if arm.name == "rail_six_axis" else [1, 2, 3])) if arm.name != "scara" else i
        if arm.name == "scara":
            side = "approach"
    def act(size):
        def on(body, moment, give):
            # Play: the output lags behind the reading on the side of approach, or rests on the lower flank.
            sign = -np.sign(moment.gravity[i]) if side == "gravity" else -moment.approach[i]
            give.joint[i] += 1e-4 * size * sign
        return on
    needs = {"approach": ("approach",), "row order": ("row order",), "gravity": ()}[side]
    return Hidden("backlash", [arm.joints[i].name], act, {"side": side}, needs)


def joint_coupling(rng, arm):
    n = len(arm.joints)
    i = _pick(rng, arm)
    j = i + 1 if i == 0 else (i - 1 if i == n - 1 else int(rng.choice([i - 1, i + 1])))
    def act(size):
        def on(body, moment, give):
            give.joint[i] += 1e-3 * size * moment.q[j]
        return on
    return Hidden("joint_coupling", [arm.joints[i].name], act, {"driven_by": arm.joints[j].name})


def axis_wobble(rng, arm):
    if arm.joints[0].kind == "prismatic" and rng.random() < 0.5:
        i = 0
        lower, upper = arm.joints[0].limits
        waves = float(rng.uniform(0.5, 2.0))
        phase = rng.uniform(0, 2 * np.pi)
        weights = rng.normal(size=2)
        bow = rng.random() < 0.5
        def act(size):
            def on(body, moment, give):
                # Rail straightness: it turns about the two directions across its travel, or bends sideways.
                first, second = _across(body.axes[0])
                wave = np.sin(2 * np.pi * waves * (moment.q[0] - lower) / (upper - lower) + phase)
                across = wave * (weights[0] * first + weights[1] * second)
                give.before[0] = give.before[0] * (_move(1e-4 * size * across) if bow else _turn(1e-4 * size * across))
            return on
        return Hidden("axis_wobble", [arm.joints[0].name], act, {"waves": waves, "bow": bool(bow)})
    i = _pick(rng, arm, last=False)
    order = float(rng.choice([1.0, 2.0, 3.0]))
    phase, direction = rng.uniform(0, 2 * np.pi, 2)
    def act(size):
        def on(body, moment, give):
            first, second = _across(body.axes[i])
            tilt = np.cos(direction) * first + np.sin(direction) * second
            give.before[i] = give.before[i] * _turn(1e-4 * size * np.sin(order * moment.q[i] + phase) * tilt)
        return on
    return Hidden("axis_wobble", [arm.joints[i].name], act, {"order": order})


def local_joint_error(rng, arm):
    i = _pick(rng, arm)
    lower, upper = arm.joints[i].limits
    place = rng.uniform(lower + 0.2 * (upper - lower), upper - 0.2 * (upper - lower))
    width = rng.uniform(0.1, 0.35)
    round_top = rng.random() < 0.5
    def act(size):
        def on(body, moment, give):
            u = (moment.q[i] - place) / width
            bump = np.exp(-0.5 * u * u) if round_top else max(0.0, 1 - abs(u) / 2)
            give.joint[i] += 3e-4 * size * bump
        return on
    return Hidden("local_joint_error", [arm.joints[i].name], act, {"at": place, "width": width})


def link_compliance(rng, arm):
    """Link i bends like a round cantilever from axis i to axis i+1, or joint i's bearing tilts; torsion like that of a tube."""
    n = len(arm.joints)
    if arm.name == "scara":
        i = int(rng.choice([0, 1]))
    else:
        heavy = [k for k in range(n - 2) if arm.joints[k].kind == "revolute"]
        i = int(rng.choice(heavy[:4]))
    bearing = rng.random() < 0.5
    def act(size):
        def on(body, moment, give):
            if bearing:
                _, torque = moment.carried[i]
                axis = body.axes[i]
                # pinocchio gives the moment that supports the body: the load is its opposite.
                load = -(torque - axis * (axis @ torque))
                give.after[i] = _turn(1e-5 * size * load) * give.after[i]
                return
            # End load of link i in its own frame: the load on joint i+1.
            link_from_next = moment.placements[i].actInv(moment.placements[i + 1])
            force, torque = moment.carried[i + 1]
            force, torque = -(link_from_next.rotation @ force), -(link_from_next.rotation @ torque)
            reach = body.origins[i + 2].translation  # origins[0] is the universe
            length = np.linalg.norm(reach)
            along = reach / length
            bend = torque - along * (along @ torque)
            twist = along * (along @ torque)
            flexibility = 1e-5 * size / 0.3
            angle = flexibility * (length * (bend + 1.3 * twist) + 0.5 * length * np.cross(reach, force))
            across = force - along * (along @ force)
            shift = flexibility * (length**3 / 3 * across + 0.5 * length * np.cross(bend, reach))
            give.after[i] = give.after[i] * pin.SE3(np.eye(3), reach) * pin.SE3(pin.exp3(angle), shift) \
                * pin.SE3(np.eye(3), -reach)
        return on
    return Hidden("link_compliance", [arm.joints[i].name], act, {"bearing": bool(bearing)})


def _overturning(moment):
    """The horizontal part of the load's moment on the base about its origin, N m."""
    first = moment.placements[0]
    force, torque = moment.carried[0]
    force, torque = first.rotation @ force, first.rotation @ torque
    overturning = -(torque + np.cross(first.translation, force))
    overturning[2] = 0.0
    return overturning


def base_compliance(rng, arm):
    def act(size):
        def on(body, moment, give):
            give.base = _turn(3e-6 * size * _overturning(moment)) * give.base
        return on
    return Hidden("base_compliance", ["base"], act, {})


def thermal(rng, arm, where=None):
    where = where or str(rng.choice(["joint", "links", "base"]))
    i = _pick(rng, arm)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    turning = rng.normal(size=3) / 2
    def act(size):
        def on(body, moment, give):
            warm = moment.temperature - 20.0
            if where == "joint":
                give.joint[i] += 1e-5 * size * warm
            elif where == "links":
                give.lengths += 1e-5 * size * warm
            else:
                give.base = pin.SE3(pin.exp3(1e-5 * size * warm * turning), 1e-5 * size * warm * direction) * give.base
        return on
    place = {"joint": arm.joints[i].name, "links": "links", "base": "base"}[where]
    return Hidden("thermal", [place], act, {"where": where}, ("temperature",))


def drift(rng, arm, shape=None, where=None):
    shape = shape or str(rng.choice(["linear", "exponential", "steps"]))
    where = where or str(rng.choice(["base", "target", "joint"]))
    i = _pick(rng, arm)
    steps = np.sort(rng.uniform(0.12, 0.88, int(rng.integers(1, 4))))
    heights = [(rng.normal(size=3), rng.normal(size=3) / 2) for _ in steps]
    direction, turning = rng.normal(size=3), rng.normal(size=3) / 2
    def course(moment, span):
        s = moment.time / span
        if shape == "linear":
            return s * direction, s * turning
        if shape == "exponential":
            s = 1 - np.exp(-s / 0.25)
            return s * direction, s * turning
        past = [h for at, h in zip(steps, heights) if s >= at]
        return sum((h[0] for h in past), np.zeros(3)), sum((h[1] for h in past), np.zeros(3))
    def act(size):
        def on(body, moment, give):
            move, turn = course(moment, body.span)
            if where == "base":
                give.base = pin.SE3(pin.exp3(1e-4 * size * turn), 1e-4 * size * move) * give.base
            elif where == "target":
                give.target = give.target + 1e-4 * size * move
            else:
                give.joint[i] += 1e-4 * size * move[0]
        return on
    place = {"joint": arm.joints[i].name, "base": "base", "target": "target"}[where]
    return Hidden("drift", [place], act, {"shape": shape, "where": where, "steps": [float(s) for s in steps]}, ("time",))


def latency(rng, arm):
    def act(size):
        def on(body, moment, give):
            give.joint += 1e-3 * size * moment.velocity
        return on
    return Hidden("latency", ["all"], act, {}, ("velocity",))


def instrument_scale(rng, arm):
    def act(size):
        def on(body, moment, give):
            give.scale += 1e-4 * size
        return on
    return Hidden("instrument_scale", ["instrument"], act, {})


KINDS = {maker.__name__: maker for maker in (
    joint_scale, helical_pitch, transmission_error, joint_compliance, backlash, joint_coupling, axis_wobble,
    local_joint_error, link_compliance, base_compliance, thermal, drift, latency, instrument_scale)}


def two_joint_term(rng, arm):
    """Alien: joint i's error is a product of two other joints' waves."""
    n = len(arm.joints)
    i = _pick(rng, arm)
    others = [k for k in range(n) if arm.joints[k].kind == "revolute"]
    j, k = (int(x) for x in rng.choice(others, 2, replace=False))
    def act(size):
        def on(body, moment, give):
            give.joint[i] += 2e-4 * size * np.sin(moment.q[j] + 0.3) * np.sin(1.5 * moment.q[k])
        return on
    return Hidden("alien", [arm.joints[x].name for x in (i, j, k)], act, {"what": "term in two joints"})


def joint_step(rng, arm):
    """Alien: a joint slips by one tooth at some row; there is no time column."""
    i = _pick(rng, arm)
    at = rng.uniform(0.25, 0.75)
    def act(size):
        def on(body, moment, give):
            if moment.time / body.span >= at:
                give.joint[i] += 1e-4 * size
        return on
    return Hidden("alien", [arm.joints[i].name, "run order", "time"], act, {"what": "joint step", "at": at})


def cable_drag(rng, arm):
    """Alien: a cable from a hook beside the arm pulls at the tip, stiffer when stretched; compliant joints yield."""
    hook = np.array([rng.uniform(-0.5, 0.5), rng.uniform(-0.5, 0.5), 1.2])
    slack = 0.5
    def act(size):
        def on(body, moment, give):
            rope = hook - moment.tip.translation
            drawn = np.linalg.norm(rope)
            pull = rope / drawn * max(0.0, drawn - slack) ** 2 * 50
            for k in range(body.n):
                if body.revolute[k]:
                    placed = moment.placements[k]
                    axis = placed.rotation @ body.axes[k]
                    arm_ = moment.tip.translation - placed.translation
                    give.joint[k] += 2e-6 * size * float(axis @ np.cross(arm_, pull))
        return on
    return Hidden("alien", [joint.name for joint in arm.joints], act, {"what": "cable drag"})


ALIENS = {maker.__name__: maker for maker in (two_joint_term, joint_step, cable_drag)}
