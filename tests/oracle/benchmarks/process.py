"""Times whole processes, start to exit, each in turn: `process.py DENAVIT ROBOT FILE`; one JSON line for each.

Prints the median of a few runs, and the command's processor time, which depends less on other load.
"""

import json
import os
import resource
import statistics
import subprocess
import sys
import time

RUNS = 15


def timed(command):
    walls, processors = [], []
    for _ in range(RUNS if "python" not in command[0] else 3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        start = time.perf_counter_ns()
        subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=True)
        walls.append(time.perf_counter_ns() - start)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        processors.append((after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime) * 1e9)
    return statistics.median(walls), statistics.median(processors)


def main(denavit, robot, path):
    commands = {
        "denavit table": [denavit, "table", path],
        "python, pinocchio reads the file": [sys.executable, "-c", f"import pinocchio; pinocchio.buildModelFromUrdf({path!r})"],
        "python, yourdfpy reads the file": [
            sys.executable, "-c", f"from yourdfpy import URDF; URDF.load({path!r}, load_meshes=False)",
        ],
        "/bin/true": ["/bin/true"],
    }
    for who, command in commands.items():
        try:
            wall, processor = timed(command)
        except (subprocess.CalledProcessError, OSError) as error:
            print(f"{robot}: {who} skipped, because {error}", file=sys.stderr)
            continue
        for suffix, ns in ((", from start to exit", wall), (", time in the processor", processor)):
            print(json.dumps({"robot": robot, "who": who + suffix, "what": "process", "ns": ns}))


if __name__ == "__main__":
    os.environ["OMP_NUM_THREADS"] = "1"
    main(*sys.argv[1:])
