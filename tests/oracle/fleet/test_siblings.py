"""What robots share as the prior of one more: by the command line and by a manifest, to the same bit, and only where it fits."""

import csv
import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import built  # noqa: E402
import kinematics  # noqa: E402

duckdb = pytest.importorskip("duckdb", reason="skipped, because DuckDB is not installed (tests/oracle/environment)")

ROBOT = built.WORKSPACE / "robots/universal_robots/ur5e.urdf"
CHAIN = kinematics.Tree(ROBOT).chain("base", "tool0")
JOINTS = [joint for joint in CHAIN if joint.kind == "revolute"]
TOOL = CHAIN[-1].origin
assert CHAIN[:-1] == JOINTS
SIBLINGS, NEW = 8, 3
TABLES = ["runs", "parameters", "residuals", "axes", "information"]


def denavit(*words, codes=(0,)):
    run = subprocess.run([built.denavit(), *map(str, words)], capture_output=True, text=True, timeout=300)
    assert run.returncode in codes, f"{words}: exit code {run.returncode}\n{run.stdout}{run.stderr}"
    return run.stdout + run.stderr


def errors(random, metres, radians):
    """Of each of six links: a small motion."""
    return [kinematics.exp_twist(np.r_[random.normal(0, radians, 3), random.normal(0, metres, 3)]) for _ in range(6)]


# What the castings of a series share: as large as the drawing's tolerances.
SERIES = errors(np.random.default_rng(2026), 1e-3, 1e-3)


def robot(serial, knocked=0.0):
    """A robot of the series: each link a little off by itself, zeros set by hand."""
    random = np.random.default_rng(serial)
    own, zeros = errors(random, 1e-4, 1e-4), random.normal(0, 5e-4, 6)
    zeros[2] += knocked
    instrument = kinematics.exp_twist(random.normal(0, 1, 6))
    target = np.r_[random.normal(0, 0.1, 3), 1]
    return [s @ o for s, o in zip(SERIES, own)], zeros, instrument, target


def measure(path, robot, poses, seed):
    """Positions with 0.05 mm noise; numpy's own forward kinematics of the URDF's numbers."""
    links, zeros, instrument, target = robot
    random = np.random.default_rng(seed)
    with open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow([*(joint.name for joint in JOINTS), "x", "y", "z"])
        for _ in range(poses):
            q = random.uniform(-2.5, 2.5, 6)
            pose = instrument
            for joint, link, zero, angle in zip(JOINTS, links, zeros, q):
                pose = pose @ joint.origin @ link @ kinematics.rot_z(angle + zero)
            place = (pose @ TOOL @ target)[:3] + random.normal(0, 5e-5, 3)
            writer.writerow([f"{number:.8f}" for number in [*q, *place]])


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    """Eight robots at forty poses; three more at eight, the last with an elbow that is off by 50 mrad."""
    folder = tmp_path_factory.mktemp("siblings")
    lines = ["serial,robot,data,test,date,prior,effects"]
    for serial in range(SIBLINGS):
        measure(folder / f"{serial}.csv", robot(serial), 40, serial)
        lines.append(f"SN-{serial},{ROBOT},{serial}.csv,,2026-11-01,,none")
    for new in range(NEW):
        made = robot(50 + new, 0.05 * (new == NEW - 1))
        measure(folder / f"new-{new}.csv", made, 8, 100 + new)
        measure(folder / f"test-{new}.csv", made, 50, 200 + new)
        lines.append(f"NEW-{new},{ROBOT},new-{new}.csv,test-{new}.csv,2026-11-01,siblings,none")
    (folder / "plant.csv").write_text("\n".join(lines) + "\n")
    assert "11 done now" in denavit("fleet", "run", folder / "plant.csv", "-o", folder / "store")
    return folder


def everything(store):
    columns = {"runs": "* exclude (seconds)"}
    return {
        table: duckdb.sql(f"select {columns.get(table, '*')} from '{store}/{table}/*.parquet' order by all").fetchall()
        for table in TABLES
    }


def test_threads_and_order_of_work_change_no_bit_and_nothing_is_done_twice(plant):
    assert "0 done now, 11 done before" in denavit("fleet", "run", plant / "plant.csv", "-o", plant / "store")
    # The last first, and the new ones begun before their siblings are there.
    lines = (plant / "plant.csv").read_text().splitlines()
    (plant / "turned.csv").write_text("\n".join([lines[0], *reversed(lines[1:])]) + "\n")
    denavit("fleet", "run", plant / "turned.csv", "--threads", 1, "-o", plant / "one")
    assert everything(plant / "one") == everything(plant / "store")


