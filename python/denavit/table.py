"""Denavit-Hartenberg tables."""

from __future__ import annotations

import html
import json
import os
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from denavit import _denavit
from denavit._files import save
from denavit._frozen import Frozen
from denavit.bridges.sources import text_of

if TYPE_CHECKING:
    import pandas as pd

    from denavit.chain import Chain


@dataclass(frozen=True, slots=True)
class Note:
    """What was read differently from what is written, or a note on a result.

    Attributes:
        kind: A word for programs.
        message: A sentence.
        file: The file, if the note is about a place.
        line: Its line, from 1.
        element: Its element.
        written: The literal in the file, where one was read as something else.
        read_as: What it was read as.
        tip_moves_at_most: No point of the tip frame's origin moves by more, m.
    """

    kind: str
    message: str
    file: str | None = None
    line: int | None = None
    element: str | None = None
    written: str | None = None
    read_as: str | None = None
    tip_moves_at_most: float | None = None

    def __str__(self) -> str:
        return self.message


@dataclass(frozen=True, slots=True)
class Row:
    """A row of a table; ``None`` for numbers that such a row does not have.

    Attributes:
        row: ``base``, ``1`` … ``n``, ``tool``.
        theta: Joint angle about z, rad.
        d: Link offset along z, m.
        alpha: Link twist about x, rad.
        a: Link length along x, m.
        beta: Twist about y, rad; of Hayati rows.
    """

    row: str
    theta: float | None = None
    d: float | None = None
    alpha: float | None = None
    a: float | None = None
    beta: float | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Match:
    """How a vendor's table fits a robot.

    Attributes:
        verdict: ``exact``, ``rounded``, ``close`` or ``mismatch``.
        position_error: Largest distance of the tips over random configurations, m.
        rotation_error: Largest rotation between the tips, rad.
        json: Everything, as ``denavit table --match --format json`` prints it.
        text: The same in words.
    """

    verdict: Literal["exact", "rounded", "close", "mismatch"]
    position_error: float
    rotation_error: float
    json: dict[str, Any]
    text: str

    @property
    def exact(self) -> bool:
        """Whether the numbers are the same."""
        return self.verdict == "exact"

    @property
    def differences(self) -> tuple[str, ...]:
        """The numbers in which robot and table differ, in words."""
        return tuple(entry["words"] for entry in self.json["differences"])

    def __bool__(self) -> bool:
        return self.verdict in ("exact", "rounded")

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return self.text.rstrip()


