"""Pixels compared with OpenCV: every distortion model, hand-eye, and the lines of docs/camera.md that detect a board."""

import csv
import json
import re
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest

import built
import kinematics

PANDA = built.WORKSPACE / "robots/franka/panda.urdf"
MATRIX = np.array([[610.5, 0, 322.25], [0, 606.75, 236.5], [0, 0, 1]])
LENSES = {
    "plumb_bob": ("plumb_bob", [0.11, -0.24, 1.1e-3, -7e-4, 0.06]),
    "rational": ("rational_polynomial", [0.4, -0.15, 1e-3, 4e-4, 0.02, 0.6, -0.05, 0.01]),
    "thin_prism": ("rational_polynomial", [0.1, -0.2, 1e-3, -5e-4, 0.05, 0.02, -0.01, 3e-3, 1e-3, -2e-3, 2e-3, 5e-4]),
    "equidistant": ("equidistant", [0.03, -0.02, 8e-3, -2e-3]),
}
# Inner corners of 7 by 5 squares of 30 mm.
CORNERS = np.array([[0.03 * (column + 1), 0.03 * (row + 1), 0] for row in range(4) for column in range(6)])


def denavit(*arguments):
    run = subprocess.run([built.denavit(), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def camera_file(folder, lens, writer="ros", finer=1):
    model, numbers = LENSES[lens]
    file = folder / "camera.yaml"
    if writer == "opencv":
        storage = cv2.FileStorage(str(file), cv2.FILE_STORAGE_WRITE)
        storage.write("image_width", 640)
        storage.write("image_height", 480)
        storage.write("camera_matrix", MATRIX)
        storage.write("distortion_coefficients", np.array(numbers).reshape(-1, 1))
        storage.release()
        return file
    # Pixel k of the coarse image is pixels 2k and 2k + 1 of one twice as fine.
    matrix = np.array([[finer, 0, (finer - 1) / 2], [0, finer, (finer - 1) / 2], [0, 0, 1]]) @ MATRIX
    size = [f"image_width: {640 * finer}", f"image_height: {480 * finer}"]
    lines = [*size, "camera_name: webcam", f"distortion_model: {model}"]
    lines += ["camera_matrix:", "  rows: 3", "  cols: 3", f"  data: {matrix.ravel().tolist()}"]
    lines += ["distortion_coefficients:", "  rows: 1", f"  cols: {len(numbers)}", f"  data: {numbers}"]
    file.write_text("\n".join(lines) + "\n")
    return file


def projected(lens, camera_from_board, points=CORNERS):
    turn, place = cv2.Rodrigues(camera_from_board[:3, :3])[0], camera_from_board[:3, 3].copy()
    model, numbers = LENSES[lens]
    if model == "equidistant":
        pixels, _ = cv2.fisheye.projectPoints(points.reshape(-1, 1, 3), turn, place.reshape(3, 1), MATRIX, np.array(numbers))
    else:
        pixels, _ = cv2.projectPoints(points, turn, place, MATRIX, np.array(numbers))
    return pixels.reshape(-1, 2)


def pose(told):
    x, y, z, w = told.get("quaternion_xyzw") or told["quaternion"]
    result = kinematics.translation(*told["xyz"])
    result[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return result


def tips(rows):
    """base_from_tip of each row, by an independent reader."""
    tree = kinematics.Tree(PANDA)
    joints = [name for name in rows[0] if name in tree.by_name]
    return [tree.pose("panda_link0", "panda_link8", {name: float(row[name]) for name in joints}) for row in rows]


def simulated(folder, lens, on_hand, *options, writer="ros"):
    """Rows of a simulated file, their tips, truth, and camera_from_board in each."""
    camera = camera_file(folder, lens, writer)
    arguments = ["--tip", "panda_link8", "--camera", camera, "--board", "7x5:30mm", *(["--on-hand"] if on_hand else [])]
    data, told = folder / "data.csv", folder / "truth.json"
    denavit("simulate", PANDA, *arguments, "-o", data, "--truth", told, "--geometry-error", "0,0", *options)
    truth = json.loads(told.read_text())
    lines = [line for line in data.read_text().splitlines() if not line.startswith("#")]
    rows = list(csv.DictReader(lines))
    still, on_tip = pose(truth["instrument_from_base"]), pose(truth["tip_from_targets"][0])
    there = tips(rows)
    seen = [still @ tip @ on_tip for tip in there]
    return arguments, rows, there, truth, [np.linalg.inv(view) if on_hand else view for view in seen]


@pytest.mark.parametrize("on_hand", [False, True])
@pytest.mark.parametrize("lens", LENSES)
def test_pixels_are_those_of_opencv(tmp_path, lens, on_hand):
    _, rows, _, _, views = simulated(tmp_path, lens, on_hand, "--rows", 12, "--pixel-noise", 0)
    compared = 0
    for row, view in zip(rows, views, strict=True):
        for number, pixel in enumerate(projected(lens, view)):
            if row[f"u{number}"]:
                compared += 1
                assert np.allclose([float(row[f"u{number}"]), float(row[f"v{number}"])], pixel, atol=2e-7, rtol=0)
    assert compared > 12 * 12


@pytest.mark.parametrize("on_hand", [False, True])
@pytest.mark.parametrize(("noise", "allowed"), [(0, 1e-6), (0.2, 3e-3)])
def test_hand_eye_is_that_of_opencv(tmp_path, on_hand, noise, allowed):
    arguments, rows, there, truth, _ = simulated(
        tmp_path, "plumb_bob", on_hand, "--rows", 40, "--pixel-noise", noise, writer="opencv"
    )
    denavit("calibrate", PANDA, *arguments, "--data", tmp_path / "data.csv", "--effects", "none", "--json", tmp_path / "report.json")
    report = json.loads((tmp_path / "report.json").read_text())
    turns, places, tip_turns, tip_places = [], [], [], []
    for row, tip in zip(rows, there, strict=True):
        seen = [number for number in range(24) if row[f"u{number}"]]
        pixels = np.array([[float(row[f"u{number}"]), float(row[f"v{number}"])] for number in seen])
        _, turn, place = cv2.solvePnP(CORNERS[seen], pixels, MATRIX, np.array(LENSES["plumb_bob"][1]))
        turns.append(cv2.Rodrigues(turn)[0])
        places.append(place)
        moving = tip if on_hand else np.linalg.inv(tip)
        tip_turns.append(moving[:3, :3])
        tip_places.append(moving[:3, 3])
    turn, place = cv2.calibrateHandEye(tip_turns, tip_places, turns, places, method=cv2.CALIB_HAND_EYE_PARK)
    theirs = np.eye(4)
    theirs[:3, :3], theirs[:3, 3] = turn, place.ravel()
    # Camera on the tip; or camera in the base frame.
    ours = pose(report["placements"]["targets"][0]) if on_hand else np.linalg.inv(pose(report["placements"]["instruments"][0]))
    real = pose(truth["tip_from_targets"][0]) if on_hand else np.linalg.inv(pose(truth["instrument_from_base"]))
    away = {name: kinematics.distance(found, real) for name, found in {"denavit": ours, "OpenCV": theirs}.items()}
    print(away)
    assert max(away["denavit"]) < allowed and max(away["OpenCV"]) < 4 * allowed
    # The image is accurate only to its noise.
    rms = report["stages"][-1]["train"]["reprojection_rms_px"]
    assert rms < 1e-6 if noise == 0 else 0.26 < rms < 0.29


def test_the_lines_of_the_docs_detect_a_board(tmp_path, monkeypatch):
    arguments, rows, _, _, views = simulated(tmp_path, "plumb_bob", False, "--rows", 40, "--pixel-noise", 0)
    LENSES["none"] = ("plumb_bob", [0.0] * 5)
    # The same camera with a finer sensor, so that the markers are large enough to be read.
    camera_file(tmp_path, "none", finer=2)
    board = cv2.aruco.CharucoBoard((7, 5), 0.030, 0.022, cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50))
    drawn = board.generateImage((1400, 1000), marginSize=0, borderBits=1)
    # Position on the board, m, of the middle of a pixel of the board's picture.
    size = 0.030 / 200
    metres = np.array([[size, 0, size / 2], [0, size, size / 2], [0, 0, 1]])
    joints = [name for name in rows[0] if name.startswith("panda_joint")]
    with open(tmp_path / "readings.csv", "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["image", *joints])
        for index, (row, view) in enumerate(zip(rows, views, strict=True)):
            homography = MATRIX @ view[:3, [0, 1, 3]] @ metres
            # Four times as fine, then averaged, like a sensor.
            fine = np.array([[4, 0, 1.5], [0, 4, 1.5], [0, 0, 1]])
            image = cv2.warpPerspective(drawn, fine @ homography, (2560, 1920), flags=cv2.INTER_AREA, borderValue=200)
            cv2.imwrite(str(tmp_path / f"{index}.png"), cv2.resize(image, (1280, 960), interpolation=cv2.INTER_AREA))
            writer.writerow([f"{index}.png", *(row[name] for name in joints)])
    page = (built.WORKSPACE / "docs/camera.md").read_text()
    (lines,) = re.findall(r"```python\n(.*?)```", page, re.S)
    monkeypatch.chdir(tmp_path)
    exec(compile(lines, "docs/camera.md", "exec"), {})
    denavit("calibrate", PANDA, *arguments, "--data", "corners.csv", "--effects", "none", "--json", "report.json")
    report = json.loads(Path("report.json").read_text())
    rms = report["stages"][-1]["train"]["reprojection_rms_px"]
    print(f"{report['samples']['train']} images, {rms:.3f} px rms")
    assert report["samples"]["train"] > 30 and rms < 0.5
    parameters = [abs(entry["change"]) for entry in report["parameters"]]
    assert max(parameters) < 5e-3, report["parameters"]
