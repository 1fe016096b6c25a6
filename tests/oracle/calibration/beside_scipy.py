"""denavit calibrate compared with scipy.optimize.least_squares on the same file: python beside_scipy.py DENAVIT [--rows N] [--times K]

10 000 full poses of the 6R arm made by pinocchio (`runs.py`), 0.05 mm and 0.05 mrad noise. Each program is timed as a
whole process, best of K by wall clock and by processor time (less affected by other load): start, reading the
files, fit, errors on the test file. Fails if the results differ.
"""

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
import pinocchio as pin

from arms import ARMS
from body import Body
from runs import Case, draw

ARM = "six_axis"


def axes():
    """Screw axes of the drawn arm, at home."""
    body = Body(ARMS[ARM])
    pin.forwardKinematics(body.model, body.data, np.zeros(body.n))
    frames = [body.data.oMi[i + 1] for i in range(body.n)]
    drawn = [((frame.rotation @ axis).tolist(), frame.translation.tolist()) for frame, axis in zip(frames, body.axes)]
    return {"axes": drawn, "home": (frames[-1] * body.tip_origin).homogeneous.tolist()}


def timed(command, times):
    """Wall clock and processor time, s, each the smallest of `times` runs; output of the last run."""
    wall = processor = np.inf
    for _ in range(times):
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        out = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        wall = min(wall, time.perf_counter() - start)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        processor = min(processor, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return (wall, processor), out


def main():
    p = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    p.add_argument("denavit", help="the release binary")
    p.add_argument("--rows", type=int, default=10_000)
    p.add_argument("--times", type=int, default=5)
    chosen = p.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        run = draw(Case(ARM, "pose", 1, chosen.rows), 1, with_bounds=False)
        for name, text in (("nominal.urdf", run["nominal"]), ("train.csv", run["train"]), ("test.csv", run["test"]),
                           ("axes.json", json.dumps(axes()))):
            (folder / name).write_text(text)
        ours, _ = timed([chosen.denavit, "calibrate", folder / "nominal.urdf", "--base", "base", "--tip", "tip",
                         "--data", folder / "train.csv", "--test", folder / "test.csv", "--effects", "none",
                         "--json", folder / "ours.json"], chosen.times)
        stage = json.loads((folder / "ours.json").read_text())["stages"][-1]
        rms = [[stage[part][key] for key in ("position_rms_m", "orientation_rms_rad")] for part in ("train", "test")]
        print(f"{chosen.rows} full poses, 6R, whole process, best of {chosen.times}\n\n| program | wall s | ratio | processor s "
              "| ratio | train rms mm | error on unseen poses mm | mrad | |\n|---|---|---|---|---|---|---|---|---|")
        def line(name, seconds, train, test, more=""):
            times = " | ".join(f"{took:.3f} | {took / our:.1f}" for took, our in zip(seconds, ours))
            print(f"| {name} | {times} | {train[0] * 1e3:.6f} | {test[0] * 1e3:.6f} | {test[1] * 1e3:.6f} | {more} |")
        line("denavit calibrate", ours, *rms)
        far = []
        for method in ("lm", "trf", "2-point"):
            seconds, out = timed([sys.executable, Path(__file__).with_name("poe_scipy.py"), folder / "axes.json",
                                  folder / "train.csv", folder / "test.csv", method], chosen.times)
            theirs = json.loads(out)
            name = "scipy trf, jac 2-point" if method == "2-point" else f"scipy {method}, closed-form jac"
            line(name, seconds, theirs["train"], theirs["test"],
                 f"reading {theirs['read_s']:.3f} s, fit {theirs['fit_s']:.3f} s, {theirs['evaluations']} evaluations")
            far += [(name, a, b) for a, b in zip(sum(rms, []), theirs["train"] + theirs["test"]) if abs(a - b) > 1e-3 * a]
        for name, a, b in far:
            print(f"{name}: {b:.3e} where denavit has {a:.3e}")
        return 1 if far else 0


if __name__ == "__main__":
    sys.exit(main())
