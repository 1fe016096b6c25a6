#!/usr/bin/env python3
"""Inverse kinematics compared with EAIK and ssik: solutions and time per pose of 20 arms, with the same poses. Prints a table.

    cargo build --release -p denavit-ik --example peers
    python3 tests/oracle/ik_peers.py [--poses 10000] [--peer-poses 1000] [--target RELEASE_FOLDER] [ARM…]

Arms: makers' URDF, three factory-calibrated arms of Universal Robots (../shared/vendor), random axes. A solution counts if it
reaches the pose within 1e-6 (rad, fraction of the size); columns of solutions are means per pose. `lost` counts postures that are not
among the solutions of their own pose, `we miss` a peer's solutions that are not among ours, `it misses` the reverse. Times: one thread,
per pose, all branches, the fastest of alternating passes: ours in a loop in Rust; `chain.ik` of our Python package; EAIK's batch call,
which makes a Python object per pose; ssik's Python call, once. `one`: one pose per call (ssik has no batch). `none`: the peer has no
method for the arm, or no answer within the processor time; standard error says which.
Packages: numpy, pin, EAIK, ssik, denavit (a release build of python/).
"""

import argparse
import contextlib
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

TOP = Path(__file__).resolve().parents[2]
SHARED = TOP.parent / "shared/vendor"
REACHED = 1e-6
SAME = 1e-4
# Alternating passes over the poses; the fastest counts, because other programs and the processor's clock slow down the others.
TURNS = 15
# Passes in Rust in one run, besides the one whose solutions are compared.
MORE = 10
# A call that takes longer than this (s) runs once: arms of the general class.
LONG = 2.0
# Poses that are solved with one call each.
ONES = 1000
# Processor time of a peer on one arm, s.
PATIENCE = 20
IDEAL = {
    "ur10": ([0.1273, 0, 0, 0.163941, 0.1157, 0.0922], [0, -0.612, -0.5723, 0, 0, 0]),
    "ur10e": ([0.1807, 0, 0, 0.17415, 0.11985, 0.11655], [0, -0.6127, -0.57155, 0, 0, 0]),
}
URDFS = """robots/universal_robots/ur5e.urdf robots/universal_robots/ur10.urdf robots/abb/irb120.urdf robots/unimation/puma560.urdf
robots/fanuc/lrmate200id_expanded.urdf robots/fanuc/m20ia_expanded.urdf robots/kuka/kr6r900sixx.urdf robots/kuka/kr16_2_expanded.urdf
robots/abb/irb2400_expanded.urdf robots/motoman/gp7.urdf robots/motoman/hc10.urdf robots/denso/vs060.urdf robots/doosan/m1013.urdf
robots/kinova/j2n6s300.urdf robots/kuka/lbr_iisy3_r760.urdf robots/ros-industrial/crx10ial.urdf robots/techman/tm5-900.urdf""".split()


def hat(w):
    return np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])


def turn(w, q):
    """Rotations about a unit vector, one for each angle."""
    w, q = hat(w), np.asarray(q)[:, None, None]
    return np.eye(3) + np.sin(q) * w + (1 - np.cos(q)) * (w @ w)


