"""Runs of purely geometric data, one JSON object a line: python runs.py slice|study [--runs N] [--only WORD] [--out FILE]

slice  few runs of many kinds, for the tests
study  many runs of each line of the table in docs/calibration.md

pinocchio places the joints; their placements in the URDF are perturbed. A line holds

    case, arm, measure, targets, rows, noise_m, noise_rad, seed     the drawn case
    nominal, built      URDF text of the drawn and of the built robot, base link "base", tip link "tip"
    train               measurements as CSV text, with noise, rounding and outliers
    test                unseen poses as CSV text, without any of them
    instrument, tool    instrument_from_base and tip_from_target of each target, 12 numbers of a 3x4 matrix by rows
    anchor              base frame, m
    outliers            rows of `train`, counted from 0
    rounding_m          rms error of the value in the train rows from rounding the readings (3-D norm), m
    rank                number of identifiable numbers from the train rows, from pinocchio's frames
    attainable_m        smallest rms of one component over the test rows of any unbiased fit to the train rows, without noise of
                        the test rows (Cramer-Rao); null without noise
"""

import argparse
import json
import os
import sys
import zlib
from dataclasses import asdict, dataclass, replace

# Small matrices: more threads only slow each other down. Read when numpy loads.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
import pinocchio as pin

from arms import ARMS, perturbed, to_urdf
from body import Body

RANK_TOLERANCE = 1e-9
DEGREE = np.pi / 180


@dataclass(frozen=True)
class Case:
    """A case to draw: `noise` m and rad, `geometry` m and rad, `grid` step of turning joints' readings in degrees."""

    arm: str
    measure: str
    targets: int
    rows: int
    noise: float = 5e-5
    geometry: float = 1e-3
    grid: float = 0.0
    outliers: float = 0.0
    still: int = -1
    test: int = 200

    def random(self, seed, what):
        """A generator for each purpose: runs with and without outliers, rounding or noise are equal in everything else."""
        kind = f"{self.arm} {self.measure} {self.targets} {self.rows}"
        return np.random.default_rng([seed, what, zlib.crc32(kind.encode())])

    @property
    def name(self):
        words = [self.arm, self.measure if self.measure != "position" else f"position x{self.targets}", str(self.rows)]
        words += [f"grid {self.grid} deg"] * (self.grid > 0) + ["outliers"] * (self.outliers > 0)
        words += ["noise-free"] * (self.noise == 0) + ["still"] * (self.still >= 0) + ["2 mrad"] * (self.geometry > 1e-3)
        return ", ".join(words)


class Stand:
    """A built robot in front of its instrument."""

    def __init__(self, case, seed):
        rng = case.random(seed, 1)
        self.nominal = ARMS[case.arm]
        self.built = perturbed(self.nominal, rng, case.geometry, case.geometry)
        self.body = Body(self.built)
        self.measure = case.measure
        self.instrument = pin.SE3(pin.exp3(rng.normal(0, 0.8, 3)), rng.uniform(-2, 2, 3))
        spots = rng.uniform(-0.12, 0.12, (case.targets, 3)) + [0, 0, 0.08]
        self.tools = [pin.SE3(pin.exp3(rng.normal(0, 0.5, 3)), spot) for spot in spots]
        self.anchor = np.array([*rng.uniform(-1.2, 1.2, 2), rng.uniform(0.0, 0.5)])

    def place(self, q):
        """Joint frames (rows, joints) and the tip (rows): rotations and positions."""
        model, data, n = self.body.model, self.body.data, self.body.n
        turns, places = np.empty((len(q), n, 3, 3)), np.empty((len(q), n, 3))
        for row, values in enumerate(q):
            pin.forwardKinematics(model, data, values)
            for i in range(n):
                frame = data.oMi[i + 1]
                turns[row, i], places[row, i] = frame.rotation, frame.translation
        tip = self.body.tip_origin
        return turns, places, turns[:, -1] @ tip.rotation, turns[:, -1] @ tip.translation + places[:, -1]

    def values(self, placed):
        """Noise-free: positions (rows, targets, 3) and orientations (rows, 3, 3), or distances (rows,)."""
        _, _, tip_turn, tip_place = placed
        points = np.stack([tip_turn @ tool.translation + tip_place for tool in self.tools], axis=1)
        if self.measure == "distance":
            return np.linalg.norm(points[:, 0] - self.anchor, axis=1), None
        seen = points @ self.instrument.rotation.T + self.instrument.translation
        return seen, self.instrument.rotation @ tip_turn @ self.tools[0].rotation

    def columns(self, placed):
        """Derivatives of the values by small motions of the base, of every joint's placement and of the targets.

        Redundant on purpose: they span the effects of all changes of the geometry. (rows, numbers per row, columns); for
        poses the rotation follows the position; base frame.
        """
        turns, places, tip_turn, tip_place = placed
        rows, joints = places.shape[:2]
        def skew(v):
            zero = np.zeros(v.shape[:-1])
            return np.stack([np.stack([zero, -v[..., 2], v[..., 1]], -1), np.stack([v[..., 2], zero, -v[..., 0]], -1),
                             np.stack([-v[..., 1], v[..., 0], zero], -1)], -2)
        eye, none = np.broadcast_to(np.eye(3), (rows, 3, 3)), np.zeros((rows, 3, 3))
        blocks = []
        for index, tool in enumerate(self.tools):
            point = tip_turn @ tool.translation + tip_place
            cells = [-skew(point), eye]
            for i in range(joints):
                cells += [-skew(point - places[:, i]) @ turns[:, i], turns[:, i]]
            cells += [tip_turn if other == index else none for other in range(len(self.tools))]
            block = np.concatenate(cells, axis=2)
            if self.measure == "distance":
                away = point - self.anchor
                block = (away / np.linalg.norm(away, axis=1)[:, None])[:, None] @ block
            blocks.append(block)
        if self.measure == "pose":
            cells = [eye, none]
            for i in range(joints):
                cells += [turns[:, i], none]
            blocks[0] = np.concatenate([blocks[0], np.zeros((rows, 3, 3))], axis=2)
            blocks.append(np.concatenate(cells + [none, tip_turn], axis=2))
        return np.concatenate(blocks, axis=1)


