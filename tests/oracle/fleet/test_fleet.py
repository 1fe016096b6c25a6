"""A fleet's store, read by DuckDB: the result of `calibrate` for each robot, once, however often the run was killed."""

import json
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

import built  # noqa: E402

duckdb = pytest.importorskip("duckdb", reason="skipped, because DuckDB is not installed (tests/oracle/environment)")

ROBOT = built.WORKSPACE / "robots/universal_robots/ur5e.urdf"
TABLES = ["runs", "parameters", "effects", "curves", "residuals", "notes", "axes", "information"]
ROBOTS = 40


def denavit(*words, codes=(0,)):
    run = subprocess.run([built.denavit(), *map(str, words)], capture_output=True, text=True, timeout=300)
    assert run.returncode in codes, f"{words}: exit code {run.returncode}\n{run.stdout}{run.stderr}"
    return run.stdout


def rows(store, table):
    """Every row of a table without the computing time; none if it has no file."""
    if not list((store / table).glob("*.parquet")):
        return []
    columns = "* exclude (seconds)" if table == "runs" else "*"
    return duckdb.sql(f"select {columns} from '{store}/{table}/*.parquet' order by all").fetchall()


def everything(store):
    return {table: rows(store, table) for table in TABLES}


@pytest.fixture(scope="module")
def plant(tmp_path_factory):
    """A folder with the measurements of forty robots and a manifest; one robot's file is missing."""
    folder = tmp_path_factory.mktemp("plant")
    lines = ["serial,robot,data,date,event"]
    for serial in range(4):
        denavit("simulate", ROBOT, "--rows", 40, "--seed", serial, "-o", folder / f"{serial}.csv")
    for serial in range(ROBOTS):
        # Four sets of measurements, each for ten robots: keys differ by serial.
        lines.append(f"SN-{serial:03},{ROBOT},{serial % 4}.csv,2026-11-{1 + serial % 28:02},")
    lines.append(f"SN-lost,{ROBOT},lost.csv,2026-11-01,collision")
    (folder / "plant.csv").write_text("\n".join(lines) + "\n")
    return folder


@pytest.fixture(scope="module")
def uninterrupted(plant):
    denavit("fleet", "run", plant / "plant.csv", "--set", "effects=none", "-o", plant / "store", codes=(1,))
    return plant / "store"


def test_the_store_says_what_calibrate_says(plant, uninterrupted):
    report = json.loads(denavit("calibrate", ROBOT, "--data", plant / "2.csv", "--effects", "none", "--json"))
    found = duckdb.sql(
        f"select joint || '.' || parameter, value, std, half_interval_95, unit from '{uninterrupted}/parameters/*.parquet' "
        "where serial = 'SN-002'"
    ).fetchall()
    said = [(p["parameter"], p["change"], p["std"], p["half_interval_95"], p["unit"]) for p in report["parameters"]]
    assert sorted(found) == sorted(said) and len(said) == 24
    residuals = duckdb.sql(
        f"select line, x, y, z from '{uninterrupted}/residuals/*.parquet' where serial = 'SN-002' order by line"
    ).fetchall()
    assert residuals == [(row["line"], *row["residual_m"]) for row in report["rows"]]
    (run,) = duckdb.sql(
        f"select date::text, ok, rms, rows_fitted from '{uninterrupted}/runs/*.parquet' where serial = 'SN-002'"
    ).fetchall()
    adopted = next(stage for stage in report["stages"] if stage["adopted"])
    assert run == ("2026-11-03", True, adopted["train"]["position_rms_m"], report["samples"]["train"])


def test_a_bad_robot_is_a_row_with_its_error(uninterrupted):
    failed = duckdb.sql(
        f"select serial, event, error from '{uninterrupted}/runs/*.parquet' where not ok"
    ).fetchall()
    assert [(serial, event) for serial, event, _ in failed] == [("SN-lost", "collision")]
    assert "lost.csv" in failed[0][2]
    (count,) = duckdb.sql(f"select count(*) from '{uninterrupted}/runs/*.parquet'").fetchall()[0]
    assert count == ROBOTS + 1


def test_finished_work_is_not_done_again_and_threads_change_no_bit(plant, uninterrupted):
    # Failures are tried again, on a copy of the store that the other tests read.
    shutil.copytree(uninterrupted, plant / "again")
    again = denavit("fleet", "run", plant / "plant.csv", "--set", "effects=none", "-o", plant / "again", codes=(1,))
    assert "1 done now, 40 done before, 1 failed" in again
    denavit("fleet", "run", plant / "plant.csv", "--set", "effects=none", "--threads", 1, "-o", plant / "one", codes=(1,))
    assert everything(plant / "one") == everything(uninterrupted)


