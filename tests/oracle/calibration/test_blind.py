"""A slice of the blind suite: files made by `generate.py`, given to `denavit calibrate` with its defaults, compared with the truth.

The whole suite: suite.py makes the cases, `cargo run --release -p denavit-calibrate --example study_tracing` evaluates them.
"""

import json
import subprocess

import numpy as np
import pytest

import built
from generate import make, parser

# Five standard deviations of the rms over 100 test rows of three coordinates.
CHANCE = 1 + 5 / np.sqrt(2 * 300)

NAMED = [
    ("joint_scale", "scara", "pose"),
    ("helical_pitch", "six_axis", "position"),
    ("transmission_error", "seven_axis", "position"),
    ("joint_compliance", "six_axis", "position"),
    ("backlash", "rail_six_axis", "position"),
    ("joint_coupling", "seven_axis", "pose"),
    ("axis_wobble", "scara", "pose"),
    ("local_joint_error", "six_axis", "position"),
    ("link_compliance", "rail_six_axis", "pose"),
    ("base_compliance", "seven_axis", "pose"),
    ("thermal", "rail_six_axis", "position"),
    ("drift:shape=exponential", "six_axis", "position"),
    ("latency", "scara", "pose"),
    ("joint_compliance", "rail_six_axis", "distance"),
    ("transmission_error:motor=1", "six_axis", "position"),
]


HARDER = [
    ("softer_base", "six_axis", "position"),
    ("joint_compliance+joint_compliance", "six_axis", "pose"),
    ("hardening", "seven_axis", "position"),
    ("balancer", "six_axis", "position"),
    ("high_order", "seven_axis", "position"),
    ("two_orders", "scara", "pose"),
    ("three_orders", "rail_six_axis", "position"),
    ("friction_play", "seven_axis", "pose"),
]


def calibrated(folder, *options):
    """Truth and report of one case."""
    truth = make(folder, parser().parse_args([str(folder), "--count", "200", "--test", "100", *options]))
    command = [built.denavit(), "calibrate", folder / "nominal.urdf", "--data", folder / "train.csv", "--test", folder / "test.csv"]
    command += ["--json", folder / "report.json"]
    if truth["gear_ratio"]:
        command += ["--gear-ratio", f"{truth['effects'][0]['places'][0]}={truth['gear_ratio']:g}"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return truth, json.loads((folder / "report.json").read_text())


def place(claim):
    return claim.get("joint") or claim.get("where") or ""


def claims(report):
    """The named effects, and those in the model with possible alternatives."""
    return report["effects"] + report.get("one_of", [])


def of_distance(stage):
    return stage.get("position_rms_m") or stage["distance_rms_m"]


def attainable(truth, report):
    numbers = report["identifiability"]["rank"] + sum(len(effect["parameters"]) for effect in claims(report))
    size = {"pose": 3, "position": 3, "distance": 1}[truth["measure"]]
    per_row = 6 if truth["measure"] == "pose" else size
    return truth["noise_m"] * np.sqrt(size) * np.sqrt(1 + numbers / (truth["count"] * per_row))


@pytest.mark.parametrize(("effect", "arm", "measure"), HARDER)
def test_an_effect_as_real_machines_have_it_is_found_and_nothing_beside_it(effect, arm, measure, tmp_path):
    truth, report = calibrated(tmp_path / "case", "--effects", effect, "--arm", arm, "--measure", measure, "--seed", "5", "--strength", "8")
    hidden = {(effect["kind"], effect["places"][0]) for effect in truth["effects"]}
    found = {(claim["kind"], place(claim)) for claim in claims(report)}
    assert found == hidden, claims(report)


@pytest.mark.parametrize(("effect", "arm", "measure"), NAMED)
def test_an_effect_is_named_at_its_place_or_among_the_rivals(effect, arm, measure, tmp_path):
    truth, report = calibrated(tmp_path / "case", "--effects", effect, "--arm", arm, "--measure", measure, "--seed", "7", "--payload")
    hidden = truth["effects"][0]
    where = hidden["places"][0].replace("all", "all joints") if hidden["kind"] == "latency" else hidden["places"][0]
    for claim in claims(report):
        rivals = [(rival["kind"], rival["joint"]) for rival in claim["ambiguous_with"]]
        assert (hidden["kind"], where) in [(claim["kind"], place(claim)), *rivals], claims(report)
    assert claims(report), report["unexplained"]
    before, after = of_distance(report["stages"][1]["test"]), of_distance(report["stages"][-1]["test"])
    print(f"{effect} on {arm}: {before * 1e3:.4f} -> {after * 1e3:.4f} mm, attainable {attainable(truth, report) * 1e3:.4f}")
    assert after < attainable(truth, report) * (2.0 if measure == "distance" else CHANCE)


def test_a_joint_that_counts_from_the_ground_is_reported_with_the_fix(tmp_path):
    folder = tmp_path / "case"
    make(folder, parser().parse_args([str(folder), "--count", "200", "--test", "100", "--effects", "counted_from_ground", "--seed", "5"]))
    command = [built.denavit(), "calibrate", folder / "nominal.urdf", "--data", folder / "train.csv"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 0 and run.stdout.startswith("ATTENTION")
    assert 'if "elbow" were measured from the ground' in run.stderr and 'into column "elbow"' in run.stderr


@pytest.mark.parametrize("arm", ["six_axis", "seven_axis", "scara", "rail_six_axis"])
def test_nothing_is_named_where_nothing_is(arm, tmp_path):
    measure = "pose" if arm == "scara" else "position"
    _, report = calibrated(tmp_path / "case", "--arm", arm, "--measure", measure, "--seed", "3", "--rich", "--payload")
    assert claims(report) == [] and not report["unexplained"]["structured"]


@pytest.mark.parametrize("arm", ["six_axis", "rail_six_axis"])
def test_what_no_entry_describes_is_said_to_remain_and_where(arm, tmp_path):
    truth, report = calibrated(tmp_path / "case", "--effects", "two_joint_term", "--arm", arm, "--seed", "5")
    places = truth["effects"][0]["places"]
    assert report["unexplained"]["structured"]
    assert report["unexplained"]["where"][0]["joint"] in places
    assert {place(claim) for claim in claims(report)} <= set(places)
