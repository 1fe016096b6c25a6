"""Whole processes, UR5e: `python speed.py` prints the medians of both programs and their ratio.

`--at-least N` exits with 1 if we are not N times faster.
"""

import statistics
import sys
import time

from programs import WORKSPACE, ours, reference_command, run

RUNS = 21
PACKAGES = WORKSPACE.parent / "shared/vendor/xacro/packages"
FILE = PACKAGES / "ur_description/urdf/ur.urdf.xacro"
ARGUMENTS = ["name:=ur5e", "ur_type:=ur5e"]


def median(command):
    seconds = []
    for _ in range(RUNS):
        start = time.perf_counter()
        done = run(command)
        seconds.append(time.perf_counter() - start)
        assert done.returncode == 0, done.stderr
    return statistics.median(seconds)


def main():
    if not FILE.is_file():
        print("skipped, because ../shared/vendor/xacro is not there")
        return 0
    mine = median([*ours(), str(FILE), "--package-path", str(PACKAGES), *ARGUMENTS])
    theirs = median(reference_command(FILE, [PACKAGES], ARGUMENTS))
    print(f"ours {mine * 1e3:.1f} ms ({' '.join(ours())}), Python {theirs * 1e3:.1f} ms, ratio {theirs / mine:.1f}")
    wanted = float(sys.argv[sys.argv.index("--at-least") + 1]) if "--at-least" in sys.argv else 0.0
    return int(theirs < wanted * mine)


if __name__ == "__main__":
    sys.exit(main())
