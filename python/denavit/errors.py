"""Exceptions: each states what is wrong, where, and what to do."""

from __future__ import annotations

from typing import Any


class DenavitError(ValueError):
    """An input of denavit cannot be used.

    Attributes:
        message: What is wrong, with the place and what to do.
        file: The file, as it was given.
        line: Line in the file, from 1.
        column: Column in the line, from 1, in characters.
        element: The element, such as ``joint "elbow"``.
        hint: What to do, if the message states it.
    """

    message: str
    file: str | None
    line: int | None
    column: int | None
    element: str | None
    hint: str | None

    def __init__(
        self,
        message: str,
        *,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        element: str | None = None,
    ) -> None:
        super().__init__(message)
        self.message = message
        self.file, self.line, self.column, self.element = file, line, column, element
        # Messages read "what is wrong; what to do".
        _, mark, hint = message.splitlines()[0].partition("; ") if message else ("", "", "")
        self.hint = hint if mark else None

    def __reduce__(self) -> tuple[Any, ...]:
        place = {"file": self.file, "line": self.line, "column": self.column, "element": self.element}
        return _again, (type(self), self.message, place)


def _again(kind: type[DenavitError], message: str, place: dict[str, Any]) -> DenavitError:
    return kind(message, **place)


class ArgumentError(DenavitError):
    """An invalid argument."""


class ReadError(DenavitError, OSError):
    """A file that cannot be read, or that is not UTF-8 text."""


class RobotError(DenavitError):
    """A text that is not a robot: not a URDF, xacro, table, or set of screw axes."""


class ChainError(DenavitError):
    """The robot does not have this chain."""


class ExportError(DenavitError):
    """A robot or table that a format cannot hold."""


class DataError(DenavitError):
    """Measurements or poses that cannot be read."""


class CalibrationError(DenavitError):
    """Measurements from which no calibration is possible."""


class ManifestError(DenavitError):
    """A fleet's manifest that is invalid."""


class StoreError(DenavitError):
    """A fleet's store that cannot be read or written."""
