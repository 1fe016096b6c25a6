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
from denavit._given import frame_columns, is_frame
from denavit.errors import ArgumentError

COLUMNS = ("row", "joint", "kind", "theta", "d", "alpha", "a", "beta", "pitch", "scale")

WANTED = (
    "give a path, text, bytes, a D-H table (a mapping of columns, rows, a data frame, a denavit.Table), or a robot of yourdfpy, "
    "urchin, pinocchio or roboticstoolbox"
)


def text_of(source: Any, file: str | None, convention: str | None = None, units: str | None = None) -> tuple[str, str]:
    """The name of a source in messages, and its text; the text of a table of numbers states its convention and units.

    Numbers are in rad and m unless a heading or `units` states otherwise.
    """
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
    if (given := _own(source)) is not None:
        return file or given[0], given[1]
    if (urdf := _urdf_of(source)) is not None:
        return file or type(source).__module__.partition(".")[0], urdf
    attributes = getattr(source, "attrs", None)
    stated = attributes.get("convention") if isinstance(attributes, Mapping) else None
    rows = _rows_of(source)
    if rows is None:
        raise ArgumentError(f"a {type(source).__name__} is not a robot; {WANTED}")
    return file or "table.csv", _table(rows, convention or stated, _denavit.table_units(units or ""))


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


def _own(source: Any) -> tuple[str, str] | None:
    """File and text of a table of this package; other results are refused, with the name of their robot attribute."""
    from denavit.table import Table

    if isinstance(source, Table):
        return f"{source.robot or 'table'}.json", source.format("json")
    if type(source).__module__.startswith("denavit."):
        kind = type(source).__name__
        instead = {"Chain": "chain.robot, or chain.table()", "Fit": "fit.robot or fit.nominal.robot", "Diff": "diff.robots"}
        raise ArgumentError(f"a denavit.{kind} is not a robot; give {instead.get(kind, 'a source that denavit.load takes')}")
    return None


def _urdf_of(source: Any) -> str | None:
    """The URDF of a robot of yourdfpy, urchin or pinocchio; the screw axes of one of roboticstoolbox."""
    module = type(source).__module__
    if hasattr(source, "write_xml_string"):
        written = source.write_xml_string()
        return written.decode("utf-8") if isinstance(written, bytes) else str(written)
    if module.startswith("roboticstoolbox"):
        from denavit.bridges.robots import of_roboticstoolbox

        return of_roboticstoolbox(source)
    if module.startswith("pinocchio") and hasattr(source, "jointPlacements"):
        from denavit.bridges.robots import of_pinocchio

        return of_pinocchio(source)
    if module.startswith("urchin"):
        import tempfile

        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "robot.urdf"
            source.save(str(path))
            return path.read_text(encoding="utf-8")
    return None


def _rows_of(source: Any) -> list[dict[str, object]] | None:
    if is_frame(source):
        return _of_frame(source)
    if isinstance(source, Mapping):
        columns = {str(name): values for name, values in source.items()}
        full_columns = {name: list(values) for name, values in columns.items() if _is_column(values)}
        lengths = {len(values) for values in full_columns.values()}
        if len(lengths) != 1:
            found = ", ".join(f"{name} {len(values)}" for name, values in full_columns.items()) or "none"
            raise ArgumentError(
                f"the columns of a D-H table must have the same length, but have: {found}; a single number applies to all rows"
            )
        count = lengths.pop()
        full = {name: full_columns.get(name, [values] * count) for name, values in columns.items()}
        return [{name: values[row] for name, values in full.items()} for row in range(count)]
    if isinstance(source, Iterable) and not isinstance(source, str):
        rows = list(source)
        if rows and all(isinstance(row, Mapping) for row in rows):
            return [{str(name): value for name, value in row.items()} for row in rows]
    return None


def _of_frame(frame: Any) -> list[dict[str, object]]:
    columns = [(str(name), values) for name, values in frame_columns(frame, "the frame")]
    index = getattr(frame, "index", None)
    if index is not None and all(name is None for name in getattr(index, "names", (None,))):
        labels = list(index)
        if any(isinstance(label, str) for label in labels):
            meanings = _denavit.table_columns([name for name, _ in columns])
            numbered = all(str(label).isdigit() or str(label) in ("base", "tool") for label in labels)
            name = "row" if numbered else "joint"
            if name in meanings:
                raise ArgumentError(
                    f"the index of the frame has no name, and there is a column {name}; name the index, or reset_index(drop=True)"
                )
            columns.insert(0, (name, labels))
    count = len(columns[0][1]) if columns else 0
    return [{name: values[row] for name, values in columns} for row in range(count)]


def _is_column(values: object) -> bool:
    return isinstance(values, Iterable) and not isinstance(values, str | bytes) and getattr(values, "ndim", 1) == 1


def _table(rows: list[dict[str, object]], convention: str | None, units: str) -> str:
    headings = list(dict.fromkeys(name for row in rows for name in row))
    meanings = dict(zip(headings, _denavit.table_columns(headings), strict=True))
    if unknown := [name for name, meaning in meanings.items() if meaning is None]:
        raise ArgumentError(
            f"a D-H table has no column {unknown[0]!r}; its columns are {', '.join(COLUMNS)}, or with a unit (alpha [deg])"
        )
    if "row" not in meanings.values():
        headings.insert(0, "row")
        meanings["row"] = "row"
        rows = [{"row": str(number), **row} for number, row in enumerate(rows, 1)]
    # A row must not begin as a comment does.
    headings.sort(key=lambda name: meanings[name] != "row")
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([_line("a heading", name) for name in headings])
    for at, row in enumerate(rows):
        cells = [_line(f"row {at + 1}, {name}", _cell(at, name, row.get(name), meanings[name])) for name in headings]
        if cells[0].startswith("#"):
            raise ArgumentError(f"row {at + 1} is called {cells[0]!r}; a row is base, a number or tool")
        writer.writerow(cells)
    # Behind the rows, so that row k is in line k + 1.
    out.write(f"# units: {units}\n")
    if convention is not None:
        out.write(f"# convention: {_line('convention', str(convention))}\n")
    return out.getvalue()


def _line(what: str, text: str) -> str:
    if "\n" in text or "\r" in text:
        raise ArgumentError(f"{what} has a line break in it: {text[:60]!r}; write it in one line")
    return text


def _cell(row: int, name: str, value: object, meaning: str | None) -> str:
    if meaning == "row" and isinstance(value, float) and value.is_integer():
        value = int(value)
    try:
        return cell(value)
    except ArgumentError as error:
        raise ArgumentError(f"row {row + 1}, {name}: {error.message}") from None


def cell(value: object) -> str:
    """A value as a cell of CSV that reads back as it is; empty if it is missing.

    Raises:
        ArgumentError: It is neither a number nor a text.
    """
    if value is None or isinstance(value, str):
        return value or ""
    try:
        # Not a number: a cell that a data frame has no value for.
        if type(value).__name__ in ("NAType", "NaTType") or bool(value != value):  # noqa: PLR0124
            return ""
        return str(int(value)) if isinstance(value, Integral) else repr(float(value))  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{str(value)[:60]!r} is a {type(value).__name__}; give a number or a text") from None
