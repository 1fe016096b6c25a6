"""Measurement files: joint readings and what an instrument saw, row by row."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from denavit import _denavit
from denavit._files import save
from denavit.bridges.sources import cell
from denavit.errors import ArgumentError

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True, repr=False)
class Measurements:
    """Measured data as CSV text; row order is run order.

    A column per joint, named as in the URDF, and ``x,y,z`` of a target on the tip, or ``x,y,z,qx,qy,qz,qw``, or
    ``x1,y1,z1,x2,…`` of several targets, or ``distance`` from a fixed anchor, or ``socket``, the label of the socket that a ball
    on the tip sits in. `time`, `temperature`, `payload`, `JOINT.approach` and other numeric columns are what effects may
    follow. Columns are held against a chain when they are used: what is wrong then raises `DataError`, with file and line.

    Attributes:
        text: The CSV.
        file: What messages call it.
        units: Of lengths (m, mm, um, in) and angles (rad, mrad, deg), such as ``mm,deg``.

    Examples:
        >>> import denavit as dn
        >>> dn.Measurements.read("robots/universal_robots/ur5e_tracker.csv")
        <denavit.Measurements robots/universal_robots/ur5e_tracker.csv: 120 rows, m,rad>
        >>> dn.Measurements.from_columns({"joint_1": [0.1, 0.2], "x": 1.0, "y": [0.0, 0.1], "z": 0.5}).columns
        ('joint_1', 'x', 'y', 'z')
    """

    text: str
    file: str = "<measurements>"
    units: str = "m,rad"

    @classmethod
    def read(cls, path: str | os.PathLike[str], units: str = "m,rad") -> Measurements:
        """Read a CSV file, or ``git:REVISION:PATH``.

        Raises:
            ReadError: The file cannot be read.
        """
        file, text = _denavit.read_text(os.fspath(path))
        return cls(text, file, units)

    @classmethod
    def from_columns(
        cls, columns: Mapping[str, Iterable[object] | float | str], units: str = "m,rad", file: str = "<columns>"
    ) -> Measurements:
        """Take columns by name: arrays or lists of one length, or a value alone where all rows share it.

        `None` and NaN are what was not measured.

        Raises:
            ArgumentError: The columns are not of one length.
        """
        alone = (str, bytes, int, float)
        lists = {name: None if isinstance(values, alone) else list(values) for name, values in columns.items()}
        lengths = {len(values) for values in lists.values() if values is not None}
        if len(lengths) != 1:
            found = ", ".join(f"{name} {len(values)}" for name, values in lists.items() if values is not None) or "none"
            raise ArgumentError(
                f"columns of measurements need one length, and these have: {found}; give one value per row", file=file
            )
        (rows,) = lengths
        full = [[columns[name]] * rows if values is None else values for name, values in lists.items()]
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(list(columns))
        writer.writerows([cell(value) for value in row] for row in zip(*full, strict=True))
        return cls(out.getvalue(), file, units)

    @classmethod
    def from_pandas(cls, frame: pd.DataFrame, units: str = "m,rad", file: str = "<data frame>") -> Measurements:
        """Take a data frame's columns; what is missing is what was not measured."""
        return cls.from_columns({str(name): frame[name].tolist() for name in frame.columns}, units, file)

    def to_pandas(self) -> pd.DataFrame:
        """The columns as a data frame, in the file's own units. Needs pandas."""
        import pandas as pd

        return pd.read_csv(io.StringIO(self.text), comment="#", skipinitialspace=True)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the CSV, as a whole or not at all."""
        save(path, self.text)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(name.strip() for name in next(self._rows(), []))

    def __len__(self) -> int:
        return max(0, sum(1 for _ in self._rows()) - 1)

    def _rows(self) -> Iterator[list[str]]:
        lines = (line for line in self.text.splitlines() if line.strip() and not line.lstrip().startswith("#"))
        return csv.reader(lines)

    def _given(self) -> tuple[str, str, str]:
        return self.file, self.text, self.units

    def __repr__(self) -> str:
        return f"<denavit.Measurements {self.file}: {len(self)} rows, {self.units}>"
