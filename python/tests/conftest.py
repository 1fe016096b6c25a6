"""Where the robots are, and what the tests share."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path

import pytest

import denavit as dn

TOP = Path(__file__).resolve().parents[2]


@pytest.fixture(autouse=True)
def at_the_top(monkeypatch: pytest.MonkeyPatch) -> None:
    """Paths of the examples are relative to the repository."""
    monkeypatch.chdir(TOP)


@pytest.fixture
def ctrl_c() -> Iterator[None]:
    """Ctrl-C raises KeyboardInterrupt: it is switched off in a program that was started in the background."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def ur5e() -> dn.Robot:
    return dn.load(os.fspath(TOP / "robots/universal_robots/ur5e.urdf"))


@pytest.fixture(scope="session")
def chain(ur5e: dn.Robot) -> dn.Chain:
    return ur5e.chain("base", "tool0")