def test_effects_are_the_same_to_the_bit_on_any_number_of_threads(tmp_path):
    data = tmp_path / "data.csv"
    denavit("simulate", ROBOT, "--rows", 80, "--seed", 5, "--effect", "joint_compliance@elbow_joint=0.5mm", "-o", data)
    manifest = tmp_path / "plant.csv"
    manifest.write_text(f"serial,robot,data\nA,{ROBOT},data.csv\nB,{ROBOT},data.csv\n")
    for threads in (1, 2):
        denavit("fleet", "run", manifest, "--threads", threads, "-o", tmp_path / f"store{threads}")
    assert everything(tmp_path / "store1") == everything(tmp_path / "store2")
    report = json.loads(denavit("calibrate", ROBOT, "--data", data, "--json"))
    said = {(e["kind"], e.get("joint"), p["value"]) for e in report["effects"] for p in e["parameters"].values()}
    found = duckdb.sql(f"select kind, place, value from '{tmp_path}/store1/effects/*.parquet' where serial = 'A'").fetchall()
    assert said and set(found) == said


def test_killed_at_any_moment_nothing_is_lost_and_nothing_twice(plant, uninterrupted):
    store = plant / "killed"
    command = [built.denavit(), "fleet", "run", plant / "plant.csv", "--set", "effects=none", "-o", store]
    random.seed(16)
    kills, finished = 0, set()
    for _ in range(40):
        running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        # After a few robots, however fast this machine is; sometimes before the first.
        enough = len(list(store.glob("runs/*.parquet"))) + random.randint(0, 6)
        while running.poll() is None and len(list(store.glob("runs/*.parquet"))) < enough:
            time.sleep(0.001)
        time.sleep(random.uniform(0, 0.01))
        if running.poll() is not None:
            break
        running.send_signal(signal.SIGKILL)
        running.wait()
        kills += 1
        # The next run completes a merge that was killed; until then a reader misses rows.
        if store.exists() and not (store / ".merge.json").exists():
            now = {row[0] for row in rows(store, "runs")}
            assert finished <= now, "a run that was finished is gone"
            finished = now
    assert kills >= 3, "the run was over before it could be killed"
    denavit(*command[1:], codes=(0, 1))
    assert everything(store) == everything(uninterrupted)
    hidden = [path for path in store.rglob(".denavit-*")]
    assert not hidden, hidden


def test_a_merge_that_was_begun_is_ended(plant, uninterrupted, tmp_path):
    """The journal is written, some of the old files are removed, and the new one does not have its name yet."""
    store = tmp_path / "store"
    shutil.copytree(uninterrupted, store)
    (merged,) = (store / "runs").glob("rows-*.parquet")
    key = "0" * 64
    old = store / "runs" / f"{key}.parquet"
    shutil.copy(merged, old)
    hidden = merged.with_name(".denavit-half")
    merged.rename(hidden)
    gone = f"runs/{'1' * 64}.parquet"
    plan = {"remove": [gone, f"runs/{old.name}"], "rename": [[f"runs/{hidden.name}", f"runs/{merged.name}"]]}
    (store / ".merge.json").write_text(json.dumps(plan))
    again = denavit("fleet", "run", plant / "plant.csv", "--set", "effects=none", "-o", store, codes=(1,))
    assert "1 done now, 40 done before, 1 failed" in again
    assert everything(store) == everything(uninterrupted)
    assert not (store / ".merge.json").exists()


def test_newer_data_replace_the_older_of_their_night(plant, tmp_path):
    shutil.copy(plant / "0.csv", tmp_path / "a.csv")
    manifest = tmp_path / "plant.toml"
    manifest.write_text(
        f'[defaults]\nrobot = "{ROBOT}"\neffects = "none"\n'
        '[[robots]]\nserial = "A"\ndata = "a.csv"\ndate = "2026-11-21"\n'
        '[[robots]]\nserial = "B"\ndata = "a.csv"\ndate = "2026-11-21"\n'
    )
    store = tmp_path / "store"
    denavit("fleet", "run", manifest, "-o", store)
    before = everything(store)
    shutil.copy(plant / "1.csv", tmp_path / "a.csv")
    assert "2 runs of older inputs" in denavit("fleet", "run", manifest, "-o", store)
    after = everything(store)
    assert len(after["runs"]) == 2 and len(after["parameters"]) == len(before["parameters"])
    assert after["parameters"] != before["parameters"]


