"""Hidden effects like those of real machines, harder than the simple ones of `effects.py`, under the same names.

Each function draws a place and a shape and returns a Hidden, as there. `kind` and `places` are the truth: a base that is
softer in one direction is still a compliant base.
"""

import numpy as np

from effects import Hidden, _loaded, _overturning, _pick, _turn


def softer_base(rng, arm):
    """A base on a frame: much softer about one horizontal line than about the other, and coupled."""
    line = rng.uniform(0, np.pi)
    stiff = rng.uniform(0.05, 0.3)
    soft = np.array([np.cos(line), np.sin(line), 0.0])
    firm = np.array([-np.sin(line), np.cos(line), 0.0])
    leaning = 0.3 * rng.normal()
    give_way = np.outer(soft, soft) + stiff * np.outer(firm, firm) + leaning * stiff * (np.outer(soft, firm) + np.outer(firm, soft))
    def act(size):
        def on(body, moment, give):
            give.base = _turn(3e-6 * size * (give_way @ _overturning(moment))) * give.base
        return on
    return Hidden("base_compliance", ["base"], act, {"softer about": line, "stiff": stiff})


def hardening(rng, arm):
    """A gear that stiffens with its load, like harmonic drives (three straight pieces in makers' data; a root here)."""
    i, largest = _loaded(rng, arm)
    bend = rng.uniform(0.2, 0.6)
    def act(size):
        def on(body, moment, give):
            load = moment.gravity[i] / largest
            give.joint[i] -= 1e-4 * size * load / (bend + abs(load)) * (bend + 1)
        return on
    return Hidden("joint_compliance", [arm.joints[i].name], act, {"hardening": bend})


def balancer(rng, arm):
    """A joint that is compliant under gravity's torque; a spring between its two links carries half of the torque."""
    i, largest = _loaded(rng, arm)
    share, rest = rng.uniform(0.3, 0.8), rng.uniform(-np.pi, np.pi)
    def act(size):
        def on(body, moment, give):
            spring = share * largest * np.sin(moment.q[i] + rest)
            give.joint[i] -= 1e-5 * size * (moment.gravity[i] + spring)
        return on
    return Hidden("joint_compliance", [arm.joints[i].name], act, {"balancer": share})


def _orders(rng, arm, orders):
    i = _pick(rng, arm)
    phases = rng.uniform(0, 2 * np.pi, len(orders))
    def act(size):
        def on(body, moment, give):
            waves = (np.sin(order * moment.q[i] + phase) for order, phase in zip(orders, phases))
            give.joint[i] += 1e-4 * size * sum(waves)
        return on
    return Hidden("transmission_error", [arm.joints[i].name], act, {"orders": [float(order) for order in orders]})


def high_order(rng, arm):
    """A gear with a non-integer order between 5 and 40."""
    return _orders(rng, arm, [round(rng.uniform(5.2, 39.8), 2)])


def two_orders(rng, arm):
    """An eccentric wheel and one behind a gear stage with a non-integer ratio."""
    return _orders(rng, arm, [float(rng.choice([1, 2])), round(rng.uniform(2.3, 8.8), 2)])


def three_orders(rng, arm):
    """Three wheels of one gear."""
    return _orders(rng, arm, [float(rng.choice([1, 2])), round(rng.uniform(2.5, 8.0), 2), round(rng.uniform(9.0, 30.0), 2)])


def counted_from_ground(rng, arm):
    """A parallel linkage: the reading of the elbow is its angle relative to the ground, not to the upper arm."""
    # The two joints with horizontal, parallel axes.
    i = {"six_axis": 2, "rail_six_axis": 3}.get(arm.name, 3)
    j = i - 1 if arm.name != "seven_axis" else 1
    sign = float(rng.choice([-1, 1]))
    def act(_):
        def on(body, moment, give):
            give.joint[i] += sign * moment.q[j]
        return on
    return Hidden("joint_coupling", [arm.joints[i].name], act, {"driven_by": arm.joints[j].name, "whole": True})


def friction_play(rng, arm):
    """Play with the side decided by gravity if it exceeds friction, otherwise by the direction of approach."""
    i, largest = _loaded(rng, arm)
    friction = rng.uniform(0.2, 0.6) * largest
    def act(size):
        def on(body, moment, give):
            give.joint[i] -= 1e-4 * size * np.sign(moment.gravity[i] + friction * moment.approach[i])
        return on
    return Hidden("backlash", [arm.joints[i].name], act, {"friction": friction}, ("approach",))


def tiny_harmonics(rng, arm):
    """Twenty negligible harmonics of any joint: the background of another effect."""
    turning = [i for i, joint in enumerate(arm.joints) if joint.kind == "revolute"]
    waves = [(int(rng.choice(turning)), float(rng.uniform(1, 20)), rng.uniform(0, 2 * np.pi), rng.normal()) for _ in range(20)]
    def act(size):
        def on(body, moment, give):
            for i, order, phase, height in waves:
                give.joint[i] += 2e-5 * size * height * np.sin(order * moment.q[i] + phase)
        return on
    listed = [{"place": arm.joints[i].name, "order": order} for i, order, _, _ in waves]
    return Hidden("ground", [arm.joints[i].name for i in turning], act, {"waves": listed})


HARDER = {maker.__name__: maker for maker in (
    softer_base, hardening, balancer, high_order, two_orders, three_orders, counted_from_ground, friction_play, tiny_harmonics)}
