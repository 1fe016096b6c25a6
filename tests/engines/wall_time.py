"""Wall time of a fleet against cores and engines: the table of docs/fleet.md.

    PROFILE=release python/tests/wheel && tests/engines/run --collect-only && target/python/engines/bin/python tests/engines/wall_time.py

Robots are the URDF files of the folders that are named, or those of robots/; calibrations are simulated. A task's overhead is what
is left of the workers' time when the computing that `runs.seconds` tells is taken away: wall time · workers - Σ seconds, by tasks.
"""

import argparse
import os
import tempfile
import time
from pathlib import Path

import denavit as dn
import duckdb
import plant
import ray

COLUMNS = "| work | engine | workers | wall time, s | computing, s | tasks a second | overhead a task, ms |"


def main():
    asked = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    asked.add_argument("folders", nargs="*", type=Path, default=[plant.ROBOT.parents[1]], help="folders with URDF files, at any depth")
    asked.add_argument("--calibrations", type=int, default=2000)
    asked.add_argument("--rows", type=int, default=40)
    asked.add_argument("--workers", type=int, nargs="+", default=[1, 2])
    how = asked.parse_args()
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        files = sorted(path.resolve() for top in how.folders for path in top.rglob("*.urdf"))
        tables = folder / "tables.csv"
        tables.write_text("serial,robot\n" + "".join(f"{number},{path}\n" for number, path in enumerate(files)))
        chain = dn.load(os.fspath(plant.ROBOT)).chain("base", "tool0")
        calibrations = folder / "calibrations.csv"
        with calibrations.open("w") as file:
            file.write("serial,robot,data,effects\n")
            for seed in range(how.calibrations):
                chain.simulate(how.rows, seed=seed).data.save(folder / f"{seed}.csv")
                file.write(f"SN-{seed},{plant.ROBOT},{seed}.csv,none\n")
        print(COLUMNS)
        print("|---|---|---:|---:|---:|---:|---:|")
        works = [(f"tables of {len(files)} files", tables), (f"{how.calibrations} calibrations, {how.rows} rows", calibrations)]
        for engine in ("embedded", "ray"):
            for workers in how.workers:
                if engine == "ray":
                    ray.init(num_cpus=workers, include_dashboard=False, log_to_driver=False)
                    # Workers are begun before, as in a cluster that stands.
                    ray.get([ray.remote(lambda: time.sleep(0.2)).remote() for _ in range(2 * workers)])
                for number, (name, manifest) in enumerate(works):
                    print(row(name, manifest, folder / f"{engine}{workers}{number}", engine, workers), flush=True)
                if engine == "ray":
                    ray.shutdown()


def row(name, manifest, store, engine, workers):
    """One line of the table."""
    begun = time.perf_counter()
    run = dn.fleet.run(manifest, store, engine=engine, threads=workers if engine == "embedded" else 0)
    wall = time.perf_counter() - begun
    ((computing,),) = duckdb.sql(f"select sum(seconds) from '{store}/runs/*.parquet'").fetchall()
    overhead = 1e3 * (wall * workers - computing) / run.done
    return f"| {name} | {engine} | {workers} | {wall:.1f} | {computing:.1f} | {run.done / wall:.0f} | {overhead:.1f} |"


if __name__ == "__main__":
    main()
