"""A folder of blind cases: python suite.py OUT [--part singles|pairs|nulls|aliens|distances|motors|harder|all] [--first-seed N] [--nulls N] [--some N]

singles  every kind on every arm that can show it, at strengths 1, 2, 5, 20 times the noise
pairs    two and three kinds at once, strength 5
nulls    no effect, every covariate in the file
aliens   effects that no entry of the catalogue describes, strength 5
distances    kinds that are visible in one distance to each pose, 400 rows, strengths 2 and 5
harder   effects like those of real machines (harder.py), strengths 5 and 20; not part of all
motors   transmission errors of the motor side with the gear ratio, at strengths 1, 2, 5, 20
"""

import argparse
from concurrent.futures import ProcessPoolExecutor
from itertools import product
from pathlib import Path

import numpy as np

from arms import ARMS
from effects import ALIENS, KINDS
from generate import make, parser

STRENGTHS = (1, 2, 5, 20)
HARDER = {
    "softer_base": "softer_base", "two_joints_give": "joint_compliance+joint_compliance", "hardening": "hardening", "balancer": "balancer",
    "high_order": "high_order", "two_orders": "two_orders", "three_orders": "three_orders", "counted_from_ground": "counted_from_ground",
    "friction_play": "friction_play", "scale_in_field": "joint_scale+tiny_harmonics:strength=1.5",
}
# A SCARA's weight does not load its joints.
NOT_LOADED = ("softer_base", "two_joints_give", "hardening", "balancer", "counted_from_ground", "friction_play")
BY_DISTANCE = ("joint_scale", "transmission_error", "joint_compliance", "backlash", "local_joint_error", "thermal", "latency")
# On a SCARA the weight never changes the tilt of a vertical axis, and only the payload moves the quill; a
# scale of the instrument is visible only on slides, and is then the slide's own scale.
CANNOT_SHOW = {("scara", "joint_compliance"), ("scara", "base_compliance"), ("six_axis", "instrument_scale"),
               ("seven_axis", "instrument_scale"), ("scara", "instrument_scale"), ("rail_six_axis", "instrument_scale")}


def case(out, arm, words, name, seed, rng):
    """Options of one case; measurement kind, size and covariates are drawn."""
    effects = words.get("effects", "none")
    arguments = [str(out / name), "--arm", arm, "--seed", str(seed), "--effects", effects, "--strength", str(words.get("strength", 5))]
    needs_angles = any(kind in effects for kind in ("joint_coupling", "axis_wobble", "link_compliance")) or arm == "scara"
    measure = words.get("measure") or ("pose" if needs_angles else str(rng.choice(["position", "position", "pose"])))
    count = 400 if measure == "distance" else int(rng.choice([200, 250, 400]))
    arguments += ["--measure", measure, "--count", str(count)]
    if measure == "position":
        arguments += ["--targets", str(int(rng.choice([1, 1, 3])))]
    if words.get("rich", rng.random() < 0.4):
        arguments.append("--rich")
    if (rng.random() < 0.4 or words.get("rich")) and words.get("payload", True):
        arguments.append("--payload")
    return parser().parse_args(arguments)


def cases(out, part, first_seed, nulls):
    rng = np.random.default_rng([first_seed, 77])
    seed = first_seed * 100_000
    chosen = []
    def add(arm, words, name):
        nonlocal seed
        seed += 1
        chosen.append(case(out, arm, words, name, seed, rng))
    if part in ("singles", "all"):
        for kind, arm, strength in product(KINDS, ARMS, STRENGTHS):
            if (arm, kind) not in CANNOT_SHOW:
                add(arm, {"effects": kind, "strength": strength}, f"one_{strength:02d}_{seed}")
    if part in ("pairs", "all"):
        for number in range(40):
            arm = str(rng.choice(list(ARMS)))
            possible = [kind for kind in KINDS if (arm, kind) not in CANNOT_SHOW]
            picked = rng.choice(possible, 2 + number % 2, replace=False)
            add(arm, {"effects": "+".join(picked), "strength": 5}, f"many_{seed}")
    if part in ("nulls", "all"):
        for number in range(nulls):
            add(list(ARMS)[number % len(ARMS)], {"rich": True}, f"null_{seed}")
    if part in ("aliens", "all"):
        for alien, arm in product(ALIENS, ARMS):
            for _ in range(3):
                add(arm, {"effects": alien, "strength": 5}, f"odd_{seed}")
    if part in ("distances", "all"):
        for kind, arm, strength in product(BY_DISTANCE, ("six_axis", "seven_axis", "rail_six_axis"), (2, 5)):
            add(arm, {"effects": kind, "strength": strength, "measure": "distance"}, f"wire_{strength:02d}_{seed}")
    if part == "harder":
        for name, arm, strength in product(HARDER, ARMS, (5, 20)):
            if arm != "scara" or name not in NOT_LOADED:
                add(arm, {"effects": HARDER[name], "strength": strength, "payload": name != "two_joints_give"}, f"{name}_{strength:02d}_{seed}")
    if part in ("motors", "all"):
        for arm, strength in product(ARMS, STRENGTHS):
            add(arm, {"effects": "transmission_error:motor=1", "strength": strength}, f"motor_{strength:02d}_{seed}")
    return chosen


def made(options):
    try:
        make(options.out, options)
        return None
    except SystemExit as swallowed:
        return f"{options.out}: {swallowed}"
    except RuntimeError as soft:
        return f"{options.out}: {soft}"


if __name__ == "__main__":
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("out", type=Path)
    p.add_argument("--part", choices=["singles", "pairs", "nulls", "aliens", "distances", "motors", "harder", "all"], default="all")
    p.add_argument("--first-seed", type=int, default=1)
    p.add_argument("--nulls", type=int, default=40)
    p.add_argument("--some", type=int, help="so many of the cases, drawn at random")
    p.add_argument("--workers", type=int, default=1)
    chosen = p.parse_args()
    listed = cases(chosen.out, chosen.part, chosen.first_seed, chosen.nulls)
    if chosen.some is not None:
        drawn = np.random.default_rng(chosen.first_seed).choice(len(listed), min(chosen.some, len(listed)), replace=False)
        listed = [listed[index] for index in sorted(drawn)]
    with ProcessPoolExecutor(chosen.workers) as pool:
        for trouble in pool.map(made, listed):
            if trouble:
                print(trouble)