def test_a_pattern_of_folders(plant, tmp_path):
    for serial in ("A", "B"):
        (tmp_path / serial).mkdir()
        for night in ("2026-11-20", "2026-11-21"):
            shutil.copy(plant / "0.csv", tmp_path / serial / f"{night}.csv")
    pattern = f"{tmp_path}/{{serial}}/{{date}}.csv"
    denavit("fleet", "run", pattern, "--set", f"robot={ROBOT}", "--set", "effects=none", "-o", tmp_path / "store")
    found = duckdb.sql(f"select serial, date::text from '{tmp_path}/store/runs/*.parquet' order by all").fetchall()
    assert found == [(s, d) for s in ("A", "B") for d in ("2026-11-20", "2026-11-21")]


def test_every_task_has_its_rows(tmp_path):
    longer = tmp_path / "longer.urdf"
    longer.write_text(ROBOT.read_text().replace("-0.425", "-0.427"))
    manifest = tmp_path / "plant.csv"
    lines = ["serial,robot,task,against"] + [f"A,{longer},{task}," for task in ("table", "check", "fingerprint")]
    lines.append(f"A,{longer},diff,{ROBOT}")
    manifest.write_text("\n".join(lines) + "\n")
    store = tmp_path / "store"
    denavit("fleet", "run", manifest, "-o", store)
    verdicts = dict(duckdb.sql(f"select task, verdict from '{store}/runs/*.parquet'").fetchall())
    assert verdicts["diff"] == "different"
    prints = duckdb.sql(f"select distinct fingerprint from '{store}/runs/*.parquet' where fingerprint is not null").fetchall()
    assert prints == [(denavit("fingerprint", longer).strip(),)]
    (a,) = duckdb.sql(
        f"select value from '{store}/parameters/*.parquet' where task = 'table' and parameter = 'a' and value < -0.4"
    ).fetchall()[0]
    assert a == -0.427
    (moved,) = duckdb.sql(f"select max(value) from '{store}/notes/*.parquet' where code = 'tip'").fetchall()[0]
    assert abs(moved - 0.002) < 1e-6


@pytest.mark.parametrize("text, said", [
    ("serial,robot,data\nA,arm.urdf,a.csv,x\n", "plant.csv:2: "),
    ("serial,robot,dat\nA,arm.urdf,a.csv\n", "\"dat\" is not a manifest key"),
    ("serial,robot,date\nA,arm.urdf,22.11.2026\n", "plant.csv:2: \"22.11.2026\" is not a date"),
    ("serial,robot,task\nA,arm.urdf,calibrate\n", "plant.csv:2: there are no data"),
    ("serial,robot,task\nA,arm.urdf,dance\n", "plant.csv:2: task \"dance\" is unknown"),
    ("serial,robot,hold_out,data\nA,arm.urdf,1.5,a.csv\n", "plant.csv:2: hold_out is a fraction"),
    ("serial,robot\n", "it names no robot"),
    ("robot\narm.urdf\n", "plant.csv:2: serial is missing"),
])
def test_a_manifest_that_is_none_is_refused(tmp_path, text, said):
    manifest = tmp_path / "plant.csv"
    manifest.write_text(text)
    run = subprocess.run([built.denavit(), "fleet", "run", manifest, "-o", tmp_path / "store"], capture_output=True, text=True)
    assert run.returncode == 2 and said in run.stderr, run.stderr
    assert not (tmp_path / "store").exists()


def test_two_runs_do_not_write_one_store(plant, tmp_path):
    store = tmp_path / "store"
    command = [built.denavit(), "fleet", "run", plant / "plant.csv", "--set", "effects=none", "-o", store]
    first = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 20
    while not (store / ".lock").exists() and time.monotonic() < deadline:
        time.sleep(0.005)
    time.sleep(0.02)
    second = subprocess.run(command, capture_output=True, text=True)
    first.wait()
    assert second.returncode == 2 and "another run is writing to this store" in second.stderr


