#!/usr/bin/env python3
"""Grips of a tool by two hands: `denavit calibrate` compared with scipy's plain least squares on the same rows. Prints a table.

    python3 tests/oracle/calibration/grips_scipy.py DENAVIT [--rows 40] [--seeds 6]

Each seed draws a robot near crates/calibrate/tests/two_arms.urdf, grips to fit and grips to test (`denavit simulate`).
Errors are those of the right hand's tool in the left hand's frame, root mean squares over the test grips, including their scatter.
Plain: four numbers for each axis and the tool, nothing else; with tolerances: priors of 1 mrad and 1 mm on these numbers.
Size: the median distance of neighbouring axes relative to the drawn one; grips measure no length.
"""

import argparse
import csv
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin
from poe_scipy import Model, expm, logs, rotations
from scipy.optimize import least_squares

TOP = Path(__file__).resolve().parents[3]
ROBOT = TOP / "crates/calibrate/tests/two_arms.urdf"
HANDS = ("left_hand", "right_hand")
SCATTER = 5e-5
TOLERANCE = 1e-3


class Arms:
    """Directions and points of all axes in the base frame at home, the joints on the way to each hand, and the hands at home."""

    def __init__(self, urdf):
        self.model = model = pin.buildModelFromUrdf(str(urdf))
        data, q = model.createData(), pin.neutral(model)
        pin.computeJointJacobians(model, data, q)
        pin.updateFramePlacements(model, data)
        columns = [pin.getJointJacobian(model, data, i, pin.WORLD)[:, i - 1] for i in range(1, model.njoints)]
        self.directions = np.array([column[3:] for column in columns])
        self.points = np.array([np.cross(column[3:], column[:3]) for column in columns])
        self.names = list(model.names)[1:]
        self.ways, self.homes = [], []
        for hand in HANDS:
            frame = model.frames[model.getFrameId(hand)]
            self.ways.append([i - 1 for i in model.supports[frame.parentJoint] if i > 0])
            self.homes.append(data.oMf[model.getFrameId(hand)].homogeneous)

    def hands(self, directions, points, q):
        for way, home in zip(self.ways, self.homes, strict=True):
            turn, place = np.broadcast_to(np.eye(3), (len(q), 3, 3)), np.zeros((len(q), 3))
            for i in way:
                r = rotations(directions[i], q[:, i])
                place = np.einsum("nij,nj->ni", turn, points[i] - r @ points[i]) + place
                turn = turn @ r
            yield turn @ home[:3, :3], turn @ home[:3, 3] + place

    def right_in_left(self, directions, points, q):
        (left, at), (right, there) = self.hands(directions, points, q)
        return left.transpose(0, 2, 1) @ right, np.einsum("nji,nj->ni", left, there - at)

    def size(self, directions, points):
        def apart(i, k):
            across, between = np.cross(directions[i], directions[k]), points[k] - points[i]
            if np.linalg.norm(across) < 0.1:
                return np.linalg.norm(between - directions[i] * (between @ directions[i]))
            return abs(between @ across) / np.linalg.norm(across)

        return np.array([apart(*pair) for way in self.ways for pair in zip(way, way[1:], strict=False)])


def differences(turns, places, grip):
    """The tool in the right hand relative to the tool in the left hand: (rows, 6). The tool's frame is the left hand's."""
    return np.concatenate([turns @ grip[:3, 3] + places, logs(turns @ grip[:3, :3])], axis=1)


def matrix(numbers, start):
    grip = np.eye(4)
    grip[:3, :3], grip[:3, 3] = start @ expm(numbers[:3]), numbers[3:]
    return grip


def held(turns, places):
    """The right hand's tool that equals the left hand's on average: its rotation, and the six numbers of `matrix` relative to it."""
    u, _, vt = np.linalg.svd(turns.sum(axis=0).T)
    place = -np.einsum("nji,nj->ni", turns, places).mean(axis=0)
    return u @ np.diag([1, 1, np.linalg.det(u @ vt)]) @ vt, np.concatenate([np.zeros(3), place])


