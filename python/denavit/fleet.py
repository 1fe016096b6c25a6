"""Many robots, many nights: a manifest into a store of Parquet files, on this machine, on Ray or on Dask."""

from __future__ import annotations

import json
import os
import time
from collections.abc import Callable, Generator, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from itertools import islice
from pathlib import Path
from typing import Any, Literal

from denavit import _denavit
from denavit._given import whole
from denavit.errors import ArgumentError, DenavitError
from denavit.progress import shown
from denavit.records import Records

__all__ = ["Failed", "Run", "run"]


def __dir__() -> list[str]:
    return [*__all__, "__doc__", "__file__", "__name__"]


_TRIES = 5
"""How often a job whose worker or node is lost is restarted."""

_AHEAD = 2
"""Jobs that an engine holds for each core, so that none waits for this process."""

_Found = tuple[list[tuple[str, bytes]], str | None]


@dataclass(frozen=True, slots=True)
class Failed:
    """An entry of a manifest that has no result.

    Attributes:
        serial: The robot.
        date: The night, ``2026-11-22``; ``None`` where the manifest names none.
        task: ``calibrate``, ``table``, ``check``, ``fingerprint`` or ``diff``.
        error: Why.
    """

    serial: str
    date: str | None
    task: str
    error: str


@dataclass(frozen=True, slots=True)
class Run:
    """What a run over a fleet did; the counts are those of ``denavit fleet run --json``.

    Attributes:
        store: Folder of the store.
        entries: Entries of the manifest.
        done: Computed now.
        known: Found in the store.
        failed: Rows with an error among those computed now.
        replaced: Runs of older inputs or options that were removed from the store.
        failures: The rows with an error.
        lost: Entries whose workers died each time: the store has no result of them, and the next run repeats them.
    """

    store: Path
    entries: int
    done: int
    known: int
    failed: int
    replaced: int
    failures: Records[Failed]
    lost: Records[Failed]

    @property
    def ok(self) -> bool:
        """Whether every entry has its result, now or from before, as far as this run has seen."""
        return not self.failed and not self.lost


def run(
    manifest: str | os.PathLike[str],
    store: str | os.PathLike[str],
    *,
    engine: Literal["embedded", "ray", "dask"] = "embedded",
    set: Mapping[str, object] | None = None,  # noqa: A002
    threads: int = 0,
    progress: Callable[[int, int, str], object] | None = None,
) -> Run:
    """Run a manifest over all its robots, and store the results.

    Store and keys are those of ``denavit fleet run``, and so is every number to the bit, whatever the engine and however many
    workers there are; only ``seconds`` differs. Finished work is not repeated. Only this process writes the store;
    it may be stopped or killed at any moment and continues when it is called again.

    With ``"ray"`` and ``"dask"`` every worker must see the files of the manifest under the same names as this process, and have
    the same version of denavit; the key of each job checks this. Only this machine uses the store's folder. A
    job whose worker or node is lost is restarted on another, five times on Ray, ``distributed.scheduler.allowed-failures``
    times on Dask.

    Args:
        manifest: A CSV or TOML file, or a pattern of folders such as ``nights/{serial}/{date}.csv``.
        store: Folder of the store, made where there is none.
        engine: ``"embedded"``, threads of this process; ``"ray"``, the cluster that ``ray.init`` has connected to, else that of
            ``RAY_ADDRESS``, else one on this machine; ``"dask"``, the last ``distributed.Client``, else one on this machine.
        set: Settings of the manifest for every entry that does not state its own, such as ``{"effects": "none"}``.
        threads: Of the embedded engine; 0 takes every core.
        progress: Called with the number of finished entries, the total, and the robot. An exception that it raises stops the
            run off.

    Raises:
        ManifestError: The manifest is invalid.
        StoreError: The store cannot be written, another run holds it, or a worker sees other files than this process.
    """
    words = [(str(name), str(value)) for name, value in (set or {}).items()]
    with _reported(progress) as tell:
        if engine == "embedded":
            return _run(_denavit.fleet_run(os.fspath(manifest), words, Path(store), whole("threads", threads), tell))
        if engine not in _ENGINES:
            raise ArgumentError(f'engine is "{engine}"; write "embedded", "ray" or "dask"')
        if threads:
            raise ArgumentError(f'threads is {threads}; with engine="{engine}" the cluster sets how many jobs run at a time')
        deal = _ENGINES[engine]()
        ledger = _denavit.FleetLedger(os.fspath(manifest), words, Path(store))
        try:
            return _dealt(ledger, deal, tell)
        finally:
            ledger.leave()


_Results = Generator[tuple[int, _Found | DenavitError | str], None, None]
"""The index of each job, and its result, its error, or the reason in words why it has no result."""

_Deal = Callable[[list[str]], _Results]
"""Hands jobs to an engine."""


