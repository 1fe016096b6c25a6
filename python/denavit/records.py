"""Results in rows."""

from __future__ import annotations

import html
from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

if TYPE_CHECKING:
    from dataclasses import Field
    from typing import ClassVar

    import pandas as pd


class Entry(Protocol):
    """A dataclass."""

    __dataclass_fields__: ClassVar[dict[str, Field[Any]]]


T = TypeVar("T", bound=Entry)


class Records(tuple[T, ...]):
    """A tuple of results of one kind that shows itself as a table."""

    __slots__ = ()

    def to_pandas(self) -> pd.DataFrame:
        """A data frame with one row per result. Needs pandas."""
        import pandas as pd

        return pd.DataFrame.from_records(self.rows())

    def rows(self) -> list[dict[str, Any]]:
        """One dictionary per result, with its named values as separate entries."""
        return [_flat(entry) for entry in self]

    def _cells(self) -> list[list[str]]:
        rows = [people(row) for row in self.rows()]
        names = list(dict.fromkeys(name for row in rows for name in row))
        return [names, *([written(row.get(name)) for name in names] for row in rows)] if rows else []

    def __repr__(self) -> str:
        cells = self._cells()
        if not cells:
            return "none"
        widths = [max(len(row[column]) for row in cells) for column in range(len(cells[0]))]
        lines = ("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)) for row in cells)
        return "\n".join(line.rstrip() for line in lines)

    def _repr_html_(self) -> str:
        cells = self._cells()
        return html_table(cells) if cells else "none"


def html_table(cells: list[list[str]]) -> str:
    """A table of texts, the first row its head."""
    head, *body = ("".join(f"<td>{html.escape(cell)}</td>" for cell in row) for row in cells)
    rows = "".join(f"<tr>{row}</tr>" for row in body)
    return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"


_SMALL = {"m": ("mm", 1e3), "rad": ("mrad", 1e3)}
"""Display units of small lengths and angles."""

_WITH_UNIT = ("change", "sd", "interval", "value")
"""Numbers of a row that are in its ``unit``."""


def people(row: Mapping[str, Any]) -> dict[str, Any]:
    """A row for display: mm and mrad instead of m and rad, with matching names."""
    out: dict[str, Any] = {}
    own = _SMALL.get(str(row.get("unit")))
    for name, value in row.items():
        stem, mark, end = name.rpartition("_")
        if mark and end in _SMALL and isinstance(value, float | int):
            unit, factor = _SMALL[end]
            out[f"{stem}_{unit}"] = value * factor
        elif own and name in _WITH_UNIT and isinstance(value, float | int):
            out[name] = value * own[1]
        elif own and name == "unit":
            out[name] = own[0]
        else:
            out[name] = value
    return out


def _flat(entry: Entry) -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for field in fields(entry):
        value = getattr(entry, field.name)
        flat |= (
            {f"{field.name}_{name}": number for name, number in value.items()} if isinstance(value, dict) else {field.name: value}
        )
    return flat


def written(value: object) -> str:
    """A cell as text, numbers with four digits."""
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, tuple):
        return ", ".join(map(str, value))
    return str(value)
