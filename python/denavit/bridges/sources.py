"""Objects of other packages, and plain Python values, as text that `load` reads."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Mapping
from numbers import Integral
from pathlib import Path
from typing import Any

from denavit import _denavit
from denavit.errors import ArgumentError

COLUMNS = ("row", "joint", "kind", "theta", "d", "alpha", "a", "beta", "pitch", "scale")


def text_of(source: Any, file: str | None, convention: str | None) -> tuple[str, str]:
    """What messages call a source, and its text."""
    if isinstance(source, bytes | bytearray | memoryview):
        name = file or "<bytes>"
        try:
            return name, bytes(source).decode("utf-8")
        except UnicodeDecodeError as error:
            raise ArgumentError(f"{name}: not UTF-8 text; decode it first", file=name) from error
    if isinstance(source, str) and _is_text(source):
        return file or "<text>", source
    if isinstance(source, str | os.PathLike):
        name = os.fspath(source)
        if isinstance(name, str):
            return _named(name, file)
    if (urdf := _urdf_of(source)) is not None:
        return file or type(source).__module__.partition(".")[0], urdf
    rows = _rows_of(source)
    if rows is None:
        raise ArgumentError(
            f"a {type(source).__name__} is no robot; give a path, text, bytes, a D-H table, or a robot of yourdfpy or urchin"
        )
    return file or "table.csv", _table(rows, convention)


def _is_text(source: str) -> bool:
    return "\n" in source or source.lstrip("\ufeff \t").startswith(("<", "{"))


def _named(name: str, file: str | None) -> tuple[str, str]:
    path = Path(name)
    if name.endswith("_description") and not path.suffix and not path.exists():
        described = _described(name)
        if described is not None:
            name = described
    read, text = _denavit.read_text(name)
    return file or read, text


def _described(name: str) -> str | None:
    """The path of a robot of `robot_descriptions`, where that package is installed."""
    try:
        from importlib import import_module

        module = import_module(f"robot_descriptions.{name}")
    except ImportError:
        return None
    path = getattr(module, "URDF_PATH", None)
    return str(path) if path else None


def _urdf_of(source: Any) -> str | None:
    """The URDF of a robot of yourdfpy or urchin."""
    if hasattr(source, "write_xml_string"):
        written = source.write_xml_string()
        return written.decode("utf-8") if isinstance(written, bytes) else str(written)
    if type(source).__module__.startswith("urchin"):
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            source.save(str(path))
            return path.read_text(encoding="utf-8")
    return None


def _rows_of(source: Any) -> list[dict[str, object]] | None:
    if hasattr(source, "to_dict") and hasattr(source, "columns"):
        return [dict(row) for row in source.to_dict("records")]
    if isinstance(source, Mapping):
        columns = {str(name): values for name, values in source.items()}
        lengths = {len(list(values)) for values in columns.values() if _is_column(values)}
        if len(lengths) != 1:
            raise ArgumentError("the columns of a D-H table need one length; give a number alone where all rows share it")
        count = lengths.pop()
        full = {name: list(values) if _is_column(values) else [values] * count for name, values in columns.items()}
        return [{name: values[row] for name, values in full.items()} for row in range(count)]
    if isinstance(source, Iterable) and not isinstance(source, str):
        rows = list(source)
        if rows and all(isinstance(row, Mapping) for row in rows):
            return [dict(row) for row in rows]
    return None


def _is_column(values: object) -> bool:
    return isinstance(values, Iterable) and not isinstance(values, str)


def _table(rows: list[dict[str, object]], convention: str | None) -> str:
    unknown = sorted({str(name) for row in rows for name in row} - set(COLUMNS))
    if unknown:
        raise ArgumentError(f"a D-H table has no column {unknown[0]!r}; its columns are {', '.join(COLUMNS)}")
    columns = [name for name in COLUMNS if any(name in row for row in rows)]
    if "row" not in columns:
        columns.insert(0, "row")
        rows = [{"row": str(number), **row} for number, row in enumerate(rows, 1)]
    out = io.StringIO()
    if convention is not None:
        out.write(f"# convention: {convention}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows([[cell(row.get(name)) for name in columns] for row in rows])
    return out.getvalue()


def cell(value: object) -> str:
    """A value as a cell of CSV that reads back as it is; empty where it is none."""
    if value is None or value != value:  # noqa: PLR0124 - not a number: a cell that a data frame has no value for
        return ""
    if isinstance(value, str):
        return value
    return str(int(value)) if isinstance(value, Integral) else repr(float(value))  # type: ignore[arg-type]