def of_scipy(arms, q, tolerance):
    model = Model(list(zip(arms.directions, arms.points, strict=True)), np.eye(4))
    start, tool = held(*arms.right_in_left(arms.directions, arms.points, q))

    def axes(x):
        return [np.array(part) for part in zip(*model.axes(x), strict=True)]

    def residual(x):
        left = differences(*arms.right_in_left(*axes(x), q), matrix(x[-6:], start)).ravel() / SCATTER
        return left if tolerance is None else np.concatenate([left, x[:-6] / tolerance])

    return axes(least_squares(residual, np.concatenate([np.zeros(4 * model.n), tool]), method="trf", x_scale="jac").x)


def judged(arms, axes, train, test):
    """Root mean squares over `test`, mm and mrad; the tool is fitted to `train` with these axes."""
    turns, places = arms.right_in_left(*axes, train)
    start, tool = held(turns, places)
    found = least_squares(lambda x: differences(turns, places, matrix(x, start)).ravel(), tool)
    left = differences(*arms.right_in_left(*axes, test), matrix(found.x, start))
    return [1e3 * np.sqrt((part**2).sum(axis=1).mean()) for part in (left[:, :3], left[:, 3:])]


def readings(path, names):
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    return np.array([[float(row[name]) for name in names] for row in rows])


def compared(denavit, rows, seeds):
    """For each model the results of each seed: position, mm; orientation, mrad; size relative to the drawn one."""
    drawn = Arms(ROBOT)
    tips = [word for hand in HANDS for word in ("--tip", hand)]
    found = {}
    for seed in seeds:
        with tempfile.TemporaryDirectory() as folder:
            files = {name: Path(folder) / name for name in ("run.csv", "later.csv", "calibrated.urdf")}
            run = [denavit, "simulate", ROBOT, "--measure", "grips", *tips, "--rows", str(rows), "--seed", str(seed)]
            subprocess.run([*run, "-o", files["run.csv"], "--test", files["later.csv"]], check=True)
            run = [denavit, "calibrate", ROBOT, *tips, "--data", files["run.csv"], "--urdf", files["calibrated.urdf"]]
            subprocess.run(run, check=True, stdout=subprocess.DEVNULL)
            train, test = (readings(files[name], drawn.names) for name in ("run.csv", "later.csv"))
            ours = Arms(files["calibrated.urdf"])
        results = {
            "drawn": (drawn, (drawn.directions, drawn.points)),
            "denavit": (ours, (ours.directions, ours.points)),
            "scipy, plain": (drawn, of_scipy(drawn, train, None)),
            "scipy, with tolerances": (drawn, of_scipy(drawn, train, TOLERANCE)),
        }
        lengths = drawn.size(drawn.directions, drawn.points)
        for name, (arms, axes) in results.items():
            size = float(np.median((arms.size(*axes) / np.maximum(lengths, 1e-9))[lengths > 0.05]))
            found.setdefault(name, []).append([*judged(arms, axes, train, test), size])
    return {name: np.array(rows) for name, rows in found.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("denavit")
    parser.add_argument("--rows", type=int, default=40)
    parser.add_argument("--seeds", type=int, default=6)
    arguments = parser.parse_args()
    found = compared(arguments.denavit, arguments.rows, range(1, arguments.seeds + 1))
    print("| model | place, mm | orientation, mrad | size over drawn, least to largest |\n|---|---:|---:|---:|")
    for name, rows in found.items():
        place, turn = np.sqrt(np.square(rows[:, :2]).mean(axis=0))
        print(f"| {name} | {place:.4f} | {turn:.4f} | {rows[:, 2].min():.3f} to {rows[:, 2].max():.3f} |")


if __name__ == "__main__":
    main()