def test_the_manifest_does_what_the_two_commands_do(plant):
    prior = plant / "prior.json"
    said = denavit("fleet", "siblings", plant / "store", "--prior-out", prior, codes=(0, 1))
    assert f"{SIBLINGS} robots with the drawing" in said
    assert json.loads(prior.read_text())["schema"] == "denavit.prior/1"
    for robot in range(NEW):
        data = ["--data", plant / f"new-{robot}.csv", "--test", plant / f"test-{robot}.csv", "--effects", "none"]
        report = json.loads(denavit("calibrate", ROBOT, *data, "--prior", prior, "--json"))
        where = f"where serial = 'NEW-{robot}'"
        found = duckdb.sql(
            f"select joint || '.' || parameter, value, std from '{plant}/store/parameters/*.parquet' {where}"
        ).fetchall()
        assert sorted(found) == sorted((p["parameter"], p["change"], p["std"]) for p in report["parameters"])
        (run,) = duckdb.sql(f"select prior, prior_weight from '{plant}/store/runs/*.parquet' {where}").fetchall()
        assert run == ("siblings", report["earlier"]["weight"])


def geometric(report):
    return next(stage["test"]["position_rms_m"] for stage in report["stages"] if stage["name"] == "geometric")


def test_eight_poses_are_worth_more_with_siblings_and_a_robot_unlike_them_is_not_spoiled(plant):
    weights, errors = [], []
    for robot in range(NEW):
        data = ["--data", plant / f"new-{robot}.csv", "--test", plant / f"test-{robot}.csv", "--effects", "none", "--json"]
        alone = json.loads(denavit("calibrate", ROBOT, *data))
        with_them = json.loads(denavit("calibrate", ROBOT, *data, "--prior", plant / "prior.json"))
        errors.append((geometric(alone), geometric(with_them)))
        weights.append(with_them["earlier"]["weight"])
    alone, with_them = np.sqrt(np.mean(np.square(errors[:-1]), axis=0))
    assert with_them < 0.8 * alone, errors
    assert errors[-1][1] < 1.25 * errors[-1][0] and weights[-1] < min(weights[:-1]), (errors, weights)


def test_information_is_what_the_rows_say_without_the_prior(plant):
    """Inverse covariance of the fit less that of the prior: numpy puts the report's own numbers together."""
    report = json.loads(denavit("calibrate", ROBOT, "--data", plant / "0.csv", "--effects", "none", "--json"))
    names = [p["parameter"] for p in report["parameters"]]
    rows = duckdb.sql(
        f"select parameter, other, value from '{plant}/store/information/*.parquet' where serial = 'SN-0'"
    ).fetchall()
    told, pull = np.zeros((24, 24)), np.zeros(24)
    for parameter, other, value in rows:
        i = names.index(parameter)
        if other is None:
            pull[i] = value
        else:
            told[i, names.index(other)] = told[names.index(other), i] = value
    std = np.array([p["std"] for p in report["parameters"]])
    change = np.array([p["change"] for p in report["parameters"]])
    correlation = np.eye(24)
    for i, row in enumerate(report["posterior"]["correlations"]):
        correlation[i, :i] = correlation[:i, i] = row
    # In tolerances (1 mrad, 1 mm); six directions are the common frame's.
    scaled = told * 1e-6
    eigenvalues = np.linalg.eigvalsh(scaled)
    assert abs(eigenvalues[:6]).max() < 1e-6 * eigenvalues[-1] and eigenvalues[6] > 1e-3
    # Forty rows tell far more than the prior: the rows' best values are those of the fit, to a share of its deviations.
    best = np.linalg.pinv(scaled, rcond=1e-8) @ (pull * 1e-3) * 1e-3
    assert (abs(best - change) < 0.5 * std).all(), (best - change) / std
    spread = np.linalg.pinv(scaled, rcond=1e-8) * 1e-6
    assert (np.sqrt(np.diag(spread)) > 0.999 * std).all()
    assert abs(np.sqrt(np.diag(spread)) / std - 1).max() < 0.3
    assert abs(spread / np.sqrt(np.outer(np.diag(spread), np.diag(spread))) - correlation).max() < 0.3


