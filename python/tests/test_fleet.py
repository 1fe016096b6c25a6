"""A fleet in this process, and what is refused; Ray and Dask have tests of their own (tests/engines)."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

import denavit as dn

TOP = Path(__file__).resolve().parents[2]
ROBOT = TOP / "robots/universal_robots/ur5e.urdf"


@pytest.fixture
def manifest(tmp_path: Path, chain: dn.Chain) -> Path:
    chain.simulate(40, seed=3).data.save(tmp_path / "data.csv")
    lines = ["serial,robot,data", *(f"SN-{robot},{ROBOT},data.csv" for robot in range(6)), f"SN-lost,{ROBOT},lost.csv"]
    path = tmp_path / "plant.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def test_the_store_says_what_calibrate_says(manifest: Path, chain: dn.Chain) -> None:
    told: list[tuple[int, int, str]] = []
    store = manifest.parent / "store"
    run = dn.fleet.run(manifest, store, set={"effects": "none"}, progress=lambda *words: told.append(words))
    assert (run.store, run.entries, run.done, run.known, run.failed, run.replaced) == (store, 7, 7, 0, 1, 0)
    assert [(one.serial, one.date, one.task) for one in run.failures] == [("SN-lost", None, "calibrate")] and not run.ok
    assert [(ended, entries) for ended, entries, _ in told] == [(k, 7) for k in range(1, 8)]
    assert {serial for *_, serial in told} == {*(f"SN-{robot}" for robot in range(6)), "SN-lost"}
    duckdb = pytest.importorskip("duckdb", reason="skipped, because DuckDB is not installed")
    of_one = f"select joint, parameter, value from '{store}/parameters/*.parquet' where serial = 'SN-4'"
    stored = {(joint, name): value for joint, name, value in duckdb.sql(of_one).fetchall()}
    fit = dn.calibrate(chain, dn.Measurements.read(manifest.parent / "data.csv"), effects=None)
    assert stored == {(one.joint, one.name.split(".")[-1]): one.change for one in fit.parameters}
    again = dn.fleet.run(manifest, store, set={"effects": "none"}, threads=1)
    # What failed is tried again.
    assert (again.done, again.known, again.ok) == (1, 6, False)


def test_an_interrupted_run_is_continued(manifest: Path) -> None:
    def enough(ended: int, entries: int, serial: str) -> None:
        raise KeyError(serial)

    store = manifest.parent / "store"
    with pytest.raises(KeyError):
        dn.fleet.run(manifest, store, set={"effects": "none"}, threads=1, progress=enough)
    run = dn.fleet.run(manifest, store, set={"effects": "none"})
    assert 0 < run.known < 7 and run.known + run.done == 7


def test_ctrl_c_ends_it_within_a_second_and_lets_go_of_the_store(manifest: Path, ctrl_c: None) -> None:
    store = manifest.parent / "store"
    begun = time.monotonic()
    # Effects of many robots: seconds of work on one thread.
    manifest.write_text("serial,robot,data,seed\n" + "".join(f"SN-{n},{ROBOT},data.csv,{n}\n" for n in range(100)))
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        dn.fleet.run(manifest, store, threads=1)
    assert time.monotonic() - begun < 1.3
    timer.join()
    assert dn.fleet.run(manifest, store, set={"effects": "none", "task": "table"}, threads=1).entries == 100


def test_what_cannot_be_run_is_refused(manifest: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = manifest.parent / "store"
    with pytest.raises(dn.ManifestError, match='set=: "dance" is not a manifest key'):
        dn.fleet.run(manifest, store, set={"dance": "yes"})
    with pytest.raises(dn.ReadError):
        dn.fleet.run("nothing.csv", store)
    with pytest.raises(dn.ArgumentError, match='write "embedded", "ray" or "dask"'):
        dn.fleet.run(manifest, store, engine="spark")  # type: ignore[arg-type]
    with pytest.raises(dn.ArgumentError, match="threads is 2"):
        dn.fleet.run(manifest, store, engine="ray", threads=2)
    for name, package in (("ray", "ray"), ("dask", "distributed")):
        monkeypatch.setitem(sys.modules, package, None)
        with pytest.raises(dn.ArgumentError, match=rf'needs the package {package}; pip install "denavit\[{name}\]"'):
            dn.fleet.run(manifest, store, engine=name)  # type: ignore[arg-type]
    assert not store.exists()


def test_a_store_that_another_process_writes_is_left_alone(manifest: Path) -> None:
    store = manifest.parent / "store"
    hold = f"held = denavit._denavit.FleetLedger({os.fspath(manifest)!r}, [], pathlib.Path({os.fspath(store)!r}))"
    words = [sys.executable, "-c", f"import denavit, pathlib; {hold}; print(1, flush=True); input()"]
    with subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as other:
        assert other.stdout and other.stdout.readline() == "1\n"
        with pytest.raises(dn.StoreError, match="another run is writing to this store"):
            dn.fleet.run(manifest, store)
        other.kill()
    assert dn.fleet.run(manifest, store, set={"effects": "none"}).entries == 7
