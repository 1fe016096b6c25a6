"""Forward kinematics of every URDF of the corpus at random joint values, as JSON Lines, for the tests in Rust.

    python fk.py target/oracle/fk.jsonl

One line for each (file, chain from a root link to a leaf link, joint vector):

    {"file", "base", "tip", "joints": [driving joints in chain order], "q": [rad, m], "pose": [16 numbers by rows, m],
     "by": [who computed this pose and agrees]}

one line {"file", "refused": reason} for each file that yourdfpy does not read, and one {"file", "tip", "skipped": reason} for
each leaf whose joints have no meaning (a mimic of a joint that does not exist). The file is kept while the corpus and
these scripts are unchanged.

Three programs compute each pose: yourdfpy, pinocchio (this script sets its mimic joints) and `kinematics.py`. A pose is written
if two of them agree to 1e-9 m and rad; "differs" names the third if it does not. A mimic of a mimic is multiplied out. Joint
vectors have no floating or planar joints: a chain with one starts below the last of them.
"""

import hashlib
import json
import logging
import multiprocessing
import os
import sys
import warnings
from pathlib import Path

import numpy as np

import corpus
from kinematics import ACTUATED, Tree, distance

VECTORS = 10
CHAINS = 40
TOLERANCE = 1e-9
WIDEST_TURN = 2 * np.pi
WIDEST_SLIDE = 10.0


def key_of(files):
    """A key that changes with any file, this script, its imports and the pinned versions."""
    digest = hashlib.sha256()
    here = Path(__file__).parent
    for path in [here / name for name in ("fk.py", "kinematics.py", "corpus.py", "requirements.txt")] + [p for _, p in files]:
        digest.update(f"{path}\0".encode() + hashlib.sha256(path.read_bytes()).digest())
    return digest.hexdigest()


def span(joint):
    """The interval of the random values: the limits, within one turn either way and 10 m."""
    turning = joint.kind != "prismatic"
    widest = WIDEST_TURN if turning else WIDEST_SLIDE
    if joint.limits is None or joint.kind == "continuous":
        return (-np.pi, np.pi) if turning else (-1.0, 1.0)
    low, high = sorted(joint.limits)
    return max(low, -widest), min(high, widest)


def chains(tree):
    """([(base, tip)], [(tip, error)]): up to CHAINS leaves, one for each set of driving joints first."""
    found, errors = [], []
    for root in tree.roots:
        for leaf in tree.leaves:
            try:
                joints = tree.chain(root, leaf)
            except ValueError:
                continue
            base = root
            for joint in joints:
                if joint.kind not in ACTUATED and joint.kind != "fixed":
                    base = joint.child
            try:
                drivers = tree.drivers(base, leaf)
            except ValueError as error:
                errors.append((leaf, reason(error)))
                continue
            if drivers:
                found.append((tuple(drivers), base, leaf))
    firsts, others, seen = [], [], set()
    for drivers, base, leaf in found:
        (others if drivers in seen else firsts).append((base, leaf))
        seen.add(drivers)
    return (firsts + others)[:CHAINS], errors


class Yourdfpy:
    def __init__(self, path):
        import yourdfpy

        logging.disable(logging.CRITICAL)
        self.robot = yourdfpy.URDF.load(str(path), load_meshes=False, build_collision_scene_graph=False)

    def update(self, tree, values):
        self.robot.update_cfg({name: values[name] for name in self.robot.actuated_joint_names if name in values})

    def pose(self, base, tip):
        return np.array(self.robot.get_transform(tip, base))


class Pinocchio:
    def __init__(self, path):
        import pinocchio

        self.pin = pinocchio
        self.model = pinocchio.buildModelFromUrdf(str(path))
        self.data = self.model.createData()

    def update(self, tree, values):
        q = self.pin.neutral(self.model)
        for joint in tree.joints:
            if joint.kind in ACTUATED and (joint.mimic is None or joint.mimic[0] in tree.by_name):
                driver, multiplier, offset = tree.driver(joint)
                value = multiplier * values[driver.name] + offset
                place = self.model.joints[self.model.getJointId(joint.name)]
                q[place.idx_q : place.idx_q + place.nq] = value if place.nq == 1 else (np.cos(value), np.sin(value))
        self.pin.framesForwardKinematics(self.model, self.data, q)

    def pose(self, base, tip):
        frames = [self.data.oMf[self.model.getFrameId(link, self.pin.FrameType.BODY)] for link in (base, tip)]
        return (frames[0].inverse() * frames[1]).homogeneous