class Table(Frozen):
    """A chain's Denavit-Hartenberg numbers; made by `Chain.table`.

    Examples:
        >>> import denavit as dn
        >>> table = dn.load("robots/universal_robots/ur5e.urdf").chain("base", "tool0").table("distal")
        >>> table.convention, [row.a for row in table.rows[1:4]]
        ('distal', [0.0, -0.425, -0.3922])
        >>> table.match("robots/universal_robots/ur5e_dh.csv").exact
        True
    """

    __slots__ = ("_chain", "_json", "_native", "_options")
    _made_by = "a table belongs to a chain: use chain.table(convention)"
    _native: _denavit.Table
    _chain: Chain
    _options: tuple[Any, Any, float]
    _json: dict[str, Any]

    @classmethod
    def _of(cls, chain: Chain, native: _denavit.Table, options: tuple[Any, Any, float]) -> Table:
        return cls._with(_native=native, _chain=chain, _options=options, _json=json.loads(native.render("json", "m,rad")))

    def __reduce__(self) -> tuple[Any, ...]:
        return _again, (self._chain, *self._options)

    def _key(self) -> str:
        said = ("convention", "coordinates", "joints", "rows")
        return json.dumps([self._json[name] for name in said], sort_keys=True)

    def __repr__(self) -> str:
        return self.format("text").rstrip()

    def _repr_html_(self) -> str:
        columns, rows, words = self._native.cells("mm,deg")
        signs = {"theta": "θ", "alpha": "α", "beta": "β"}
        head = ["", "joint", "kind", *(signs.get(name, name) for name in columns), "limits"]
        cells = [[label, joint, kind, *numbers, limits] for label, joint, kind, numbers, limits in rows]

        def line(tag: str, words: list[str]) -> str:
            inner = "".join(f"<{tag} style='text-align:right'>{html.escape(word)}</{tag}>" for word in words)
            return f"<tr>{inner}</tr>"

        title = f"<b>{html.escape(self.robot)}</b> {html.escape(self.base)} → {html.escape(self.tip)}: {html.escape(words)}"
        body = line("th", head) + "".join(line("td", row) for row in cells)
        notes = "".join(f"<li>{html.escape(note.message)}</li>" for note in self.notes)
        return f"<p>{title}</p><table>{body}</table>" + (f"<ul>{notes}</ul>" if notes else "")

    def _repr_latex_(self) -> str:
        return self.format("tex")

    @property
    def chain(self) -> Chain:
        """The chain of this table."""
        return self._chain

    @property
    def robot(self) -> str:
        """The robot's name."""
        return str(self._json["robot"])

    @property
    def base(self) -> str:
        """Base link."""
        return str(self._json["base"])

    @property
    def tip(self) -> str:
        """Tip link."""
        return str(self._json["tip"])

    @property
    def convention(self) -> str:
        """``distal``, ``proximal``, ``paper`` or ``hayati``."""
        return str(self._json["convention"])

    @property
    def rows(self) -> tuple[Row, ...]:
        """Rows base, 1 … n, tool; rad and m."""
        return tuple(Row(**entry) for entry in self._json["rows"])

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the joints, base to tip."""
        return tuple(entry["name"] for entry in self._json["joints"])

    @property
    def notes(self) -> tuple[Note, ...]:
        """What was read differently from what is written, and other findings."""
        return tuple(Note(**entry) for entry in self._json["notes"])

    @property
    def tip_moves_at_most(self) -> float:
        """The largest motion of the tip due to what the notes describe, m."""
        return float(self._json["tip_moves_at_most"])

    def to_dict(self) -> dict[str, Any]:
        """The JSON of ``denavit table --format json``."""
        copied: dict[str, Any] = json.loads(json.dumps(self._json))
        return copied

    def to_pandas(self) -> pd.DataFrame:
        """A data frame with one row each for base, joints and tool; rad and m. Needs pandas.

        `denavit.load` reads it back as the same robot: the base row's ``kind`` holds the convention, as in the CSV; joints that
        one coordinate moves have one name; ``pitch`` (m/rad) and ``scale`` are there where a joint has them.
        """
        import pandas as pd

        by_row = {str(number): entry for number, entry in enumerate(self._json["joints"], 1)}
        numbers = ("theta", "d", "alpha", "a", "beta", "pitch", "scale")
        records = []
        for row in self.rows:
            joint = by_row.get(row.row, {"coordinate": "", "kind": self.convention if row.row == "base" else ""})
            values = {name: joint.get(name, {"pitch": 0.0, "scale": 1.0}.get(name, getattr(row, name, None))) for name in numbers}
            records.append({"row": row.row, "joint": joint["coordinate"], "kind": joint["kind"], **values})
        frame = pd.DataFrame.from_records(records).set_index("row")
        frame = frame.astype(dict.fromkeys(numbers, "float64"))
        usual = {"pitch": 0.0, "scale": 1.0}
        frame = frame.drop(columns=[name for name, value in usual.items() if (frame[name] == value).all()])
        frame = frame.dropna(axis="columns", how="all")
        frame.attrs["convention"] = self.convention
        return frame

    def __len__(self) -> int:
        return len(self._json["rows"])

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __getitem__(self, row: int) -> Row:
        return self.rows[row]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Rows of θ, d, α, a (and β where the table has it), rad and m; NaN for numbers that a row does not have."""
        names = ("theta", "d", "alpha", "a") + (("beta",) if any(row.beta is not None for row in self.rows) else ())
        return np.array([[getattr(row, name) for name in names] for row in self.rows], dtype=dtype or np.float64)

    def format(self, name: str = "text", units: str = "m,deg") -> str:
        """In a format of `denavit table`: text, md, csv, json, tex, rtb, matlab, …; `units` are those of text."""
        return self._native.render(name, units)

    def save(self, path: str | os.PathLike[str], format: str | None = None) -> None:  # noqa: A002
        """Write the table, as a whole or not at all; the format is that of the file's ending unless it is given."""
        ending = os.fspath(path).rpartition(".")[2]
        save(path, self.format(format or {"txt": "text"}.get(ending, ending)))

    def match(
        self,
        vendor: Any,
        *,
        table_convention: str | None = None,
        table_units: str | None = None,
        convention: str | None = None,
    ) -> Match:
        """Check whether it is the vendor's robot: find senses, zeros, base and tool frames for which the chain equals a table.

        Args:
            vendor: A table's file (CSV or JSON), its text, or the table as a mapping or data frame.
            table_convention: Of a table that does not state it, as for `denavit.load`.
            table_units: Of the numbers of a table that state none, such as ``mm,deg``; a mapping or data frame is in m and rad.
            convention: The same as `table_convention`.
        """
        stated = table_convention if convention is None else convention
        file, text = text_of(vendor, None, stated, table_units)
        written, words = self._native.match(file, text, stated, table_units or "")
        found = json.loads(written)
        return Match(found["verdict"], found["position_error_m"], found["rotation_error_rad"], found, words)


def _again(chain: Chain, convention: Any, gauge: Any, tolerance: float) -> Table:
    return chain.table(convention, gauge=gauge, tolerance=tolerance)
