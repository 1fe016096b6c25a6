"""The table of `benches/run`: medians over the rounds, ratios to the named peer, machine and method.

    table.py ROUNDS_FOLDER

Each round has a folder of files `*.jsonl` with a line for each figure: {"robot", "who", "what", "ns"}.
"""

import json
import platform
import statistics
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

#: The comparisons: (heading, what, the program whose time is 1).
TABLES = [
    ("Forward kinematics, one configuration", "fk", "pinocchio (C++)"),
    ("Jacobian and pose, one configuration", "jacobian", "pinocchio (C++)"),
    ("Forward kinematics, a batch of 1000, per configuration on one core", "batch", "pinocchio (C++)"),
    ("Loading a URDF that is in memory (pinocchio, yourdfpy, roboticstoolbox: from the file)", "load", "urdf-rs"),
    ("Reading an MJCF that is in memory (MuJoCo: from the file)", "mjcf", "MuJoCo, parsed and compiled"),
    ("The whole process, one robot", "process", None),
]

def figures(folder):
    for path in sorted(folder.glob("*.jsonl")):
        for line in path.read_text().splitlines():
            found = json.loads(line)
            yield found["robot"], found["who"], found["what"], found["ns"]


def written(ns):
    for limit, unit in ((1e3, "ns"), (1e6, "µs"), (1e9, "ms")):
        if ns < limit:
            return f"{ns / limit * 1e3:.3g} {unit}"
    return f"{ns / 1e9:.3g} s"


def machine():
    names = [line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")]
    version = lambda *command: subprocess.run(command, capture_output=True, text=True, check=False).stdout.split("\n")[0]
    revision = version("git", "rev-parse", "--short", "HEAD")
    return f"{len(names)} × {names[0]}, {platform.system()} {platform.release()}, {version('rustc', '--version')}, revision {revision}"


def main(rounds):
    rounds = sorted(path for path in Path(rounds).iterdir() if path.is_dir())
    found = defaultdict(list)
    for folder in rounds:
        for robot, who, what, ns in figures(folder):
            found[what, robot, who].append(ns)
    median = {key: statistics.median(times) for key, times in found.items()}
    spread = {key: max(times) / min(times) for key, times in found.items()}
    print(f"Machine: {machine()}.  ")
    print(f"Method: {len(rounds)} rounds, in each of them every program in turn; each figure is the median over the rounds of the median in a round.")
    for heading, what, unit in TABLES:
        robots = sorted({robot for kind, robot, _ in median if kind == what})
        for robot in robots:
            rows = sorted((ns, who) for (kind, of, who), ns in median.items() if (kind, of) == (what, robot))
            one = median.get((what if what != "batch" else "fk", robot, unit))
            print(f"\n**{heading}: {robot}**\n\n| who | time | ratio to {unit or '-'} | largest/smallest round |\n|---|---:|---:|---:|")
            for ns, who in rows:
                ratio = f"{ns / one:.3f}" if one else ""
                print(f"| {who} | {written(ns)} | {ratio} | {spread[what, robot, who]:.2f} |")
    print("\n**Alone**\n\n| what | time |\n|---|---:|")
    for (what, robot, who), ns in sorted(median.items()):
        if what not in {table[1] for table in TABLES}:
            print(f"| {robot}: {who}{', ' + what if what not in ('many', 'limit') else ''} | {written(ns)} |")


if __name__ == "__main__":
    main(sys.argv[1])
