"""Hand-eye calibration compared with OpenCV's methods on the same simulated rows."""

import json
import subprocess

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import built

HAND_EYE = {
    "Tsai": cv2.CALIB_HAND_EYE_TSAI,
    "Park": cv2.CALIB_HAND_EYE_PARK,
    "Horaud": cv2.CALIB_HAND_EYE_HORAUD,
    "Andreff": cv2.CALIB_HAND_EYE_ANDREFF,
    "Daniilidis": cv2.CALIB_HAND_EYE_DANIILIDIS,
}
ROBOT_WORLD = {"Shah": cv2.CALIB_ROBOT_WORLD_HAND_EYE_SHAH, "Li": cv2.CALIB_ROBOT_WORLD_HAND_EYE_LI}
RUNS = 25


def pose(rotation, place):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation.as_matrix(), place
    return matrix


def simulated(seed, on_hand, rows=25):
    rng = np.random.default_rng(seed)
    base = pose(Rotation.from_rotvec(rng.normal(size=3)), rng.normal(size=3))
    tip = pose(Rotation.from_rotvec(rng.normal(size=3)), 0.1 * rng.normal(size=3))
    robot = [pose(Rotation.from_rotvec(0.6 * rng.normal(size=3)), 0.3 * rng.normal(size=3)) for _ in range(rows)]
    seen = []
    for here in robot:
        exact = np.linalg.inv(here @ tip) @ base if on_hand else np.linalg.inv(base) @ here @ tip
        noise = pose(Rotation.from_rotvec(2e-3 * rng.normal(size=3)), np.zeros(3))
        noisy = exact @ noise
        noisy[:3, 3] += 0.5e-3 * rng.normal(size=3)
        seen.append(noisy)
    return base, tip, robot, seen


def written(path, robot, seen):
    lines = ["robot_x,robot_y,robot_z,robot_rx,robot_ry,robot_rz,x,y,z,rx,ry,rz"]
    for pair in zip(robot, seen):
        cells = [np.r_[m[:3, 3], Rotation.from_matrix(m[:3, :3]).as_rotvec()] for m in pair]
        lines.append(",".join(repr(float(number)) for number in np.concatenate(cells)))
    path.write_text("\n".join(lines) + "\n")


def parts(matrices):
    return [m[:3, :3] for m in matrices], [m[:3, 3] for m in matrices]


def peers(robot, seen, on_hand):
    """tip_from_instrument if it is on the hand, else base_from_instrument, by each of OpenCV's methods."""
    moved = robot if on_hand else [np.linalg.inv(m) for m in robot]
    for name, method in HAND_EYE.items():
        rotation, place = cv2.calibrateHandEye(*parts(moved), *parts(seen), method=method)
        yield name, rotation, place.ravel()
    # world2cam is the observation, base2gripper the inverse of the input of calibrateHandEye.
    inverse = [np.linalg.inv(m) for m in moved]
    for name, method in ROBOT_WORLD.items():
        _, _, rotation, place = cv2.calibrateRobotWorldHandEye(*parts(seen), *parts(inverse), method=method)
        # gripper2cam.
        yield name, rotation.T, -rotation.T @ place.ravel()


@pytest.mark.parametrize("on_hand", [False, True])
def test_its_error_is_below_that_of_every_method_of_opencv(tmp_path, on_hand):
    ours, theirs = [], {}
    for seed in range(RUNS):
        base, tip, robot, seen = simulated(seed, on_hand)
        file = tmp_path / "pairs.csv"
        written(file, robot, seen)
        arguments = [built.denavit(), "hand-eye", "--data", file, "--json"] + (["--on-hand"] if on_hand else [])
        found = json.loads(subprocess.run(arguments, check=True, capture_output=True, text=True).stdout)
        truth, name = (tip, "tip_from_instrument") if on_hand else (base, "base_from_instrument")
        ours.append(np.linalg.norm(np.array(found[name]["matrix"])[:3, 3] - truth[:3, 3]))
        for method, _, place in peers(robot, seen, on_hand):
            theirs.setdefault(method, []).append(np.linalg.norm(place - truth[:3, 3]))
    rms = lambda errors: float(np.sqrt(np.mean(np.square(errors))))
    print(f"\non hand: {on_hand}; rms of the place, mm: denavit {1e3 * rms(ours):.4f}")
    for method, errors in theirs.items():
        print(f"  {method:<12} {1e3 * rms(errors):.4f}")
    assert all(rms(ours) < 1.02 * rms(errors) for errors in theirs.values())
    assert np.median(ours) < 2e-3
