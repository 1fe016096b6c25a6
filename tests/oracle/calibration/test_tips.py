"""Several tips of one robot: the poses of both hands in the calibrated URDF, by yourdfpy, compared with the measurements."""

import csv
import json
import subprocess
from pathlib import Path

import numpy as np
import pytest
import yourdfpy

import built

TWO_ARMS = built.WORKSPACE / "crates/calibrate/tests/two_arms.urdf"
BAXTER = built.WORKSPACE / "robots/rethink/baxter.urdf"
VENDOR = built.WORKSPACE.parent / "shared/vendor/robots/oems/baxter.urdf"
CASES = {
    "two_arms": (TWO_ARMS, None, ["left_hand", "right_hand"]),
    "baxter": (BAXTER, None, ["left_hand", "right_hand"]),
    "vendor_baxter": (VENDOR, "torso", ["left_gripper", "right_gripper"]),
}


def denavit(*arguments):
    run = subprocess.run([built.denavit(), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


def rotation(quaternion):
    x, y, z, w = np.array(quaternion, float) / np.linalg.norm(quaternion)
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ])


def table(file):
    lines = [line for line in Path(file).read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


@pytest.mark.parametrize("case", CASES)
def test_the_calibrated_urdf_has_both_hands_where_they_were_measured(tmp_path, case):
    urdf, base, tips = CASES[case]
    if not urdf.is_file():
        pytest.skip(f"{urdf.name}: the vendor's file is not here")
    chosen = [urdf, *(["--base", base] if base else []), *[word for tip in tips for word in ("--tip", tip)]]
    made = [tmp_path / name for name in ("train.csv", "test.csv", "fit.json", "fit.urdf")]
    denavit("simulate", *chosen, "--measure", "poses", "--rows", 160, "--seed", 4, "-o", made[0], "--test", made[1],
            "--test-rows", 40)
    denavit("calibrate", *chosen, "--data", made[0], "--test", made[1], "--effects", "none", "--json", made[2],
            "--urdf", made[3])
    report = json.loads(made[2].read_text())
    assert [entry["tip"] for entry in report["tips"]] == tips
    assert {entry["held_out"] for entry in report["tips"]} == {20}
    robot = yourdfpy.URDF.load(str(made[3]), load_meshes=False, build_scene_graph=True)
    links = {tip: tip + "_calibrated" if tip + "_calibrated" in robot.link_map else tip for tip in tips}
    instrument = report["placements"]["instruments"][0]
    targets = {target["name"]: target for target in report["placements"]["targets"]}
    assert list(targets) == tips
    held_out = [row for row in report["rows"] if row["held_out"]]
    base = report["base"]
    off = {tip: [] for tip in tips}
    for row, residual in zip(table(made[1]), held_out, strict=True):
        robot.update_cfg({name: float(row[name]) for name in robot.actuated_joint_names if name in row})
        base_from_tip = robot.get_transform(links[row["tip"]], base)
        on_base = base_from_tip[:3, :3] @ targets[row["tip"]]["xyz"] + base_from_tip[:3, 3]
        measured = np.array([float(row[axis]) for axis in "xyz"])
        in_base = rotation(instrument["quaternion"]).T @ (measured - instrument["xyz"])
        assert residual["target"] == row["tip"]
        assert np.allclose(in_base - on_base, residual["residual_m"], atol=1e-9)
        off[row["tip"]].append(np.linalg.norm(in_base - on_base))
    for entry in report["tips"]:
        rms = float(np.sqrt(np.mean(np.square(off[entry["tip"]]))))
        assert rms == pytest.approx(entry["test"]["position_rms_m"], rel=1e-6)
        # Noise of 0.05 mm in each of three components, and the fit's error; the drawn errors were 1 mm and 1 mrad.
        assert rms < 1.6e-4
