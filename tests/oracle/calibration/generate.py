"""Blind calibration data: python generate.py OUT --arm six_axis --seed 1 --effects joint_compliance --strength 5

Writes OUT/nominal.urdf, OUT/train.csv, OUT/test.csv (in the format of `measurements.csv`) and OUT/truth.json, which no tool
may read. The built arm has errors of 1 mrad and 1 mm in its joint origins; effects act by their physics (`effects.py`), elastic
ones in static equilibrium. Strength: RMS over the train rows of the effect's displacement of the measured quantities, in
units of their noise, after subtracting the best change of geometry, instrument frame and target (projection on
the linearised geometry).
"""

import argparse
import json
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin

from arms import ARMS, perturbed, to_urdf
from body import Body, Moment
from effects import ALIENS, KINDS
from harder import HARDER

SWALLOWED = 0.03  # an effect is drawn again if geometry leaves less than this fraction of it unexplained


def moments(arm, count, rng, span):
    """Random poses at random rest times, in run order; the approach side is the side of the row before."""
    n = len(arm.joints)
    lower, upper = (np.array([joint.limits[k] for joint in arm.joints]) for k in (0, 1))
    q = rng.uniform(lower, upper, (count, n))
    time = np.sort(rng.uniform(0, span, count))
    temperature = 20 + 9 * (1 - np.exp(-time / (0.3 * span))) + 1.5 * np.sin(7 * time / span) + rng.normal(0, 0.3, count)
    payload = rng.choice([0.0, 1.5, 3.0], count)
    before = np.vstack([0.5 * (lower + upper)[None], q[:-1]])
    approach = np.where(q >= before, 1.0, -1.0)
    velocity = approach * rng.uniform(0.05, 1.0, (count, n)) * np.where(upper - lower < 0.5, 0.1, 1.0)
    return q, velocity, approach, time, temperature, payload


class Session:
    """One arm, one instrument, one measuring session."""

    def __init__(self, options):
        self.options = options
        rng = np.random.default_rng([options.seed, 1])
        self.nominal = ARMS[options.arm]
        self.built = perturbed(self.nominal, rng, options.geometry * 1e-3, options.geometry * 1e-3)
        self.body = Body(self.built)
        self.body.span = 60.0 * (options.count + options.test)
        self.instrument_from_base = pin.SE3(pin.exp3(rng.normal(0, 0.6, 3)), rng.uniform(-1, 1, 3) * [2, 2, 0.5])
        # Most instruments are level with the floor; the base is then tilted only slightly.
        if options.level:
            self.instrument_from_base = pin.SE3(pin.exp3(np.array([0, 0, rng.uniform(-3, 3)])), rng.uniform(-2, 2, 3))
        self.targets = rng.uniform(-0.1, 0.1, (options.targets, 3)) + [0, 0, 0.08]
        self.anchor = np.array([*rng.uniform(-1.2, 1.2, 2), rng.uniform(0.0, 0.5)])
        self.tool = pin.SE3(pin.exp3(rng.normal(0, 0.5, 3)), self.targets[0])
        self.rng = rng

    def rows(self, table, effects):
        """Noise-free measurement of each row, in units of the noise: (rows, numbers), and raw values."""
        o = self.options
        whitened, raw, placements = [], [], []
        for row in range(len(table[0])):
            moment = Moment(row, *(column[row] for column in table))
            if not o.payload:
                moment.payload = 0.0
            give = self.body.equilibrium(moment, effects)
            placements.append((moment.placements, moment.tip))
            if o.measure == "distance":
                point = moment.tip.act(self.targets[0] + give.target)
                value = [np.linalg.norm(point - self.anchor - give.anchor) * (1 + give.scale) + give.zero]
                whitened.append(np.array(value) / o.noise)
            elif o.measure == "position":
                points = [self.instrument_from_base.act(moment.tip.act(t + give.target)) * (1 + give.scale)
                          for t in self.targets]
                value = np.concatenate(points)
                whitened.append(value / o.noise)
            else:
                reached = self.instrument_from_base * moment.tip * pin.SE3(self.tool.rotation, self.tool.translation + give.target)
                value = (reached.translation * (1 + give.scale), reached.rotation)
                whitened.append(value)
            raw.append(value)
        return whitened, raw, placements

    def difference(self, a, b):
        """Displacement b - a in units of the noise, one vector over all rows."""
        if self.options.measure != "pose":
            return np.concatenate(b) - np.concatenate(a)
        return np.concatenate([np.concatenate([(y[0] - x[0]) / self.options.noise, pin.log3(y[1] @ x[1].T) / self.options.angle_noise])
                               for x, y in zip(a, b)])

    def geometry_columns(self, placements):
        """Displacements by geometry, frames and targets, linearised, in units of the noise: an orthonormal basis."""
        o = self.options
        rows = []
        for frames, tip in placements:
            spots = [self.tool.translation] if o.measure == "pose" else list(self.targets)
            for index, spot in enumerate(spots):
                point = tip.act(spot)
                cells = [np.hstack([-pin.skew(point), np.eye(3)])]
                for frame in frames:
                    r = frame.rotation
                    cells.append(np.hstack([-pin.skew(point - frame.translation) @ r, r]))
                own = np.zeros((3, 3 * len(spots)))
                own[:, 3 * index:3 * index + 3] = tip.rotation
                cells.append(own)
                block = np.hstack(cells)
                if o.measure == "distance":
                    away = point - self.anchor
                    block = (away / np.linalg.norm(away))[None] @ block
                else:
                    block = self.instrument_from_base.rotation @ block
                block = block / o.noise
                if o.measure == "pose":
                    block = np.hstack([block, np.zeros((3, 3))])
                    turn = np.hstack([np.eye(3), np.zeros((3, 3))]
                                     + [np.hstack([f.rotation, np.zeros((3, 3))]) for f in frames]
                                     + [np.zeros((3, 3)), tip.rotation])
                    block = np.vstack([block, self.instrument_from_base.rotation @ turn / o.angle_noise])
                rows.append(block)
        columns = np.vstack(rows)
        u, s, _ = np.linalg.svd(columns / np.linalg.norm(columns, axis=0).clip(1e-12), full_matrices=False)
        return u[:, s > 1e-9 * s[0]]

    def strength(self, table, effects, clean, basis):
        moved = self.difference(clean, self.rows(table, effects)[0])
        left = moved - basis @ (basis.T @ moved)
        return np.sqrt(np.mean(left**2)), np.sqrt(np.mean(moved**2))


