"""Measurement files: joint readings and instrument readings, row by row."""

from __future__ import annotations

import csv
import io
import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from denavit import _denavit
from denavit._files import save
from denavit._given import array, frame_columns, is_frame, joint_values
from denavit.bridges.sources import cell
from denavit.chain import Chain
from denavit.errors import ArgumentError, DataError

if TYPE_CHECKING:
    import pandas as pd

Columns = Mapping[str, str | Sequence[str] | Mapping[str, str | Sequence[str]]]
"""A map of columns in Python: the contents of its TOML file."""


@dataclass(frozen=True, slots=True)
class Told:
    """Descriptions of an export's columns that its text does not contain.

    Attributes:
        columns: A map of columns: the file that it is from and its text.
        euler: Order of three angles.
        quaternion: Order of a quaternion.
        rotation_vector: Whether ``rx,ry,rz`` are axis times angle.
        joints: A robot program: the file that it is from and its text.
        camera: Intrinsics of the camera: the file that they are from and its text.
        board: The board that the camera sees.
        on_hand: Whether the camera sits on the hand.
        plate: The plate whose holes are touched.
    """

    columns: tuple[str, str] | None = None
    euler: str | None = None
    quaternion: str | None = None
    rotation_vector: bool = False
    joints: tuple[str, str] | None = None
    camera: tuple[str, str] | None = None
    board: str | None = None
    on_hand: bool = False
    plate: str | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Measurements:
    """Measured data as an instrument's program wrote them; row order is run order.

    CSV with a column per joint, named as in the URDF, and ``x,y,z`` of a target on the tip, or ``x,y,z,qx,qy,qz,qw``, or
    ``x1,y1,z1,x2,…`` of several targets, or ``distance`` from a fixed anchor, or ``socket``, the label of the socket that a ball
    on the tip sits in. `time`, `temperature`, `payload`, `JOINT.approach` and other numeric columns are what effects may
    follow. Other forms (semicolons, UTF-16, a workbook, …) are converted as described in `docs/measurements.md`.
    Columns are checked against a chain when they are used: errors then raise `DataError`, with file and line.

    Attributes:
        content: The file: text, or bytes of a workbook or of text in another encoding than UTF-8.
        file: What messages call it.
        units: Of lengths (m, mm, um, in) and angles (rad, mrad, deg), such as ``mm,deg``.
        told: The meaning of columns whose names do not state it.
        socket: The label of the socket that the ball sits in, where the file is bare joint readings.

    Examples:
        >>> import denavit as dn
        >>> dn.Measurements.read("robots/universal_robots/ur5e_tracker.csv")
        <denavit.Measurements robots/universal_robots/ur5e_tracker.csv: 120 rows, m,rad>
        >>> dn.Measurements.from_columns({"joint_1": [0.1, 0.2], "x": 1.0, "y": [0.0, 0.1], "z": 0.5}).columns
        ('joint_1', 'x', 'y', 'z')
    """

    content: str | bytes
    file: str = "<measurements>"
    units: str = "m,rad"
    told: Told = field(default=Told(), kw_only=True)
    socket: str | None = field(default=None, kw_only=True)

    @classmethod
    def read(
        cls,
        path: str | os.PathLike[str],
        units: str = "m,rad",
        *,
        columns: str | os.PathLike[str] | Columns | None = None,
        euler: str | None = None,
        quaternion: str | None = None,
        rotation_vector: bool = False,
        joints: str | os.PathLike[str] | None = None,
        camera: str | os.PathLike[str] | None = None,
        board: str | None = None,
        on_hand: bool = False,
        plate: str | None = None,
        socket: str | None = None,
    ) -> Measurements:
        """Read a file: CSV, any export, a workbook; ``git:REVISION:PATH``; ``-`` for standard input.

        The keywords are the options of ``denavit calibrate``.

        Args:
            path: The file.
            units: Of columns that name none.
            columns: The meaning of columns whose names do not state it: a TOML file, ``"x=X1,y=Y1,z=Z1"``, or a mapping such as
                ``{"x": "PX", "joints": ["A1", "A2"], "euler": {"order": "ZYX", "columns": ["A", "B", "C"]}}``.
            euler: Columns of angles (``roll,pitch,yaw``; ``rx,ry,rz``; ``A,B,C``; ``W,P,R``) are turns in this order: ``XYZ``
                about the axes as they turn along (intrinsic), ``xyz`` about fixed axes (extrinsic).
            quaternion: Columns ``q1,q2,q3,q4`` (or ``q0,q1,q2,q3``) are a quaternion in this order, such as ``wxyz``.
            rotation_vector: Columns ``rx,ry,rz`` are axis times angle.
            joints: A robot program with the joint values of the rows: ABB RAPID, KUKA KRL, UR script.
            camera: Columns ``u,v`` are pixels of a board's corners in the image of the camera with these intrinsics: a YAML
                file as ROS (``camera_info``) or OpenCV write it; see `docs/camera.md`.
            board: The board that the camera sees: squares across and down, and the edge of a square, such as ``7x5:30mm``.
            on_hand: The camera sits on the hand and the board stands still, not the other way round.
            plate: A column ``hole`` names what each row touches on a plate of ``denavit plate``, such as ``4x3:40mm``.
            socket: The file is bare joint readings (no header, a column per joint), taken with a ball on the tip in the
                socket of this label.

        Raises:
            ReadError: A file cannot be read.
            ArgumentError: Keywords that exclude each other.

        Examples:
            >>> import denavit as dn
            >>> dn.Measurements.read("tests/measured/files/readings.xlsx", units="mm,deg").columns[:3]
            ('shoulder_pan_joint (deg)', 'shoulder_lift_joint (deg)', 'elbow_joint (deg)')
        """
        orders = {"euler": euler, "quaternion": quaternion, "rotation_vector": rotation_vector or None}
        several = [name for name, value in orders.items() if value is not None]
        if len(several) > 1:
            raise ArgumentError(f"{' and '.join(several)} exclude each other; an orientation has only one form")
        if socket is not None and (several or not (columns is joints is camera is plate is None)):
            raise ArgumentError(f"readings in the socket {socket!r} are only joint values; leave out descriptions of columns")
        file, content = _denavit.read_bytes(os.fspath(path))
        program = None if joints is None else _denavit.read_text(os.fspath(joints))
        lens = camera_file(camera, board, on_hand)
        told = Told(_map(columns), euler, quaternion, rotation_vector, program, lens, board, on_hand, plate)
        return cls(_as_text(content), file, units, told=told, socket=socket)

    @classmethod
    def from_bag(
        cls,
        path: str | os.PathLike[str],
        chain: Chain,
        *,
        joint_topic: str | None = None,
        target_topic: str | None = None,
    ) -> Measurements:
        """Read the standstills of a ROS 2 bag, one row each; see `docs/bags.md`.

        Lines that begin with ``#`` at the head of `text` state what was found: how many standstills, and how far the clocks are
        apart.

        Args:
            path: The folder that ``ros2 bag record`` made, or a ``.mcap`` or ``.db3`` file in it.
            chain: Whose joints the bag's ``JointState`` names.
            joint_topic: The topic of the joint readings, where several have these joints.
            target_topic: The topic of the target, where there are several; ``/tf:PARENT/CHILD`` names a transform.

        Raises:
            DataError: The bag cannot be read, its topics are ambiguous, or the robot never stands still.
        """
        file = os.fspath(path)
        rows, notes = _denavit.bag_rows(file, chain._native, joint_topic, target_topic)
        return cls("".join(f"# {note}\n" for note in notes) + rows, file)

    @classmethod
    def from_columns(
        cls, columns: Mapping[str, Iterable[object] | float | str], units: str = "m,rad", file: str = "<columns>"
    ) -> Measurements:
        """Take columns by name: arrays or lists of one length, or a value alone where all rows share it.

        `None` and NaN mean not measured.

        Raises:
            ArgumentError: The columns are not of one length.
        """
        lists = {
            name: list(values) if isinstance(values, Iterable) and not isinstance(values, str | bytes) else None
            for name, values in columns.items()
        }
        lengths = {len(values) for values in lists.values() if values is not None}
        if len(lengths) != 1:
            found = ", ".join(f"{name} {len(values)}" for name, values in lists.items() if values is not None) or "none"
            raise ArgumentError(f"columns of measurements need one length, but have: {found}; give one value per row", file=file)
        (rows,) = lengths
        full = [[columns[name]] * rows if values is None else values for name, values in lists.items()]
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow([str(name) for name in columns])
        try:
            writer.writerows([cell(value) for value in row] for row in zip(*full, strict=True))
        except ArgumentError as error:
            raise ArgumentError(f"{file}: {error.message}", file=file) from None
        return cls(out.getvalue(), file, units)

    @classmethod
    def from_arrays(cls, chain: Chain, q: ArrayLike, measured: ArrayLike, file: str = "<arrays>") -> Measurements:
        """Take joint values, rad and m, shape ``(N, n)``, and what was measured at each.

        Args:
            chain: Whose joints `q` has, in order or by name.
            q: Joint values.
            measured: Positions of one target, m, shape ``(N, 3)``; distances, m, shape ``(N,)``; or instrument_from_target poses,
                m, shape ``(N, 4, 4)``.
            file: What messages call it.

        Raises:
            ArgumentError: Another shape.
        """
        values = array("q", joint_values("q", q, chain.joints))
        seen = array("measured", measured)
        if values.ndim != 2 or values.shape[1] != len(chain) or len(values) != len(seen):
            raise ArgumentError(
                f"q has shape {values.shape} and measured {seen.shape}; give q of shape (N, {len(chain)}), measured of N values"
            )
        columns: dict[str, Any] = dict(zip(chain.joints, values.T.tolist(), strict=True))
        if seen.ndim == 1:
            columns["distance"] = seen.tolist()
        elif seen.shape[1:] == (3,):
            columns |= dict(zip(("x", "y", "z"), seen.T.tolist(), strict=True))
        elif seen.shape[1:] == (4, 4):
            columns |= dict(zip(("x", "y", "z"), seen[:, :3, 3].T.tolist(), strict=True))
            turns = np.array([_denavit.quaternion(np.ascontiguousarray(pose[:3, :3])) for pose in seen])
            columns |= dict(zip(("qx", "qy", "qz", "qw"), turns.T.tolist(), strict=True))
        else:
            raise ArgumentError(f"measured has shape {seen.shape}; give positions (N, 3), distances (N,) or poses (N, 4, 4)")
        return cls.from_columns(columns, file=file)

    @classmethod
    def from_pandas(cls, frame: pd.DataFrame, units: str | None = None, file: str = "<data frame>") -> Measurements:
        """Take a data frame's columns, and its index if it has a name; missing values mean not measured.

        Headings are read as those of a CSV file: ``elbow_joint (deg)``, ``X [mm]``.

        Args:
            frame: A data frame of pandas or polars.
            units: Of columns that name none; by default those that `to_pandas` wrote into the frame, else m and rad.
            file: What messages call it.
        """
        if not is_frame(frame):
            raise ArgumentError(f"a {type(frame).__name__} is not a data frame; give one, or use from_columns")
        attributes = getattr(frame, "attrs", {})
        stated = attributes.get("units") if isinstance(attributes, Mapping) else None
        columns = {str(name): values for name, values in frame_columns(frame, file)}
        return cls.from_columns(columns, units or stated or "m,rad", file)

    def to_pandas(self) -> pd.DataFrame:
        """The columns as a data frame, in the file's own units. Needs pandas."""
        import pandas as pd

        if self.socket is not None:
            return pd.read_csv(io.StringIO(self.text), comment="#", skipinitialspace=True, header=None)
        frame = pd.read_csv(io.StringIO(self.text), comment="#", skipinitialspace=True)
        frame.attrs["units"] = self.units
        return frame

    def __iter__(self) -> Iterator[dict[str, str]]:
        """Rows, each cell as it is written by the name of its column."""
        names = self.columns
        rows = self._rows()
        if self.socket is None:
            next(rows, None)
        for row in rows:
            labels = names or tuple(str(at) for at in range(len(row)))
            yield dict(zip(labels, (text.strip() for text in row), strict=False))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Rows of numbers in the file's own units, shape ``(rows, columns)``; NaN for empty cells."""
        rows = []
        for at, row in enumerate(self, 1):
            for name, text in row.items():
                if text and not _is_number(text):
                    raise DataError(
                        f"{self.file}: row {at}, column {name!r} is {text!r}, not a number; to_pandas() keeps texts",
                        file=self.file,
                    )
            rows.append([float(text) if text else np.nan for text in row.values()])
        return np.array(rows, dtype=dtype or np.float64)

    @property
    def text(self) -> str:
        """The cells as CSV, as in the file; for a CSV file, the file itself.

        Raises:
            DataError: A workbook that cannot be read.
        """
        if isinstance(self.content, str) and _is_csv(self.content):
            return self.content
        cells = _denavit.cells(self.file, self.content)
        if cells is None:
            return self.content if isinstance(self.content, str) else self.content.decode("utf-8", errors="replace")
        return cells

    def columns_draft(self, chain: Chain) -> str:
        """A map of the columns to start from, TOML for `columns`; ``denavit calibrate --columns-draft``."""
        return _denavit.columns_draft(chain._native, self.file, self.content)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the file, as a whole or not at all."""
        save(path, self.content)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns, as in the file; none for readings in a socket."""
        if self.socket is not None:
            return ()
        return tuple(name.strip() for name in next(self._rows(), []))

    def __len__(self) -> int:
        return max(0, sum(1 for _ in self._rows()) - (self.socket is None))

    def _rows(self) -> Iterator[list[str]]:
        lines = (line for line in self.text.splitlines() if line.strip() and not line.lstrip().startswith("#"))
        return csv.reader(lines)

    def _given(self) -> _denavit.Given:
        told = self.told
        return {
            "name": self.file,
            "content": self.content,
            "units": self.units,
            "columns": told.columns,
            "euler": told.euler,
            "quaternion": told.quaternion,
            "rotation_vector": told.rotation_vector,
            "joints": told.joints,
            "camera": told.camera,
            "board": told.board,
            "on_hand": told.on_hand,
            "plate": told.plate,
        }

    def __repr__(self) -> str:
        where = "" if self.socket is None else f" in socket {self.socket}"
        return f"<denavit.Measurements {self.file}: {len(self)} rows{where}, {self.units}>"


