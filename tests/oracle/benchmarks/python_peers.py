"""Times the peers that are called from Python; one JSON line for each thing timed.

    python_peers.py NAME FILE TIP [--load]

A call from Python takes about as long as the kinematics of a compiled peer: "empty call" measures it. Users of roboticstoolbox,
yourdfpy and scipy, which run in Python, always pay it. `--load` times only the loading of FILE.
"""

import json
import os
import statistics
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np

SECONDS = 0.3


def median_ns(work, times=1):
    """Median time of `work`, which does its work `times` times, over about a third of a second."""
    start = time.perf_counter_ns()
    work()
    once = max(time.perf_counter_ns() - start, 1)
    found = []
    for _ in range(max(3, min(200, int(SECONDS * 1e9 / once)))):
        start = time.perf_counter_ns()
        work()
        found.append((time.perf_counter_ns() - start) / times)
    return statistics.median(found)


def report(robot, who, what, ns):
    print(json.dumps({"robot": robot, "who": who, "what": what, "ns": round(ns, 2)}), flush=True)


def configurations(coordinates, count=200):
    part = (np.arange(1, coordinates * count + 1) * 0.6180339887498949) % 1.0
    return (6.0 * part - 3.0).reshape(count, coordinates)


def each(work, rows):
    def run():
        for row in rows:
            work(row)

    return run


def pinocchio(robot, path, tip, load):
    import pinocchio as pin

    if load:
        return report(robot, "pinocchio (Python)", "load", median_ns(lambda: pin.buildModelFromUrdf(path)))
    full = pin.buildModelFromUrdf(path)
    used = set(full.supports[full.frames[full.getFrameId(tip)].parentJoint])
    locked = [joint for joint in range(1, full.njoints) if joint not in used]
    model = pin.buildReducedModel(full, locked, pin.neutral(full))
    data, frame = model.createData(), model.getFrameId(tip)
    rows = list(configurations(model.nq))
    report(robot, "empty call", "fk", median_ns(each(lambda q: None, rows), len(rows)))
    report(robot, "pinocchio (Python)", "fk", median_ns(each(lambda q: pin.framesForwardKinematics(model, data, q), rows), len(rows)))
    side = pin.LOCAL_WORLD_ALIGNED
    work = each(lambda q: pin.computeFrameJacobian(model, data, q, frame, side), rows)
    report(robot, "pinocchio (Python)", "jacobian", median_ns(work, len(rows)))


def yourdfpy(robot, path, tip, load):
    from yourdfpy import URDF

    def read():
        return URDF.load(path, build_scene_graph=not load, load_meshes=False, build_collision_scene_graph=False)

    if load:
        return report(robot, "yourdfpy", "load", median_ns(read))
    model = read()
    rows = list(configurations(len(model.actuated_joints), 20))

    def work(q):
        model.update_cfg(q)
        model.get_transform(tip)

    report(robot, "yourdfpy", "fk", median_ns(each(work, rows), len(rows)))


def toolbox(robot, path, tip, load):
    import roboticstoolbox as rtb

    path = os.path.abspath(path)  # it searches relative paths in its own data

    if load:
        return report(robot, "roboticstoolbox", "load", median_ns(lambda: rtb.ERobot.URDF(path)))
    model = rtb.ERobot.URDF(path)
    ets = model.ets(end=tip)
    rows = list(configurations(ets.n))
    report(robot, "roboticstoolbox", "fk", median_ns(each(ets.eval, rows), len(rows)))
    report(robot, "roboticstoolbox", "jacobian", median_ns(each(ets.jacob0, rows), len(rows)))
    many = configurations(ets.n, 1000)
    report(robot, "roboticstoolbox", "batch", median_ns(lambda: ets.eval(many), len(many)))


def scipy(robot, path, tip, load):
    """Batches with numpy and scipy: one Rotation object for each joint over all configurations."""
    if load:
        return
    from pathlib import Path

    sys.path.insert(0, str(Path(__file__).parent))
    from chain_of import lines
    from scipy.spatial.transform import Rotation

    axes = {"X": 0, "Y": 1, "Z": 2}
    steps = [(words[0], np.array(words[1:], float).reshape(3, 4)) for words in map(str.split, lines(path, tip))]
    many = configurations(len(steps) - 1, 1000)

    def work():
        turned, at = Rotation.identity(), np.zeros(3)
        for k, (kind, placement) in enumerate(steps):
            at = at + turned.apply(placement[:, 3])
            turned = turned * Rotation.from_matrix(placement[:, :3])
            if kind in axes:
                vectors = np.zeros((len(many), 3))
                vectors[:, axes[kind]] = many[:, k]
                turned = turned * Rotation.from_rotvec(vectors)
        return turned, at

    report(robot, "scipy", "batch", median_ns(work, len(many)))


def pybotics(robot, path, tip, load):
    """Reads no URDF: its own UR10 replaces the UR5e, which has the same joint arrangement."""
    if load or robot != "UR5e":
        return
    from pybotics.optimization import OptimizationHandler, optimize_accuracy
    from pybotics.predefined_models import ur10
    from pybotics.robot import Robot
    from scipy.optimize import least_squares

    model = Robot.from_parameters(ur10())
    rows = list(configurations(6))
    report(robot, "pybotics (UR10)", "fk", median_ns(each(model.fk, rows), len(rows)))
    report(robot, "pybotics (UR10)", "jacobian", median_ns(each(model.jacobian_world, rows), len(rows)))
    rng = np.random.default_rng(1)
    built = Robot.from_parameters(ur10())
    built.kinematic_chain.vector = built.kinematic_chain.vector + rng.normal(0, [1e-3, 1.0, 1e-3, 1.0] * 6)
    q = configurations(6, 100)
    positions = np.array([built.fk(row)[:3, 3] for row in q]) + rng.normal(0, 0.05, (len(q), 3))

    def identify():
        handler = OptimizationHandler(Robot.from_parameters(ur10()), kinematic_chain_mask=True)
        least_squares(optimize_accuracy, handler.generate_optimization_vector(), args=(handler, q, positions))

    report(robot, "pybotics and scipy, 100 positions identified", "calibration", median_ns(identify))


def mujoco(robot, path):
    """Parsing and compiling an MJCF without its mesh files: a tetrahedron replaces each."""
    from pathlib import Path

    sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "formats"))
    from mjcf import compiled

    report(robot, "MuJoCo, parsed and compiled", "mjcf", median_ns(lambda: compiled(path)))


PEERS = [pinocchio, yourdfpy, toolbox, scipy, pybotics]


def main(robot, path, tip, load=False):
    in_mjcf = path.endswith(".xml")
    for peer in [mujoco] if in_mjcf else PEERS:
        try:
            peer(robot, path) if in_mjcf else peer(robot, path, tip, bool(load))
        except Exception as error:  # noqa: BLE001 - a peer that does not run also gets a line in the table
            print(f"{robot}: {peer.__name__} skipped, because {type(error).__name__}: {error}", file=sys.stderr)


if __name__ == "__main__":
    main(*sys.argv[1:])