class Arm:
    """Axes (directions, points) and home of an arm, in its base frame at zero."""

    def __init__(self, directions, points, home):
        self.directions, self.home = np.asarray(directions, float), np.asarray(home, float)
        self.directions /= np.linalg.norm(self.directions, axis=1)[:, None]
        # The point of each axis nearest to the origin.
        self.points = np.array([p - w * (w @ p) for w, p in zip(self.directions, np.asarray(points, float), strict=True)])
        self.n = len(self.points)
        self.size = max(0.1, float(np.abs(self.points).max()), float(np.abs(self.home[:3, 3]).max()))

    def fk(self, q):
        rotation = np.broadcast_to(np.eye(3), (len(q), 3, 3))
        place = np.zeros((len(q), 3))
        for k in range(self.n):
            own = turn(self.directions[k], q[:, k])
            shift = self.points[k] - own @ self.points[k]
            place = place + np.einsum("nij,nj->ni", rotation, shift)
            rotation = rotation @ own
        place = place + rotation @ self.home[:3, 3]
        return rotation @ self.home[:3, :3], place

    def urdf(self):
        """The arm as a URDF from base to tip: at zero, the frames of all joints are parallel to the base's."""
        point = lambda v: " ".join(map(repr, map(float, v)))  # noqa: E731
        at, out = np.zeros(3), '<robot name="arm"><link name="base"/>'
        for k, (w, p) in enumerate(zip(self.directions, self.points, strict=True)):
            parent = "base" if k == 0 else f"link_{k}"
            out += f'<link name="link_{k + 1}"/><joint name="joint_{k + 1}" type="continuous"><parent link="{parent}"/><child link="link_{k + 1}"/><origin xyz="{point(p - at)}"/><axis xyz="{point(w)}"/></joint>'
            at = p
        r = self.home[:3, :3]
        rpy = np.arctan2(r[2, 1], r[2, 2]), np.arctan2(-r[2, 0], np.hypot(r[2, 1], r[2, 2])), np.arctan2(r[1, 0], r[0, 0])
        return out + f'<link name="tip"/><joint name="tool" type="fixed"><parent link="link_{self.n}"/><child link="tip"/><origin xyz="{point(self.home[:3, 3] - at)}" rpy="{point(rpy)}"/></joint></robot>'

    def text(self):
        axes = [" ".join(map(repr, [*map(float, w), *map(float, p)])) for w, p in zip(self.directions, self.points, strict=True)]
        return "\n".join([*axes, *(" ".join(repr(float(v)) for v in row) for row in self.home)]) + "\n"


def of_urdf(path):
    import pinocchio

    model = pinocchio.buildModelFromUrdf(str(path))
    data = model.createData()
    # The first six joints that turn, from the base: grippers come after them.
    q = pinocchio.neutral(model)
    pinocchio.computeJointJacobians(model, data, q)
    chain = []
    at = next((k for k in range(model.njoints - 1, 0, -1) if len(path_to(model, k)) == 6), None)
    if at is None:
        return None
    chain = path_to(model, at)
    columns = [data.J[:, model.joints[k].idx_v] for k in chain]
    if any(np.linalg.norm(column[3:]) < 0.5 for column in columns):
        return None
    return Arm([c[3:] for c in columns], [np.cross(c[3:], c[:3]) for c in columns], data.oMi[at].homogeneous)


def path_to(model, joint):
    path = []
    while joint > 0:
        path.insert(0, joint)
        joint = model.parents[joint]
    return path


def of_dh(theta, d, a, alpha):
    at, directions, points = np.eye(4), [], []
    for row in zip(theta, d, a, alpha, strict=True):
        directions.append(at[:3, 2])
        points.append(at[:3, 3])
        (ct, st), (ca, sa) = ((np.cos(x), np.sin(x)) for x in (row[0], row[3]))
        at = at @ np.array([[ct, -st * ca, st * sa, row[2] * ct], [st, ct * ca, -ct * sa, row[2] * st], [0, sa, ca, row[1]], [0, 0, 0, 1]])
    return Arm(directions, points, at)


def calibrated():
    rows = [line.split(",") for line in (SHARED / "ur_calibration/factory_deltas.csv").read_text().splitlines() if line and line[0] != "#"][1:]
    for name in sorted({row[0] for row in rows}):
        own = sorted((row for row in rows if row[0] == name), key=lambda row: int(row[2]))
        d, a = IDEAL[own[0][1]]
        deltas = np.array([[float(cell) for cell in row[3:]] for row in own])
        alpha = np.array([np.pi / 2, 0, 0, np.pi / 2, -np.pi / 2, 0])
        yield f"{own[0][1]}, calibrated ({name})", of_dh(deltas[:, 0], d + deltas[:, 1], a + deltas[:, 2], alpha + deltas[:, 3])


def random_arm(seed):
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(6, 3))
    home = np.eye(4)
    home[:3, 3] = rng.uniform(-0.5, 0.5, 3)
    return Arm(directions, rng.uniform(-0.5, 0.5, (6, 3)), home)


def arms():
    for name in URDFS:
        path = next((folder / name for folder in (TOP, SHARED) if (folder / name).is_file()), None)
        made = path and of_urdf(path)
        if made:
            yield path.stem.removesuffix("_expanded"), made
        else:
            print(f"left out, because it is not there or has no six turning joints in a row: {name}", file=sys.stderr)
    yield from calibrated()
    for seed in range(3):
        yield f"random axes ({seed})", random_arm(seed)


