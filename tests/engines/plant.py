"""Measurements of some robots, a manifest of them, and what stands in a store."""

from pathlib import Path

import denavit as dn
import duckdb

ROBOT = Path(__file__).resolve().parents[2] / "robots/universal_robots/ur5e.urdf"
TABLES = ["runs", "parameters", "effects", "curves", "residuals", "notes", "axes", "information"]
ROBOTS = 48
LEARNING = 4
"""Robots that go on from their siblings, once all others are calibrated."""


def make(folder: Path) -> Path:
    """Forty-eight robots of two sets of measurements, one of them lost; some go on from their siblings; paths are relative to the
    working directory."""
    chain = dn.load(str(ROBOT)).chain("base", "tool0")
    for seed in range(2):
        chain.simulate(120, seed=seed).data.save(folder / f"{seed}.csv")
    lines = ["serial,robot,data,date,event,effects,prior"]
    lines += [f"SN-{robot:02},{ROBOT},{robot % 2}.csv,2026-11-{1 + robot % 28:02},,none,{'siblings' * (robot < LEARNING)}" for robot in range(ROBOTS - 1)]
    lines += [f"SN-lost,{ROBOT},lost.csv,2026-11-01,collision,none,"]
    (folder / "plant.csv").write_text("\n".join(lines) + "\n")
    return folder / "plant.csv"


def everything(store: Path) -> dict[str, list[tuple[object, ...]]]:
    """Every row of every table but for the computing time."""
    found = {}
    for table in TABLES:
        columns = "* exclude (seconds)" if table == "runs" else "*"
        files = f"'{store}/{table}/*.parquet'"
        any_file = list((store / table).glob("*.parquet"))
        found[table] = duckdb.sql(f"select {columns} from {files} order by all").fetchall() if any_file else []
    assert len(found["runs"]) == len({row[0] for row in found["runs"]}), "a run is there twice"
    return found