def write_csv(path, session, table, raw, noisy, rich, needs):
    o, names = session.options, [joint.name for joint in session.nominal.joints]
    q, velocity, approach, time, temperature, payload = table
    header = list(names)
    if o.measure == "distance":
        header.append("distance")
    elif o.measure == "pose":
        header += ["x", "y", "z", "qx", "qy", "qz", "qw"]
    elif o.targets == 1:
        header += ["x", "y", "z"]
    else:
        header += [f"{c}{k + 1}" for k in range(o.targets) for c in "xyz"]
    extra = []
    if rich or "time" in needs:
        extra.append(("time", time))
    if rich or "temperature" in needs:
        extra.append(("temperature", temperature))
    if o.payload:
        extra.append(("payload", payload))
    if rich or "velocity" in needs:
        extra += [(f"{name}.velocity", velocity[:, i]) for i, name in enumerate(names)]
    if (rich or "approach" in needs) and "row order" not in needs:
        extra += [(f"{name}.approach", approach[:, i]) for i, name in enumerate(names)]
    if rich:
        extra.append(("operator", np.array(["ann", "ben", "cho"])[np.arange(len(q)) * 3 // len(q)]))
    header += [name for name, _ in extra]
    lines = [",".join(header)]
    for row in range(len(q)):
        cells = [repr(float(v)) for v in q[row]]
        cells += [repr(float(v)) for v in noisy[row]]
        for _, values in extra:
            cells.append(values[row] if values.dtype.kind == "U" else repr(float(values[row])))
        lines.append(",".join(cells))
    path.write_text("\n".join(lines) + "\n")


def with_noise(session, raw, rng):
    o, rows = session.options, []
    for value in raw:
        if o.measure != "pose":
            rows.append(np.asarray(value) + rng.normal(0, o.noise, len(value)))
            continue
        rotation = pin.exp3(rng.normal(0, o.angle_noise, 3)) @ value[1]
        rows.append(np.concatenate([value[0] + rng.normal(0, o.noise, 3), pin.Quaternion(rotation).coeffs()]))
    return rows


def make(out, options):
    """Makes one blind case in the folder `out` and returns its truth."""
    session = Session(options)
    rng = np.random.default_rng([options.seed, 2])
    interleaved = moments(session.nominal, options.count + options.test, rng, session.body.span)
    in_test = np.zeros(options.count + options.test, bool)
    in_test[rng.choice(options.count + options.test, options.test, replace=False)] = True
    if "backlash" in options.effects:
        # The approach side may have to be derived from each file: train and test are two runs.
        in_test = np.arange(options.count + options.test) >= options.count

    clean = basis = None
    hidden, tries = [], 0
    wanted = [name for name in options.effects.split("+") if name and name != "none"]
    while len(hidden) < len(wanted):
        maker = {**KINDS, **ALIENS, **HARDER}[wanted[len(hidden)].split(":")[0]]
        words = dict(word.split("=") for word in wanted[len(hidden)].split(":")[1:])
        strength = float(words.pop("strength", options.strength))
        effect = maker(rng, session.nominal, **words)
        if clean is None:
            train = tuple(column[~in_test] for column in interleaved)
            clean, _, placements = session.rows(train, [])
            basis = session.geometry_columns(placements)
        size, target = 1.0, strength
        visible, total = session.strength(train, [effect.act(size)], clean, basis)
        tries += 1
        if visible < SWALLOWED * total or total == 0.0 or any(
                h.kind == effect.kind and h.places == effect.places for h in hidden):
            if tries > 40:
                raise SystemExit(f"{options.effects} on {options.arm}: geometry swallows it; choose another kind or arm")
            continue
        # A reading relative to another link changes by a whole turn for a turn, whatever the noise.
        for _ in range(0 if effect.shape.get("whole") else 2):
            size *= target / visible
            visible, total = session.strength(train, [effect.act(size)], clean, basis)
        hidden.append(effect)
        effect.size, effect.visible, effect.total = size, visible, total
    acting = [effect.act(effect.size) for effect in hidden]
    needs = tuple(need for effect in hidden for need in effect.needs)
    if not hidden:
        train = tuple(column[~in_test] for column in interleaved)
    test = tuple(column[in_test] for column in interleaved)

    out = Path(out)
    out.mkdir(parents=True, exist_ok=True)
    (out / "nominal.urdf").write_text(to_urdf(session.nominal, inertials=not options.no_inertials))
    for name, table in (("train", train), ("test", test)):
        _, raw, _ = session.rows(table, acting)
        write_csv(out / f"{name}.csv", session, table, raw, with_noise(session, raw, rng), options.rich, needs)
    truth = {
        "arm": options.arm, "measure": options.measure, "targets": options.targets, "seed": options.seed, "strength": options.strength,
        "noise_m": options.noise, "noise_rad": options.angle_noise, "count": len(train[0]), "test": len(test[0]),
        "gear_ratio": next((h.shape["gear_ratio"] for h in hidden if h.shape.get("gear_ratio")), None),
        "ground": next((h.shape["waves"] for h in hidden if h.kind == "ground"), []),
        "effects": [{"kind": h.kind, "places": h.places, "shape": h.shape, "size": h.size,
                     "visible_rms_in_noise": h.visible, "total_rms_in_noise": h.total} for h in hidden if h.kind != "ground"],
    }
    (out / "truth.json").write_text(json.dumps(truth, indent=1) + "\n")
    return truth


def parser():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("out")
    p.add_argument("--arm", choices=sorted(ARMS), default="six_axis")
    p.add_argument("--seed", type=int, default=0)
    p.add_argument("--count", type=int, default=250)
    p.add_argument("--test", type=int, default=200)
    p.add_argument("--noise", type=float, default=5e-5, help="m on each coordinate")
    p.add_argument("--angle-noise", type=float, default=5e-5, help="rad on each axis")
    p.add_argument("--geometry", type=float, default=1.0, help="mrad and mm on each axis of each joint origin")
    p.add_argument("--measure", choices=["pose", "position", "distance"], default="position")
    p.add_argument("--targets", type=int, default=1)
    p.add_argument("--effects", default="none", help="kinds joined by +; words after : choose (drift:shape=steps, strength=2)")
    p.add_argument("--strength", type=float, default=5.0)
    p.add_argument("--rich", action="store_true", help="every covariate in the files")
    p.add_argument("--payload", action="store_true", help="loads of 0, 1.5 and 3 kg at the tip")
    p.add_argument("--level", action="store_true", help="the instrument's z axis is vertical")
    p.add_argument("--no-inertials", action="store_true", help="the nominal URDF is without inertials")
    return p


if __name__ == "__main__":
    chosen = parser().parse_args()
    json.dump(make(chosen.out, chosen), sys.stdout, indent=1)