def eaik(arm, rotations, places):
    """Solutions (index, joints) and calls to be timed; None if EAIK has no decomposition for the arm."""
    from eaik.IK_HP import HPRobot

    # Offsets from axis to axis, and from the last to the tip, as EAIK expects them.
    points = np.vstack([np.zeros(3), arm.points, arm.home[:3, 3]])
    robot = HPRobot(arm.directions, np.diff(points, axis=0))
    if not robot.hasKnownDecomposition():
        return None
    targets = np.tile(np.eye(4), (len(places), 1, 1))
    # At zero, EAIK's tip has the orientation of the base.
    targets[:, :3, :3], targets[:, :3, 3] = rotations @ arm.home[:3, :3].T, places
    found = robot.IK_batched(targets, 1)
    pairs = [(at, q) for at, one in enumerate(found) for q in np.atleast_2d(one.Q) if q.size]
    calls = lambda: robot.IK_batched(targets, 1), one_by_one(robot.IK, targets)  # noqa: E731
    return np.array([at for at, _ in pairs], int), np.array([q for _, q in pairs]).reshape(-1, 6), calls


def one_by_one(solve, targets):
    """A call with one pose after another, of the first ones."""
    few = [np.ascontiguousarray(target) for target in targets[:ONES]]
    return lambda: [solve(target) for target in few]


def seconds(call):
    begun = time.perf_counter()
    call()
    return time.perf_counter() - begun


def in_turns(calls):
    """The smallest time of each call, s; the calls alternate, so that the load of the machine affects all equally."""
    least = [seconds(call) for call in calls]
    for _ in range(0 if max(least, default=0) > LONG else TURNS):
        least = [min(before, seconds(call)) for before, call in zip(least, calls, strict=True)]
    return least


def in_python(arm, rotations, places, folder):
    """Solutions (index, joints) of `chain.ik`, and calls to be timed: all poses at once and one by one."""
    import denavit

    (folder / "arm.urdf").write_text(arm.urdf())
    chain = denavit.load(str(folder / "arm.urdf")).chain("base", "tip")
    targets = np.tile(np.eye(4), (len(places), 1, 1))
    targets[:, :3, :3], targets[:, :3, 3] = rotations, places
    found = chain.ik(targets)
    there = np.isfinite(found.q[..., 0]) & found.reached[:, None]
    return np.nonzero(there)[0], found.q[there], (lambda: chain.ik(targets), one_by_one(chain.ik, targets))


def ours(arm, q, program, folder):
    (folder / "arm.txt").write_text(arm.text())
    q.astype("<f8").tofile(folder / "poses.bin")

    def run(times):
        words = [program, folder / "arm.txt", folder / "poses.bin", folder / "solutions.bin", str(times)]
        return subprocess.run(words, capture_output=True, text=True, check=True).stdout.strip()

    method = run(0)
    rows = np.fromfile(folder / "solutions.bin", "<f8").reshape(-1, arm.n + 1)
    # The difference of the two is the solver's time without start and files.
    return rows[:, 0].astype(int), rows[:, 1:], (lambda: run(0), lambda: run(MORE)), method


def ssik(arm, rotations, places, folder):
    """Solutions (index, joints) of ssik's Python solver, and its time."""
    import ssik

    (folder / "arm.urdf").write_text(arm.urdf())
    robot = ssik.Manipulator.from_urdf(str(folder / "arm.urdf"), base="base", ee="tip")
    targets = np.tile(np.eye(4), (len(places), 1, 1))
    targets[:, :3, :3], targets[:, :3, 3] = rotations, places
    robot.solve(targets[0])
    found: list[object] = []
    micros = seconds(lambda: found.extend(robot.solve(target) for target in targets)) / len(targets) * 1e6
    pairs = [(at, one.q) for at, all_ in enumerate(found) for one in all_]
    return np.array([at for at, _ in pairs], int), np.array([q for _, q in pairs], float).reshape(-1, 6), micros


