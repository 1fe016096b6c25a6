#!/usr/bin/env python3
"""Zeros of joints alone: `denavit calibrate --zeros` beside scipy's plain least squares on the same rows. Prints a table.

    python3 tests/oracle/calibration/zeros_scipy.py DENAVIT [--rows 20] [--seeds 6]

Each seed measures poses of a UR5e (`denavit simulate`), after which each reading is off by a zero of some 20 mrad. Both fit zeros, the
instrument's frame and the target's; scipy by differences, from the drawing. The zeros of the first and the last joint are the
instrument's and the target's: the errors are those of the other four, root mean squares.
"""

import argparse
import csv
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pinocchio as pin
from scipy.optimize import least_squares

ROBOT = Path(__file__).resolve().parents[3] / "robots/universal_robots/ur5e.urdf"
TIP = "tool0"
NOISE = 5e-5
ZERO = 0.02


class Robot:
    def __init__(self):
        self.model = pin.buildModelFromUrdf(str(ROBOT))
        self.data, self.tip = self.model.createData(), self.model.getFrameId(TIP)
        self.names = list(self.model.names)[1:]

    def poses(self, q):
        for one in q:
            pin.forwardKinematics(self.model, self.data, one)
            yield pin.updateFramePlacement(self.model, self.data, self.tip).copy()


def shifted(source, target, names, zeros):
    """The rows of a file with these zeros taken off the readings."""
    with source.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    for row in rows:
        row.update({name: float(row[name]) - float(zero) for name, zero in zip(names, zeros, strict=True)})
    with target.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    number = [[float(row[name]) for name in (*names, "x", "y", "z", "qx", "qy", "qz", "qw")] for row in rows]
    return np.array(number)


def of_scipy(robot, table):
    """Zeros by least squares: those of the inner joints, the frame of the instrument and that of the target."""
    n = len(robot.names)
    seen = [pin.XYZQUATToSE3(row) for row in table[:, n:]]
    start = [seen[0] * next(robot.poses(table[:1, :n])).inverse(), pin.SE3.Identity()]

    def parts(x):
        return np.concatenate([[0.0], x[: n - 2], [0.0]]), start[0] * pin.exp6(x[n - 2 : n + 4]), start[1] * pin.exp6(x[n + 4 :])

    def residual(x):
        zeros, instrument, target = parts(x)
        pairs = zip(seen, robot.poses(table[:, :n] + zeros), strict=True)
        left = [(instrument * pose * target, one) for one, pose in pairs]
        each = [[*(one.translation - p.translation), *pin.log3(p.rotation.T @ one.rotation)] for p, one in left]
        return np.ravel(each) / NOISE

    return least_squares(residual, np.zeros(n + 10), x_scale="jac").x[: n - 2]


def compared(denavit, rows, seeds):
    """For each seed the errors of the inner zeros: those of denavit and of scipy, rad."""
    robot, found = Robot(), []
    for seed in seeds:
        zeros = np.random.default_rng(seed).normal(scale=ZERO, size=len(robot.names))
        with tempfile.TemporaryDirectory() as folder:
            drawn, run, fit = (Path(folder) / name for name in ("drawn.csv", "run.csv", "fit.json"))
            command = [denavit, "simulate", ROBOT, "--tip", TIP, "--measure", "poses", "--geometry-error", "0,0"]
            subprocess.run([*command, "--rows", str(rows), "--seed", str(seed), "-o", drawn], check=True)
            table = shifted(drawn, run, robot.names, zeros)
            command = [denavit, "calibrate", ROBOT, "--tip", TIP, "--data", run, "--zeros", f"--json={fit}"]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
            entries = json.loads(fit.read_text(encoding="utf-8"))["parameters"]
        ours = {entry["joint"]: entry["change"] for entry in entries if entry["parameter"].endswith(".zero")}
        inner = slice(1, -1)
        found.append([[ours[name] for name in robot.names[inner]] - zeros[inner], of_scipy(robot, table) - zeros[inner]])
    return np.array(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("denavit")
    parser.add_argument("--rows", type=int, default=20)
    parser.add_argument("--seeds", type=int, default=6)
    arguments = parser.parse_args()
    found = compared(arguments.denavit, arguments.rows, range(1, arguments.seeds + 1))
    print("| model | errors of zeros, mrad |\n|---|---:|")
    for name, errors in zip(("denavit", "scipy"), found.swapaxes(0, 1), strict=True):
        print(f"| {name} | {1e3 * np.sqrt(np.square(errors).mean()):.5f} |")


if __name__ == "__main__":
    main()