def determined_directions(columns):
    """Rank, scale of the columns, and singular values and directions that the rows determine."""
    flat = columns.reshape(-1, columns.shape[2])
    size = np.linalg.norm(flat, axis=0).clip(1e-12)
    _, s, vt = np.linalg.svd(flat / size, full_matrices=False)
    rank = int((s > RANK_TOLERANCE * s[0]).sum())
    return rank, size, s[:rank], vt[:rank]


def attainable(case, train, test):
    """Cramer-Rao: rms of one component of position (or distance) over the test rows."""
    rank, size, s, vt = determined_directions(train / case.noise)
    spread = (test[:, :3] if case.measure == "pose" else test).reshape(-1, test.shape[2]) / size @ (vt / s[:, None]).T
    return float(np.sqrt((spread**2).sum(axis=1).mean())), rank


def header(names, case):
    if case.measure == "distance":
        return [*names, "distance"]
    if case.measure == "pose":
        return [*names, "x", "y", "z", "qx", "qy", "qz", "qw"]
    if case.targets == 1:
        return [*names, "x", "y", "z"]
    return [*names, *(f"{c}{k + 1}" for k in range(case.targets) for c in "xyz")]


def quaternions(rotations):
    return np.array([pin.Quaternion(rotation).coeffs() for rotation in rotations])


def csv(names, case, q, positions, orientations):
    cells = [q, positions.reshape(len(q), -1)]
    if case.measure == "pose":
        cells.append(quaternions(orientations))
    table = np.concatenate(cells, axis=1).tolist()
    return "\n".join([",".join(header(names, case)), *(",".join(map(repr, row)) for row in table), ""])


def noisy(case, rng, positions, orientations):
    """Adds noise; `outliers` of the rows get errors of 5 to 50 mm and are returned."""
    positions = positions + rng.normal(0, case.noise, positions.shape)
    if orientations is not None:
        orientations = np.array([pin.exp3(turn) @ r for turn, r in zip(rng.normal(0, case.noise, (len(positions), 3)), orientations)])
    bad = np.sort(rng.choice(len(positions), round(case.outliers * len(positions)), replace=False))
    for row in bad:
        size = rng.uniform(5e-3, 5e-2)
        if positions.ndim == 1:
            positions[row] += size * rng.choice([-1, 1])
        else:
            direction = rng.normal(0, 1, 3)
            positions[row, rng.integers(positions.shape[1])] += size * direction / np.linalg.norm(direction)
    return positions, orientations, bad.tolist()


def matrix(placement):
    return np.hstack([placement.rotation, placement.translation[:, None]]).ravel().tolist()