def test_few_siblings_are_a_row_with_its_error(plant, tmp_path):
    lines = (plant / "plant.csv").read_text().splitlines()
    few = [lines[0], *lines[1:3], lines[-1]]
    (plant / "few.csv").write_text("\n".join(few) + "\n")
    denavit("fleet", "run", plant / "few.csv", "-o", tmp_path / "store", codes=(1,))
    found = duckdb.sql(f"select serial, error from '{tmp_path}/store/runs/*.parquet' where not ok").fetchall()
    assert [serial for serial, _ in found] == ["NEW-2"] and "fewer than 3 other robots" in found[0][1]
    said = denavit("fleet", "siblings", tmp_path / "store", "--prior-out", tmp_path / "p.json", codes=(2,))
    assert "fewer than 3 robots with the drawing" in said and not (tmp_path / "p.json").exists()
    said = denavit("fleet", "siblings", tmp_path / "store", "--without", "SN-9", "--prior-out", tmp_path / "p.json", codes=(2,))
    assert 'no robot "SN-9" was calibrated on its own' in said


def test_a_store_without_the_later_tables_is_read(plant, tmp_path):
    old = tmp_path / "old"
    shutil.copytree(plant / "store", old)
    shutil.rmtree(old / "axes")
    shutil.rmtree(old / "information")
    assert "outliers at a false discovery rate" in denavit("fleet", "siblings", old, codes=(0, 1))
    assert "0 robots watched" in denavit("fleet", "watch", old)
    said = denavit("fleet", "siblings", old, "--prior-out", tmp_path / "p.json", codes=(2,))
    assert "no robot was calibrated on its own since this version; run the manifest again" in said


def test_a_prior_is_of_calibrations_alone(plant, tmp_path):
    (tmp_path / "plant.csv").write_text(f"serial,robot,prior\nA,{ROBOT},siblings\n")
    said = denavit("fleet", "run", tmp_path / "plant.csv", "-o", tmp_path / "store", codes=(2,))
    assert "plant.csv:2: only the task calibrate has a prior, but this is table" in said


BAXTER = built.WORKSPACE / "robots/rethink/baxter.urdf"
HANDS = ("left_hand", "right_hand")


def test_each_arm_of_a_robot_has_siblings_of_its_own(tmp_path):
    """Four robots measured at both hands; a fifth goes on from the left arms with its left, from the right with its right."""
    lines = ["serial,robot,tip,data,date,prior,effects"]
    for robot in range(5):
        for side, hand in enumerate(HANDS):
            data, few = tmp_path / f"{robot}-{hand}.csv", robot == 4
            how = ["--tip", hand, "--rows", 12 if few else 40, "--seed", 10 * robot + side]
            denavit("simulate", BAXTER, *how, "-o", data)
            # The hands in turn are measured first, so that neither is always the last.
            day = 1 + (robot + side) % 2
            lines.append(f"B-{robot},{BAXTER},{hand},{data.name},2026-11-0{day},{'siblings' if few else ''},none")
    (tmp_path / "plant.csv").write_text("\n".join(lines) + "\n")
    store = tmp_path / "store"
    assert "10 done now, 0 done before, 0 failed" in denavit("fleet", "run", tmp_path / "plant.csv", "-o", store)
    said = denavit("fleet", "siblings", store, "--prior-out", tmp_path / "none.json", codes=(2,))
    assert "was calibrated to left_hand and to right_hand; choose one with --tip" in said
    said = denavit("fleet", "siblings", store, "--tip", "hand", "--prior-out", tmp_path / "none.json", codes=(2,))
    assert "no robot was calibrated on its own to hand; the store has left_hand, right_hand" in said
    assert not (tmp_path / "none.json").exists()
    for hand in HANDS:
        prior = tmp_path / f"{hand}.json"
        said = denavit("fleet", "siblings", store, "--tip", hand, "--prior-out", prior, codes=(0, 1))
        assert f"the prior has 4 robots with the drawing {BAXTER}, to {hand}" in said
        data = ["--tip", hand, "--data", tmp_path / f"4-{hand}.csv", "--effects", "none", "--json"]
        report = json.loads(denavit("calibrate", BAXTER, *data, "--prior", prior))
        found = duckdb.sql(
            f"select p.joint || '.' || p.parameter, p.value, p.std from '{store}/parameters/*.parquet' p "
            f"join '{store}/runs/*.parquet' r using (key) where r.serial = 'B-4' and r.tip = '{hand}'"
        ).fetchall()
        assert len(found) == 28
        assert sorted(found) == sorted((p["parameter"], p["change"], p["std"]) for p in report["parameters"])
