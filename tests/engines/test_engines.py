"""The same run embedded, on Ray and on Dask: workers, nodes and drivers are killed, and every bit of the store is the same."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import denavit as dn
import distributed
import plant
import psutil
import pytest
import ray
from denavit import fleet
from ray.cluster_utils import Cluster

HERE = Path(__file__).resolve().parent
SMALL = {"num_cpus": 1, "object_store_memory": 80 * 1024 * 1024}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("plant")
    plant.make(folder)
    return folder


@pytest.fixture(autouse=True)
def in_the_folder(folder, monkeypatch):
    """Names in the manifest are relative: workers must go where the run was begun."""
    monkeypatch.chdir(folder)


@pytest.fixture(scope="module")
def embedded(folder):
    here = Path.cwd()
    os.chdir(folder)
    try:
        run = dn.fleet.run("plant.csv", "embedded")
    finally:
        os.chdir(here)
    assert (run.entries, run.done, run.failed) == (plant.ROBOTS, plant.ROBOTS, 1) and not run.ok
    found = plant.everything(folder / "embedded")
    assert len(found["runs"]) == plant.ROBOTS and len(found["parameters"]) == 24 * (plant.ROBOTS - 1)
    assert sum(row[-2] == "siblings" and row[-1] > 0 for row in found["runs"]) == plant.LEARNING
    return found


@pytest.fixture(scope="module")
def cluster():
    """Two node processes; workers must not see where the tests run."""
    cluster = Cluster(initialize_head=True, head_node_args=SMALL)
    cluster.add_node(**SMALL)
    yield cluster
    ray.shutdown()
    cluster.shutdown()


@pytest.fixture
def connected(cluster):
    cluster.wait_for_nodes()
    ray.init(address=cluster.address, log_to_driver=False)
    yield cluster
    ray.shutdown()


def working():
    """Processes that compute a job of a run right now, all of them children of this process's cluster."""
    children = psutil.Process().children(recursive=True)
    return [child.pid for child in children if child.status() != "zombie" and "ray::_compute" in " ".join(child.cmdline())]


def test_a_worker_is_killed_and_a_node_is_lost(connected, embedded, folder):
    killed, lost = [], []

    def drama(ended, entries, serial):
        if len(killed) < 2 and ended >= 6 * (len(killed) + 1) and (pids := working()):
            os.kill(pids[0], signal.SIGKILL)
            killed.append(pids[0])
        if not lost and ended >= 20:
            node = next(iter(connected.worker_nodes))
            connected.remove_node(node, allow_graceful=False)
            lost.append(node)
        if len(lost) == 1 and ended >= 30:
            lost.append(connected.add_node(**SMALL))

    run = dn.fleet.run("plant.csv", "on_ray", engine="ray", progress=drama)
    assert len(killed) == 2 and len(lost) == 2
    assert (run.entries, run.done, run.failed, len(run.lost)) == (plant.ROBOTS, plant.ROBOTS, 1, 0)
    assert [failed.serial for failed in run.failures] == ["SN-lost"] and "lost.csv" in run.failures[0].error
    assert plant.everything(folder / "on_ray") == embedded
    again = dn.fleet.run("plant.csv", "on_ray", engine="ray")
    # What failed is tried again.
    assert (again.done, again.known) == (1, plant.ROBOTS - 1)


def test_the_driver_is_killed_and_started_again(cluster, embedded, folder):
    command = [sys.executable, HERE / "driver.py", cluster.address, "of_drivers", "driver.json"]
    random.seed(16)
    kills, finished, store = 0, set(), folder / "of_drivers"
    for _ in range(2):
        enough = len(list(store.glob("runs/*.parquet"))) + random.randint(1, 8)
        running = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while running.poll() is None and len(list(store.glob("runs/*.parquet"))) < enough:
            time.sleep(0.001)
        if running.poll() is None:
            running.kill()
            kills += 1
        running.wait()
        # Nothing is merged before the end, so that a reader misses nothing.
        now = {row[0] for row in plant.everything(store)["runs"]}
        assert finished <= now, "a run that was finished is gone"
        finished = now
    assert kills >= 1, "the run was over before its driver could be killed"
    subprocess.run(command, check=True)
    last = json.loads((folder / "driver.json").read_text(encoding="utf-8"))
    # What failed is tried again, and may be among the finished.
    assert last["known"] >= len(finished) - 1 and last["known"] + last["done"] == plant.ROBOTS
    assert plant.everything(store) == embedded
    assert not list(store.rglob(".denavit-*"))


def test_a_job_whose_workers_die_each_time_is_lost_and_done_by_the_next_run(connected, embedded, folder, monkeypatch):
    # A function of __main__ goes to the workers as it is, not by its name.
    names = {"__name__": "__main__", "compute": fleet._compute}
    exec("def dies(folder, job):\n    import os\n    return os._exit(1) if 'SN-07' in job else compute(folder, job)", names)
    with monkeypatch.context() as patch:
        patch.setattr(fleet, "_compute", names["dies"])
        patch.setattr(fleet, "_TRIES", 1)
        run = dn.fleet.run("plant.csv", "with_a_loss", engine="ray")
    # What siblings know waits for all of them.
    waiting = [f"SN-{robot:02}" for robot in range(plant.LEARNING)]
    assert [entry.serial for entry in run.lost] == ["SN-07", *waiting] and "Ray: " in run.lost[0].error
    assert "its siblings were lost" in run.lost[1].error
    assert run.done == plant.ROBOTS - 1 - plant.LEARNING and not run.ok
    again = dn.fleet.run("plant.csv", "with_a_loss", engine="ray")
    assert (again.done, again.known) == (2 + plant.LEARNING, plant.ROBOTS - 2 - plant.LEARNING)
    assert plant.everything(folder / "with_a_loss") == embedded


def test_a_worker_that_sees_other_files_ends_the_run(connected, folder):
    (folder / "changed.csv").write_text((folder / "0.csv").read_text())
    lines = (folder / "plant.csv").read_text().splitlines()
    (folder / "changed_plant.csv").write_text("\n".join([*lines[:-2], lines[-2].replace("0.csv", "changed.csv")]))

    def change(ended, entries, serial):
        if ended == 1:
            (folder / "changed.csv").write_text((folder / "1.csv").read_text())

    with pytest.raises(dn.StoreError, match="its files differ from those at the start of the run"):
        dn.fleet.run("changed_plant.csv", "changed", engine="ray", progress=change)
    # The store is free again, and what was finished is in it.
    run = dn.fleet.run("changed_plant.csv", "changed", engine="embedded")
    assert run.known > 0 and run.ok


def test_dask_with_a_worker_that_is_killed(embedded, folder):
    killed = []
    local = distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)
    with local, distributed.Client(local):
        pids = [worker.pid for worker in local.workers.values()]

        def drama(ended, entries, serial):
            if not killed and ended >= 10:
                os.kill(pids[0], signal.SIGKILL)
                killed.append(pids[0])

        run = dn.fleet.run("plant.csv", "on_dask", engine="dask", progress=drama)
    assert killed and (run.done, run.failed, len(run.lost)) == (plant.ROBOTS, 1, 0)
    assert plant.everything(folder / "on_dask") == embedded