def test_the_page_shows_the_tables_of_the_store(uninterrupted):
    page = (built.WORKSPACE / "docs/fleet-store.md").read_text()
    for table in TABLES:
        described = duckdb.sql(f"describe select * from '{uninterrupted}/{table}/*.parquet'").fetchall() if rows(
            uninterrupted, table) else []
        for name, kind, *_ in described:
            kind = {"VARCHAR": "text", "BIGINT": "int64"}.get(kind, kind.lower())
            assert re.search(rf"^- `{name}` {kind}[,:]", page, re.M), f"{table}.{name} {kind}"


WRITTEN = {
    "as it likes": ("*", ""),
    "small groups": ("*", ", row_group_size 2048, compression zstd"),
    "version 2": ("*", ", parquet_version v2"),
    "as pandas keeps them": ("* replace ({})", ", compression uncompressed"),
}
# Dates as timestamps, integers as floating point if some are missing; otherwise small integers.
OF_PANDAS = {"date": "date::timestamp", "rows_fitted": "rows_fitted::double", "line": "line::integer"}


@pytest.mark.parametrize("how", WRITTEN)
def test_a_store_that_duckdb_rewrote_is_the_same_store(uninterrupted, tmp_path, how):
    """All files of a table in one, in any form: every command gives the same result, and finds the work done."""
    store = tmp_path / "store"
    columns, options = WRITTEN[how]
    encodings = set()
    for table in TABLES:
        (store / table).mkdir(parents=True)
        if not rows(uninterrupted, table):
            continue
        source, target = f"'{uninterrupted}/{table}/*.parquet'", f"'{store}/{table}/all.parquet'"
        here = [name for name, *_ in duckdb.sql(f"describe select * from {source}").fetchall()]
        chosen = columns.format(", ".join(f"{form} as {name}" for name, form in OF_PANDAS.items() if name in here))
        duckdb.sql(f"copy (select {chosen} from {source}) to {target} (format parquet{options})")
        encodings |= set(duckdb.sql(f"select encodings, compression from parquet_metadata({target})").fetchall())
        required = duckdb.sql(f"select count(*) from parquet_schema({target}) where repetition_type = 'REQUIRED'")
        assert required.fetchall()[0][0] > 4, "no column without empty cells"
    print(encodings)
    for words in (["watch"], ["siblings", "--json"], ["history", "SN-002"]):
        command, *more = words
        told = [denavit("fleet", command, folder, *more, codes=(0, 1)) for folder in (uninterrupted, store)]
        assert told[0] == told[1] and told[0]
    pages = [tmp_path / "before", tmp_path / "after"]
    for folder, page in zip((uninterrupted, store), pages, strict=True):
        denavit("fleet", "report", folder, "-o", page)
    assert [p.read_text() for p in sorted(pages[0].rglob("*.html"))] == [p.read_text() for p in sorted(pages[1].rglob("*.html"))]
    before = everything(store)
    assert how == "as pandas keeps them" or before == everything(uninterrupted)


def test_work_that_is_in_a_rewritten_store_is_not_done_again(plant, uninterrupted, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(uninterrupted, store)
    for table in ("runs", "parameters"):
        source = f"'{store}/{table}/*.parquet'"
        duckdb.sql(f"copy (select * from {source}) to '{tmp_path}/{table}.parquet' (format parquet)")
        for old in (store / table).glob("*.parquet"):
            old.unlink()
        shutil.move(tmp_path / f"{table}.parquet", store / table / "mine.parquet")
    # One more robot: its rows are merged with those of DuckDB.
    more = (plant / "plant.csv").read_text() + f"SN-more,{ROBOT},0.csv,2026-11-02,\n"
    (plant / "more.csv").write_text(more)
    again = denavit("fleet", "run", plant / "more.csv", "--set", "effects=none", "-o", store, codes=(1,))
    assert "2 done now, 40 done before, 1 failed" in again
    kept = [row for row in rows(store, "parameters") if row[1] != "SN-more"]
    assert kept == rows(uninterrupted, "parameters")


def test_a_column_of_another_kind_is_named(uninterrupted, tmp_path):
    store = tmp_path / "store"
    shutil.copytree(uninterrupted, store)
    (old,) = (store / "parameters").glob("*.parquet")
    duckdb.sql(f"copy (select * replace (unit as value) from '{old}') to '{store}/parameters/other.parquet' (format parquet)")
    run = subprocess.run([built.denavit(), "fleet", "watch", store], capture_output=True, text=True)
    assert run.returncode == 2
    assert 'other.parquet: this is not a file of a fleet store: column "value": ' in run.stderr, run.stderr
    assert "it does not hold double" in run.stderr
