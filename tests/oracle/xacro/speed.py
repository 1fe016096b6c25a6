"""Times whole processes, UR5e: `python speed.py` prints the medians of both programs, wall clock and processor time.

`--at-least N` exits with 1 if we are not N times faster.
"""

import resource
import statistics
import sys
import time

from programs import WORKSPACE, ours, reference_command, run

RUNS = 21
PACKAGES = WORKSPACE.parent / "shared/vendor/xacro/packages"
FILE = PACKAGES / "ur_description/urdf/ur.urdf.xacro"
ARGUMENTS = ["name:=ur5e", "ur_type:=ur5e"]


def medians(command):
    """Seconds of wall clock and of processor time, which depends less on other load."""
    clock, processor = [], []
    for _ in range(RUNS):
        before, start = used(), time.perf_counter()
        done = run(command)
        clock.append(time.perf_counter() - start)
        processor.append(used() - before)
        assert done.returncode == 0, done.stderr
    return statistics.median(clock), statistics.median(processor)


def used():
    children = resource.getrusage(resource.RUSAGE_CHILDREN)
    return children.ru_utime + children.ru_stime


def main():
    if not FILE.is_file():
        print("skipped, because ../shared/vendor/xacro is not there")
        return 0
    mine, mine_processor = medians([*ours(), str(FILE), "--package-path", str(PACKAGES), *ARGUMENTS])
    theirs, theirs_processor = medians(reference_command(FILE, [PACKAGES], ARGUMENTS))
    print(f"{' '.join(ours())}: {mine * 1e3:.1f} ms, {mine_processor * 1e3:.1f} ms of processor time")
    print(f"Python tool: {theirs * 1e3:.1f} ms, {theirs_processor * 1e3:.1f} ms of processor time")
    print(f"ratio: {theirs / mine:.1f}, {theirs_processor / mine_processor:.1f} of processor time")
    wanted = float(sys.argv[sys.argv.index("--at-least") + 1]) if "--at-least" in sys.argv else 0.0
    return int(theirs < wanted * mine)


if __name__ == "__main__":
    sys.exit(main())