def quiet():
    """Silences the C++ libraries, which complain on standard error about files whose errors are recorded here anyway."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)


def reason(error):
    return f"{type(error).__name__}: {error}".strip().split("\n")[0][:300]


def records(path):
    """The lines for one file."""
    lines, programs = [], {}
    try:
        tree = Tree(path)
    except Exception as error:  # noqa: BLE001 - any error of a broken file is the result
        return [{"file": str(path), "refused": reason(error)}]
    for name, program in (("yourdfpy", Yourdfpy), ("pinocchio", Pinocchio)):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                programs[name] = program(path)
        except Exception as error:  # noqa: BLE001
            if name == "yourdfpy":
                lines.append({"file": str(path), "refused": reason(error)})
    rng = np.random.default_rng(int.from_bytes(hashlib.sha256(path.read_bytes()).digest()[:8], "big"))
    drivers = [joint for joint in tree.joints if joint.kind in ACTUATED and joint.mimic is None]
    pairs, errors = chains(tree)
    lines += [{"file": str(path), "tip": tip, "skipped": error} for tip, error in errors]
    if not pairs:
        lines.append({"file": str(path), "skipped": "no joint moves" if tree.roots or not tree.links else "no root link"})
    for _ in range(VECTORS if pairs else 0):
        values = {joint.name: float(rng.uniform(*span(joint))) for joint in drivers}
        alive = {}
        for name, program in programs.items():
            try:
                program.update(tree, values)
                alive[name] = program
            except Exception as error:  # noqa: BLE001
                alive[name] = reason(error)
        for base, tip in pairs:
            lines.append(agreed(path, tree, base, tip, values, alive))
    return lines


def agreed(path, tree, base, tip, values, programs):
    """One line: the pose that two programs agree on."""
    joints = tree.drivers(base, tip)
    line = {"file": str(path), "base": base, "tip": tip, "joints": joints, "q": [values[name] for name in joints]}
    own = tree.pose(base, tip, values)
    by, differs = ["numpy"], {}
    for name, program in programs.items():
        try:
            if isinstance(program, str):
                raise RuntimeError(program)
            metres, radians = distance(program.pose(base, tip), own)
            if max(metres, radians) < TOLERANCE:
                by.append(name)
            else:
                differs[name] = f"{metres:.3g} m, {radians:.3g} rad"
        except Exception as error:  # noqa: BLE001
            differs[name] = reason(error)
    if len(by) > 1:
        line["pose"] = own.ravel().tolist()
    line["by"] = by
    if differs:
        line["differs"] = differs
    return line


def main(target):
    files = corpus.files()
    key = key_of(files)
    stamp = target.with_suffix(".key")
    kept = target.exists() and stamp.exists() and stamp.read_text() == key
    if not kept:
        target.parent.mkdir(parents=True, exist_ok=True)
        partial = target.with_suffix(".partial")
        with multiprocessing.Pool(2, initializer=quiet) as pool, partial.open("w", encoding="utf-8") as out:
            for lines in pool.imap(records, [path for _, path in files]):
                for line in lines:
                    out.write(json.dumps(line) + "\n")
        partial.replace(target)
        stamp.write_text(key)
    lines = [json.loads(line) for line in target.open(encoding="utf-8")]
    poses = [line for line in lines if "pose" in line]
    print(
        f"oracle: {len(files)} files, {len({(p['file'], p['base'], p['tip']) for p in poses})} chains, {len(poses)} poses in {target}"
        f" ({'kept' if kept else 'made'});"
        f" {sum('refused' in line for line in lines)} files refused by yourdfpy,"
        f" {sum('by' in line and 'pose' not in line for line in lines)} poses without a second witness,"
        f" {sum('yourdfpy' in line.get('differs', {}) for line in lines)} where yourdfpy differs"
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else corpus.WORKSPACE / "target/oracle/fk.jsonl")