def _dealt(ledger: _denavit.FleetLedger, deal: _Deal, tell: Callable[[int, int, str], object] | None) -> Run:
    lost: list[Failed] = []
    ended = 0

    def through(jobs: list[tuple[str, str | None, str, str]]) -> None:
        nonlocal ended
        found_by = deal([job for *_, job in jobs])
        try:
            for index, found in found_by:
                serial, date, task, _ = jobs[index]
                if isinstance(found, DenavitError):
                    raise found
                if isinstance(found, str):
                    lost.append(Failed(serial, date, task, found))
                else:
                    ledger.keep(index, *found)
                ended += 1
                if tell is not None:
                    tell(ended, ledger.entries, serial)
        finally:
            found_by.close()

    # What continues from siblings waits until every robot that is calibrated by itself has been.
    jobs, later = ledger.jobs(), ledger.later()
    ended = ledger.entries - len(jobs) - len(later)
    through(jobs)
    if later and lost:
        why = "calibrations of its siblings were lost; run it again"
        lost.extend(Failed(serial, date, task, why) for serial, date, task in later)
    elif later:
        ledger.resume()
        jobs = ledger.jobs()
        ended = ledger.entries - len(jobs)
        through(jobs)
    return _run(ledger.close(), lost)


def _run(report: str, lost: list[Failed] | None = None) -> Run:
    said: dict[str, Any] = json.loads(report)
    failures = Records(Failed(one["serial"], one.get("date"), one["task"], one["error"]) for one in said.pop("failures"))
    return Run(Path(said.pop("store")), failures=failures, lost=Records(lost or ()), **said)


def _compute(folder: str, job: str) -> _Found | DenavitError:
    """Runs in a worker. Errors are returned, not raised: engines wrap exceptions, or restart."""
    if Path.cwd() != Path(folder):
        try:
            os.chdir(folder)
        except OSError as why:
            return ArgumentError(f"{folder}: a worker cannot change to this folder, in which the run was started: {why.strerror}")
    try:
        return _denavit.fleet_compute(job)
    except DenavitError as wrong:
        return wrong


def _ray() -> _Deal:
    ray = _imported("ray")

    def deal(jobs: list[str]) -> _Results:
        begun = not ray.is_initialized()
        if begun:
            ray.init(log_to_driver=False)
        compute = ray.remote(num_cpus=1, max_retries=_TRIES)(_compute)
        cores = _Cores(lambda: int(ray.cluster_resources().get("CPU", 1)))
        left, folder = iter(enumerate(jobs)), os.fspath(Path.cwd())
        waiting: dict[Any, int] = {}
        try:
            while True:
                for index, job in islice(left, max(0, _AHEAD * cores.count() + _AHEAD - len(waiting))):
                    waiting[compute.remote(folder, job)] = index
                if not waiting:
                    return
                ready, _ = ray.wait(list(waiting), num_returns=1)
                for found in ready:
                    index = waiting.pop(found)
                    try:
                        result = ray.get(found)
                    except ray.exceptions.RayError as why:
                        result = f"Ray: {why}".strip()
                    yield index, result
        finally:
            for found in waiting:
                ray.cancel(found, force=True)
            if begun:
                ray.shutdown()

    return deal


def _dask() -> _Deal:
    distributed = _imported("distributed")

    def deal(jobs: list[str]) -> _Results:
        try:
            client, begun = distributed.default_client(), False
        except ValueError:
            client, begun = distributed.Client(dashboard_address=None), True
        cores = _Cores(lambda: sum(client.nthreads().values()))
        left, folder = iter(enumerate(jobs)), os.fspath(Path.cwd())
        waiting: dict[Any, int] = {}
        ended = distributed.as_completed()
        try:
            while True:
                for index, job in islice(left, max(0, _AHEAD * cores.count() + _AHEAD - len(waiting))):
                    future = client.submit(_compute, folder, job, pure=False)
                    waiting[future] = index
                    ended.add(future)
                if not waiting:
                    return
                future = next(ended)
                index, why = waiting.pop(future), future.exception()
                yield index, future.result() if why is None else f"Dask: {why}"
        finally:
            client.cancel(list(waiting))
            if begun:
                client.close()

    return deal


_ENGINES: dict[str, Callable[[], _Deal]] = {"ray": _ray, "dask": _dask}


class _Cores:
    """How many cores a cluster has, asked once a second: nodes come and go."""

    def __init__(self, ask: Callable[[], int]) -> None:
        self._ask, self._asked, self._count = ask, -1.0, 1

    def count(self) -> int:
        if (now := time.monotonic()) - self._asked > 1:
            self._count, self._asked = max(1, self._ask()), now
        return self._count


def _imported(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError as why:
        engine = {"distributed": "dask"}.get(name, name)
        raise ArgumentError(f'engine="{engine}" needs the package {name}; pip install "denavit[{engine}]"') from why


@contextmanager
def _reported(called: Callable[[int, int, str], object] | None) -> Iterator[Callable[[int, int, str], object] | None]:
    """The progress function for each entry that ends: the caller's, else a line in an interactive session."""
    if called is not None:
        yield called
        return
    with shown() as show:
        yield None if show is None else lambda ended, entries, serial: show(f"{ended} of {entries}, {serial}")
