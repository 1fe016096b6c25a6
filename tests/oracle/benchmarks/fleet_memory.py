"""Memory of `denavit fleet` as a function of the size of the store: the table of docs/fleet.md.

    .venv/bin/python tests/oracle/benchmarks/fleet_memory.py

Every run is a calibration of a simulated UR5e by 20 positions, geometry alone.
"""

import os
import subprocess
import sys
import tempfile
from datetime import date, timedelta
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import built

ROBOT = built.WORKSPACE / "robots/universal_robots/ur5e.urdf"
NIGHTS = 20
RUNS = [200, 1000, 5000]


def denavit(*words):
    subprocess.run([built.denavit(), *map(str, words)], check=True, capture_output=True)


def peak(*words):
    """Largest resident memory of a command, MB, and its processor time, s."""
    process = subprocess.Popen([built.denavit(), *map(str, words)], stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(process.pid, 0)
    assert os.waitstatus_to_exitcode(status) < 2, words
    return usage.ru_maxrss / 1024, usage.ru_utime + usage.ru_stime


def main():
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        for seed in range(NIGHTS):
            denavit("simulate", ROBOT, "--rows", 20, "--seed", seed, "-o", folder / f"{seed}.csv")
        print(f"| runs ({NIGHTS} nights a robot) | store, MB | run, MB | watch, MB | siblings, MB | with --prior-out, MB | report, MB | watch, s |")
        print("|---:|---:|---:|---:|---:|---:|---:|---:|")
        for runs in RUNS:
            store = folder / f"store{runs}"
            nights = [(run // NIGHTS, run % NIGHTS) for run in range(runs)]
            rows = [f"SN-{robot},{ROBOT},{night}.csv,{date(2026, 1, 1) + timedelta(night)},none" for robot, night in nights]
            (folder / "plant.csv").write_text("\n".join(["serial,robot,data,date,effects", *rows]) + "\n")
            run, _ = peak("fleet", "run", folder / "plant.csv", "-o", store)
            size = sum(path.stat().st_size for path in store.rglob("*.parquet")) / 1e6
            (watch, seconds), (siblings, _) = peak("fleet", "watch", store), peak("fleet", "siblings", store)
            prior, _ = peak("fleet", "siblings", store, "--prior-out", folder / f"prior{runs}.json")
            report, _ = peak("fleet", "report", store, "-o", folder / f"pages{runs}")
            print(f"| {runs} | {size:.0f} | {run:.0f} | {watch:.0f} | {siblings:.0f} | {prior:.0f} | {report:.0f} | {seconds:.1f} |", flush=True)


if __name__ == "__main__":
    main()
