"""Every example of a docstring runs."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import denavit

MODULES = [module.name for module in pkgutil.walk_packages(denavit.__path__, "denavit.") if not module.name.endswith("_denavit")]


@pytest.mark.parametrize("name", ["denavit", *MODULES])
def test_examples_of(name: str) -> None:
    found = doctest.testmod(importlib.import_module(name))
    assert found.failed == 0


def test_there_are_examples() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    counts = [len(test.examples) for name in MODULES for test in finder.find(importlib.import_module(name))]
    assert sum(counts) >= 15