def draw(case, seed, with_bounds=True):
    """One run."""
    stand = Stand(case, seed)
    rng = case.random(seed, 2)
    joints = stand.nominal.joints
    names = [joint.name for joint in joints]
    lower, upper = (np.array([joint.limits[k] for joint in joints]) for k in (0, 1))
    q = rng.uniform(lower, upper, (case.rows + case.test, len(joints)))
    if case.still >= 0:
        q[:, case.still] = 0.5 * (lower + upper)[case.still]
    train, test = q[:case.rows], q[case.rows:]
    placed, placed_test = stand.place(train), stand.place(test)
    values, turns = stand.values(placed)
    reading, rounding = train, 0.0
    if case.grid > 0:
        step = np.array([case.grid * DEGREE if joint.kind == "revolute" else 1e-9 for joint in joints])
        reading = np.round(train / step) * step
        off = stand.values(stand.place(reading))[0] - values
        rounding = float(np.sqrt((off**2).sum() / (off.size if off.ndim == 1 else off.size / 3)))
    measured, turned, bad = noisy(case, rng, values, turns)
    bound = rank = None
    if with_bounds:
        columns = stand.columns(placed)
        if case.noise > 0:
            bound, rank = attainable(case, columns, stand.columns(placed_test))
        else:
            rank = determined_directions(columns)[0]
    drawn = {key: value for key, value in asdict(case).items() if key not in ("noise", "test")}
    return {
        "case": case.name, **drawn, "noise_m": case.noise, "noise_rad": case.noise, "seed": seed,
        "nominal": to_urdf(stand.nominal, inertials=False), "built": to_urdf(stand.built, inertials=False),
        "train": csv(names, case, reading, measured, turned), "test": csv(names, case, test, *stand.values(placed_test)),
        "instrument": matrix(stand.instrument), "tool": [matrix(tool) for tool in stand.tools],
        "anchor": stand.anchor.tolist(), "outliers": bad, "rounding_m": rounding, "rank": rank, "attainable_m": bound,
    }


KINDS = (("pose", 1), ("position", 1), ("position", 3), ("distance", 1))


def slice_cases():
    """(case, number of runs)."""
    chosen = []
    for arm in ARMS:
        for measure, targets in KINDS:
            case = Case(arm, measure, targets, 60)
            chosen += [(replace(case, noise=0.0), 1), (replace(case, rows=1000, noise=0.0), 1), (replace(case, rows=200), 8)]
            chosen += [(replace(case, rows=300, outliers=share), 1) for share in (0.0, 0.05)]
        chosen += [(Case(arm, "pose", 1, 30, noise=0.0), 1), (Case(arm, "position", 1, 60, noise=0.0, still=2), 1)]
        chosen += [(Case(arm, "pose", 1, 10_000, noise=0.0), 1)]
        chosen += [(Case(arm, "position", 1, 300, grid=0.01), 1)]
    for arm in ("six_axis", "scara"):
        chosen += [(Case(arm, "pose", 1, 40, noise=noise, geometry=2e-3), 1) for noise in (0.0, 5e-5)]
        chosen += [(Case(arm, "position", 1, 60, geometry=2e-3), 1)]
    return chosen


def study_cases(runs):
    chosen = []
    for arm in ARMS:
        cases = [Case(arm, "pose", 1, 30), Case(arm, "pose", 1, 200), Case(arm, "position", 1, 40), Case(arm, "position", 1, 200),
                 Case(arm, "position", 3, 40), Case(arm, "distance", 1, 40), Case(arm, "distance", 1, 200),
                 Case(arm, "position", 1, 200, outliers=0.05)]
        chosen += [(replace(case, test=100), runs) for case in cases]
    chosen += [(Case(arm, "pose", 1, 40, geometry=2e-3, test=100), runs) for arm in ("six_axis", "scara")]
    chosen += [(Case(arm, "pose", 1, 10_000, test=100), max(1, runs // 20)) for arm in ("six_axis",)]
    return chosen


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("which", choices=["slice", "study"])
    p.add_argument("--runs", type=int, default=1000, help="of each line of the study")
    p.add_argument("--first", type=int, default=1, help="first seed")
    p.add_argument("--only", default="", help="lines whose name begins so")
    p.add_argument("--out", help="file; else standard output")
    chosen = p.parse_args()
    cases = slice_cases() if chosen.which == "slice" else study_cases(chosen.runs)
    cases = [(case, runs) for case, runs in cases if case.name.startswith(chosen.only)]
    out = open(chosen.out, "w", encoding="utf-8") if chosen.out else sys.stdout
    with out:
        for case, runs in cases:
            for run in range(runs):
                print(json.dumps(draw(case, chosen.first + run)), file=out)


if __name__ == "__main__":
    main()
