"""Zeros of joints compared with plain least squares by scipy on the same simulated rows."""

import csv
import json
import subprocess

import numpy as np
import pytest
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import built
from kinematics import Tree

ROBOT = built.WORKSPACE / "robots/universal_robots/ur5e.urdf"
BASE, TIP = "base", "tool0"
JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
# Zeros that instrument and target absorb are 0, so that both fits estimate the same numbers.
ZEROS = np.array([0.0, -0.08, 0.105, -0.03, 0.06, 0.0])
NOISE = 3e-4


def tips(tree, rows):
    return np.array([tree.pose(BASE, TIP, dict(zip(JOINTS, row))) for row in rows])


def seen(tree, readings, zeros, instrument, target):
    poses = tips(tree, readings + zeros)
    points = poses[:, :3, :3] @ target + poses[:, :3, 3]
    return Rotation.from_rotvec(instrument[:3]).apply(points) + instrument[3:]


@pytest.mark.parametrize("seed", [1, 2])
def test_zeros_are_those_of_a_plain_least_squares(tmp_path, seed):
    rng = np.random.default_rng(seed)
    tree = Tree(ROBOT)
    readings = rng.uniform(-2, 2, size=(25, 6))
    instrument, target = np.array([0.1, 0.2, 0.4, 2.0, -1.0, 0.3]), np.array([0.05, 0.02, 0.1])
    measured = seen(tree, readings, ZEROS, instrument, target) + NOISE * rng.normal(size=(25, 3))
    file = tmp_path / "rows.csv"
    with file.open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow([*JOINTS, "x", "y", "z"])
        table.writerows([map(repr, map(float, row)) for row in np.hstack([readings, measured])])

    def residual(numbers):
        zeros = np.r_[0, numbers[:4], 0]
        return (seen(tree, readings, zeros, numbers[4:10], numbers[10:]) - measured).ravel()

    plain = least_squares(residual, np.r_[np.zeros(4), instrument, target], method="lm", x_scale="jac")
    spread = np.sqrt(np.diag(np.linalg.inv(plain.jac.T @ plain.jac)) * 2 * plain.cost / (75 - 13))

    offsets, urdf = tmp_path / "offsets.csv", tmp_path / "zeroed.urdf"
    words = ["--base", BASE, "--tip", TIP, "--data", str(file), "--zeros", ",".join(JOINTS[1:5]), "--json", "-"]
    words += ["--offsets-out", "csv", str(offsets), "--urdf", str(urdf)]
    run = subprocess.run([built.denavit(), "calibrate", str(ROBOT), *words], capture_output=True, text=True, check=True)
    found = {entry["joint"]: entry for entry in json.loads(run.stdout)["parameters"]}
    for index, joint in enumerate(JOINTS[1:5]):
        assert found[joint]["parameter"] == f"{joint}.zero"
        # Only the prior of 0.1 rad differs.
        assert abs(found[joint]["change"] - plain.x[index]) < 0.05 * spread[index]
        assert found[joint]["std"] == pytest.approx(spread[index], rel=0.02)
    rows = list(csv.DictReader(offsets.open()))
    assert [row["joint"] for row in rows] == JOINTS[1:5]
    assert all(float(row["zero"]) == found[row["joint"]]["change"] for row in rows)

    # The written URDF has the pose of the drawn one with the zeros added.
    zeros = np.r_[0, [found[joint]["change"] for joint in JOINTS[1:5]], 0]
    written = tips(Tree(urdf), readings)
    assert np.abs(written - tips(tree, readings + zeros)).max() < 1e-11
