"""The progress of a calibration, shown below a notebook's cell or on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module

SENTENCES = {
    "geometry": "fitting the geometry",
    "effects": "searching for effects",
    "curves": "fitting error curves of the joints",
    "judgement": "judging on rows held out",
}


@contextmanager
def shown() -> Iterator[Callable[[str], object] | None]:
    """A function that shows its argument and removes it at the end; ``None`` outside interactive sessions."""
    if (cell := _cell()) is not None:
        yield cell
        cell("")
    elif sys.stderr is not None and sys.stderr.isatty():
        yield lambda stage: print(f"\r\033[K{SENTENCES.get(stage, stage)}", end="", file=sys.stderr, flush=True)
        print("\r\033[K", end="", file=sys.stderr, flush=True)
    else:
        yield None


def _cell() -> Callable[[str], object] | None:
    """Below the cell of a notebook."""
    if "IPython" not in sys.modules:
        return None
    shell = import_module("IPython").get_ipython()
    if shell is None or type(shell).__name__ != "ZMQInteractiveShell":
        return None
    line = import_module("IPython.display").display({"text/plain": ""}, raw=True, display_id=True)
    return lambda stage: line.update({"text/plain": SENTENCES.get(stage, stage)}, raw=True)
