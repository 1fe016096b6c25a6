"""Arguments as people give them: whole numbers, and joint values by name or in order."""

from __future__ import annotations

import operator
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from denavit.errors import ArgumentError

_MOST = 2**63 - 1


def whole(name: str, value: object, least: int = 0, most: int = _MOST) -> int:
    """A whole number within bounds.

    Raises:
        ArgumentError: Invalid, or outside.
    """
    try:
        number = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        raise ArgumentError(f"{name} is {value!r}; give a whole number") from None
    if not least <= number <= most:
        raise ArgumentError(f"{name} is {number}; give a whole number from {least} to {most}")
    return number


def number(name: str, value: object) -> float:
    """A number.

    Raises:
        ArgumentError: Invalid.
    """
    try:
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError, OverflowError):
        raise ArgumentError(f"{name} is {value!r}; give a number") from None


def array(name: str, value: Any) -> Any:
    """A C-contiguous array of float64.

    Raises:
        ArgumentError: It cannot be converted to an array of numbers.
    """
    try:
        return np.asarray(value, dtype=np.float64, order="C")
    except (TypeError, ValueError, OverflowError) as error:
        raise ArgumentError(f"{name} is not an array of numbers ({error})") from None


def is_frame(value: object) -> bool:
    """Whether it is a data frame (pandas, polars) or a table of Arrow: columns that have names."""
    return hasattr(value, "columns") and (hasattr(value, "to_dict") or hasattr(value, "column_names"))


def frame_columns(frame: Any, what: str) -> list[tuple[object, list[Any]]]:
    """Columns of a frame with their names, a named index first.

    Raises:
        ArgumentError: Two columns have one name.
    """
    names = list(frame.column_names if hasattr(frame, "column_names") else frame.columns)
    columns = [] if hasattr(frame, "column_names") else _index(frame)
    if twice := [name for at, name in enumerate(names) if name in names[:at]]:
        raise ArgumentError(f"{what} has two columns {str(twice[0])!r}; rename or drop one")
    for name, _ in columns:
        if name in names:
            raise ArgumentError(f"{what} has a column {str(name)!r} and an index of that name; rename or drop one")
    return columns + [(name, _listed(frame[name])) for name in names]


def _index(frame: Any) -> list[tuple[object, list[Any]]]:
    index = getattr(frame, "index", None)
    names = list(getattr(index, "names", ()) or ())
    return [(name, list(index.get_level_values(level))) for level, name in enumerate(names) if name is not None]  # type: ignore[union-attr]


def _listed(column: Any) -> list[Any]:
    return list(column.to_list() if hasattr(column, "to_list") else column.to_pylist())


def joint_values(name: str, q: Any, joints: Sequence[str]) -> Any:
    """Joint values as an array whose last axis is in the order of the joints.

    Values with names (a data frame, a mapping, a series with labels) are sorted by them; columns that are not joints are left
    out. Arrays, and frames whose columns are numbers, are in order already.

    Raises:
        ArgumentError: A joint has no column.
    """
    if isinstance(q, Mapping):
        columns: dict[object, Any] = dict(q)
    elif is_frame(q):
        labels = list(q.column_names if hasattr(q, "column_names") else q.columns)
        if _are_positions(labels):
            return q
        columns = dict(frame_columns(q, name))
    elif hasattr(q, "to_numpy") and hasattr(q, "index") and not _are_positions(list(q.index)):
        columns = dict(zip(q.index, q.to_numpy(), strict=True))
        if len(columns) != len(q):
            raise ArgumentError(f"{name} has two values of one name; drop one")
    else:
        return q
    named = {str(column).strip(): values for column, values in columns.items()}
    if missing := [joint for joint in joints if joint not in named]:
        listed = ", ".join(named) or "none"
        raise ArgumentError(
            f"{name} has no column {missing[0]!r}; its columns are {_cut(listed)}. Name a column as each joint "
            f"({_cut(', '.join(joints))}), or give an array of values in this order"
        )
    values = [array(f"{name}[{joint!r}]", named[joint]) for joint in joints]
    alone = {joint: value.shape for joint, value in zip(joints, values, strict=True)}
    try:
        return np.stack(np.broadcast_arrays(*values), axis=-1) if values else np.zeros(0)
    except ValueError:
        raise ArgumentError(f"{name}: columns differ in length: {alone}; give one value of each joint per row") from None


def _are_positions(labels: list[Any]) -> bool:
    return all(isinstance(label, int | np.integer) for label in labels) and [int(label) for label in labels] == list(
        range(len(labels))
    )


def _cut(words: str) -> str:
    return words if len(words) <= 300 else f"{words[:300]}…"