def measurements(name: str, data: Any, chain: Chain) -> Measurements:
    """Measurements from any accepted form: a file, a data frame, a mapping of columns, arrays, a simulated run.

    Raises:
        ArgumentError: None of these.
    """
    from denavit.run import Simulation

    if isinstance(data, Measurements):
        return data
    if isinstance(data, Simulation):
        return data.data
    if isinstance(data, str | os.PathLike):
        return Measurements.read(data)
    if is_frame(data):
        return Measurements.from_pandas(data)
    if isinstance(data, Mapping):
        return Measurements.from_columns({str(name): values for name, values in data.items()}, file=f"<{name}>")
    if isinstance(data, tuple) and len(data) == 2 and not any(isinstance(part, Measurements) for part in data):
        return Measurements.from_arrays(chain, *data, file=f"<{name}>")
    raise ArgumentError(
        f"{name} is a {type(data).__name__}; give denavit.Measurements, a file, a data frame, a mapping of columns, or a pair of "
        f"arrays: joint values of shape (N, {len(chain)}) and positions of shape (N, 3)"
    )


def is_several(data: Any) -> bool:
    """Whether it is a list of measurements rather than one."""
    if isinstance(data, list):
        return True
    return isinstance(data, tuple) and not (len(data) == 2 and all(_is_array(part) for part in data))