def reaching(arm, index, q, rotations, places):
    """The solutions that reach their pose, without duplicates."""
    if len(index) == 0:
        return index, q
    rotation, place = arm.fk(q)
    good = (np.abs(rotation - rotations[index]).max(axis=(1, 2)) < REACHED) & (np.linalg.norm(place - places[index], axis=1) < REACHED * arm.size)
    index, q = index[good], q[good]
    by_pose, place_in = by_poses(index, q)
    same = apart(by_pose[:, :, None], by_pose[:, None]) < SAME
    again = np.tril(same, -1).any(axis=2)[index, place_in]
    return index[~again], q[~again]


def by_poses(index, q):
    """Solutions as (pose, number, joint), NaN where a pose has fewer; and the number of each solution."""
    count = np.bincount(index) if len(index) else np.zeros(1, int)
    number = np.arange(len(index)) - (np.cumsum(count) - count)[index]
    table = np.full((len(count), max(1, count.max()), q.shape[1]), np.nan)
    table[index, number] = q
    return table, number


def apart(a, b):
    return np.abs((a - b + np.pi) % (2 * np.pi) - np.pi).max(axis=-1)


def absent(index, q, among, of):
    """Which solutions (index, q) are not among the others (among, of), both sorted by pose."""
    table, _ = by_poses(among, of)
    here = index < len(table)
    result = np.ones(len(index), bool)
    result[here] = ~(apart(table[index[here]], q[here, None]) < SAME).any(axis=1)
    return result


@contextlib.contextmanager
def at_most(seconds):
    """Raises TimeoutError after this much processor time."""

    def stop(*_):
        raise TimeoutError(f"no answer within {seconds} s")

    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--poses", type=int, default=10_000)
    parser.add_argument("--peer-poses", type=int, default=1000, help="poses for ssik, which is slower")
    parser.add_argument("--target", type=Path, default=TOP / "target/release")
    parser.add_argument("arms", nargs="*", help="words that names of arms hold; all where none is given")
    options = parser.parse_args()
    program = options.target / "examples/peers"
    of_peer = "solutions | µs | one | we miss | it misses |"
    print(f"| arm | method | solutions | µs | lost | Python: {of_peer} EAIK: {of_peer} ssik: {of_peer}")
    print("|---" * 20 + "|")
    with tempfile.TemporaryDirectory() as made:
        for name, arm in arms():
            if options.arms and not any(word in name for word in options.arms):
                continue
            q = np.random.default_rng(7).uniform(-np.pi, np.pi, (options.poses, arm.n))
            rotations, places = arm.fk(q)
            index, solutions, calls, method = ours(arm, q, program, Path(made))
            index, solutions = reaching(arm, index, solutions, rotations, places)
            lost = absent(np.arange(len(q)), q, index, solutions)
            peers = [("denavit in Python", len(q), lambda n: in_python(arm, rotations[:n], places[:n], Path(made)))]
            peers += [("EAIK", len(q), lambda n: eaik(arm, rotations[:n], places[:n])), ("ssik", options.peer_poses, lambda n: ssik(arm, rotations[:n], places[:n], Path(made)))]
            answers = []
            for peer, count, solve in peers:
                try:
                    with at_most(PATIENCE):
                        answers.append((count, solve(count)))
                except Exception as problem:  # noqa: BLE001, a peer's failure is a result
                    print(f"{name}: {peer}: {str(problem)[:200]}", file=sys.stderr)
                    answers.append((count, None))
            calls = [*calls, *(call for _, found in answers[:2] if found for call in found[2])]
            start, rust, *rest = in_turns(calls)
            row = f"| {name} | {method} | {len(index) / len(q):.3f} | {(rust - start) / MORE / len(q) * 1e6:.2f} | {lost.sum()} |"
            for count, found in answers:
                if found is None:
                    row += " none | | | | |"
                    continue
                at, theirs = reaching(arm, found[0], found[1], rotations, places)
                own = index < count
                missed, they_miss = absent(at, theirs, index, solutions).sum(), absent(index[own], solutions[own], at, theirs).sum()
                if isinstance(found[2], float):
                    times = f"{found[2]:.1f} |"
                else:
                    batch, one, *rest = rest
                    times = f"{batch / count * 1e6:.1f} | {one / min(count, ONES) * 1e6:.1f}"
                row += f" {len(at) / count:.3f} | {times} | {missed} | {they_miss} |"
            print(row, flush=True)


if __name__ == "__main__":
    main()