def _is_array(value: Any) -> bool:
    return isinstance(value, np.ndarray | list) or is_frame(value)


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def camera_file(camera: str | os.PathLike[str] | None, board: str | None, on_hand: bool) -> tuple[str, str] | None:
    """Where a camera's intrinsics are from, and their text."""
    if camera is not None:
        return _denavit.read_text(os.fspath(camera))
    if board is not None or on_hand:
        raise ArgumentError(f"{'board' if board is not None else 'on_hand'} needs a camera; give its intrinsics as camera")
    return None


def _as_text(content: bytes) -> str | bytes:
    """Text where it is UTF-8; a workbook and other encodings stay as they are."""
    if content.startswith(b"PK\x03\x04") or b"\0" in content[:2000]:
        return content
    try:
        return content.decode("utf-8")
    except UnicodeDecodeError:
        return content


def _is_csv(text: str) -> bool:
    first = next((line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")), "")
    return ";" not in first and "\t" not in first and ("," in first or not first)


def _map(columns: str | os.PathLike[str] | Columns | None) -> tuple[str, str] | None:
    """Where a map of columns is from, and its text."""
    if columns is None:
        return None
    if isinstance(columns, Mapping):
        return "columns", "".join(f"{json.dumps(str(name))} = {_toml(value)}\n" for name, value in columns.items())
    name = os.fspath(columns)
    if "=" in name and not Path(name).exists():
        return _denavit.COLUMNS_IN_WORDS, name
    return _denavit.read_text(name)


def _toml(value: object) -> str:
    """Texts, lists of them, and mappings of both, as TOML."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{json.dumps(str(name))} = {_toml(inner)}" for name, inner in value.items()) + " }"
    return json.dumps(value if isinstance(value, str) else list(value) if isinstance(value, Iterable) else value)
