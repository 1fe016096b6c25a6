"""A robot from any source."""

from __future__ import annotations

import os
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from denavit import _denavit
from denavit._files import save
from denavit._frozen import Frozen
from denavit._shown import Shown
from denavit.bridges.sources import text_of
from denavit.chain import Chain
from denavit.errors import ArgumentError

if TYPE_CHECKING:
    from denavit.compare import Fingerprint

Source = Any
"""What `load` takes: a path, ``git:REVISION:PATH``, text, bytes, a D-H table as a mapping or data frame, a robot of
`yourdfpy`, `urchin`, `pinocchio` or `roboticstoolbox`, a `Table`, or a name of `robot_descriptions`."""

Origin = tuple[str, str, dict[str, str], tuple[str, ...], bool, bool, str | None, str]


@dataclass(frozen=True, slots=True)
class ChainListing:
    """A chain from a base link to a leaf of the tree.

    Attributes:
        base: Base link.
        tip: Tip link.
        coordinates: Names of the joints that move it, in order.
        default: Whether it is the default of `Robot.chain`.
    """

    base: str
    tip: str
    coordinates: tuple[str, ...]
    default: bool


class Robot(Shown, Frozen):
    """A robot as its source describes it; made by `load`.

    Robots are values: they are immutable, can be pickled, and are equal if their sources are equal.

    Examples:
        >>> import denavit as dn
        >>> robot = dn.load("robots/universal_robots/ur5e.urdf")
        >>> robot
        <denavit.Robot 'ur5e' from robots/universal_robots/ur5e.urdf: 8 links, 6 moving joints>
        >>> [chain.tip for chain in robot.chains if chain.default]
        ['tool0']
    """

    __slots__ = ("_made", "_native", "_origin")
    _made_by = "a robot is read from a source: use denavit.load"
    _native: _denavit.Robot
    _origin: Origin
    _made: tuple[str, ...]

    @classmethod
    def _of(cls, origin: Origin, made: tuple[str, ...] = ()) -> Robot:
        file, text, arguments, package_path, allow_any_file, vendor_angles, convention, units = origin
        reading = allow_any_file, vendor_angles, convention, units
        native = _denavit.Robot.from_text(file, text, list(arguments.items()), list(package_path), *reading)
        if native.urdf is not None and native.file != file:
            # What a xacro file included is in the URDF: this is what is kept.
            origin = (native.file, native.urdf, {}, (), False, False, None, "")
        return cls._with(_native=native, _origin=origin, _made=made)

    def __reduce__(self) -> tuple[Any, ...]:
        return Robot._of, (self._origin, self._made)

    def _key(self) -> tuple[object, ...]:
        _, text, arguments, *others = self._origin
        return text, tuple(sorted(arguments.items())), *others

    def __repr__(self) -> str:
        counts = self._native.counts
        what = f"{counts[0]} links, {counts[1]} moving joints" if counts else f"one chain, from a {self.kind} file"
        return f"<denavit.Robot {self.name!r} from {self.file}: {what}>"

    @property
    def name(self) -> str:
        """The robot's name; empty if the source has none."""
        return self._native.name

    @property
    def file(self) -> str:
        """The name of its source in messages."""
        return self._native.file

    @property
    def kind(self) -> Literal["urdf", "table", "poe"]:
        """Whether it is a tree, a D-H table or screw axes."""
        return self._native.kind  # type: ignore[return-value]

    @property
    def urdf(self) -> str | None:
        """Its URDF as text, xacro expanded; ``None`` for tables and screw axes."""
        return self._native.urdf

    @property
    def text(self) -> str:
        """Its source as text: the URDF, xacro expanded, or the table or screw axes as they were given."""
        return self._origin[1] if self.urdf is None else self.urdf

    @property
    def _self_contained(self) -> str:
        """The text together with the given convention and units (only tables have these)."""
        *_, convention, units = self._origin
        if self.kind != "table" or self.text.lstrip().startswith("{"):
            return self.text
        said = (("convention", convention), ("units", units))
        return "".join(f"# {key}: {word}\n" for key, word in said if word and f"# {key}: " not in self.text) + self.text

    @property
    def notes(self) -> tuple[str, ...]:
        """What was read differently from what is written; for a canonical robot also what the conversion changed."""
        return (*self._native.notes, *self._made)

    @property
    def chains(self) -> tuple[ChainListing, ...]:
        """Every chain to a leaf."""
        return tuple(ChainListing(base, tip, tuple(names), default) for base, tip, names, default in self._native.chains())

    def chain(self, base: str | None = None, tip: str | None = None, *, exact: bool = False) -> Chain:
        """The chain between two links.

        Args:
            base: First link; by default the root, or the link below the last floating joint.
            tip: Last link; by default the end of the longest actuated chain.
            exact: Read every number exactly as written: no angle is read as the multiple of π that it was meant to be.

        Raises:
            ChainError: A link does not exist, or there is no chain between the two.
        """
        return Chain._of(self, self._native.chain(base, tip, exact))

    def canonical(
        self,
        *,
        link_frames: Literal["replace", "keep", "mark"] = "replace",
        frames: Literal["distal", "proximal"] = "distal",
        tip: str | None = None,
        exact: bool = False,
        tolerance: float = 1e-6,
        keep_link_frames: bool = False,
    ) -> Robot:
        """The same robot with its link frames on the D-H frames; `denavit export`.

        Args:
            link_frames: ``replace`` the old frames, ``keep`` each under its old name, or ``mark`` the D-H frames by links
                of their own and move nothing.
            frames: Where on a joint's axis its child link's frame lies.
            tip: The chain that ``mark`` marks.
            exact: Read every number exactly as written.
            tolerance: Neighbouring axes closer to parallel than this are made parallel, rad.
            keep_link_frames: The same as ``link_frames="keep"``.

        Raises:
            ExportError: The robot cannot be written so.
        """
        if keep_link_frames and link_frames == "mark":
            raise ArgumentError('keep_link_frames and link_frames="mark" exclude each other; give one of them')
        kept: str = "keep" if keep_link_frames else link_frames
        text, notes = self._native.canonical(kept, frames, tip, exact, tolerance)
        return Robot._of((f"{self.file} (canonical)", text, {}, (), False, False, None, ""), tuple(notes))

    def edit(self, *operations: str | Sequence[str]) -> Robot:
        """The robot with its URDF edited; `denavit edit`.

        Each operation is what stands on the command line, as one string or as its words: ``"flip elbow_joint"``,
        ``"zero elbow_joint=90deg"``, ``"reroot tool0"``, ``"merge --keep tool0"``, ``"mirror xz --names left=right"``,
        ``"attach gripper.urdf --at tool0 --prefix g_"``. They run in order, and each is proved: what it promises to keep
        is compared with the new text. ``notes`` of the result state the accuracy and the changes.

        Args:
            operations: At least one.

        Raises:
            ArgumentError: An operation is impossible, with the reason, or does not keep what it promises.

        Examples:
            >>> import denavit as dn
            >>> arm = dn.load("robots/universal_robots/ur5e.urdf")
            >>> arm.edit("flip elbow_joint").notes[-1]
            'flip elbow_joint: moves as before within 1e-15 m and 1e-15 rad; elbow_joint reversed; 1 limit exchanged'
        """
        if not operations:
            raise ArgumentError('edit needs an operation, such as "flip elbow_joint"')
        words = [shlex.split(words) if isinstance(words, str) else list(words) for words in operations]
        text, notes = self._native.edit(words)
        return Robot._of((f"{self.file} (edited)", text, {}, (), False, False, None, ""), tuple(notes))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the URDF, as a whole or not at all.

        Raises:
            ArgumentError: The robot is not a tree (use ``robot.canonical()`` first), or the file cannot be written.
        """
        if self.urdf is None:
            raise ArgumentError(f"{self.file} is not a URDF; robot.canonical() makes one")
        save(path, self.urdf)

    def fingerprint(self, tolerance: float = 1e-6) -> Fingerprint:
        """A short hash of the robot; see `denavit.fingerprint`."""
        from denavit.compare import fingerprint

        return fingerprint(self, tolerance)


def load(
    source: Source,
    *,
    arguments: Mapping[str, object] | None = None,
    package_path: Sequence[str | os.PathLike[str]] = (),
    allow_any_file: bool = False,
    vendor_angles: bool = False,
    file: str | None = None,
    table_convention: str | None = None,
    table_units: str | None = None,
    convention: str | None = None,
) -> Robot:
    """Read a robot from any source.

    Args:
        source: A path, ``git:REVISION:PATH``, the text of a URDF, xacro, table or set of screw axes (str or bytes), a D-H
            table as a mapping of columns, a list of rows, a data frame or a `Table` (rad and m where a heading such as
            ``alpha [deg]`` or `table_units` says nothing else), a robot of `yourdfpy`, `urchin`, `pinocchio` or
            `roboticstoolbox`, or a name of `robot_descriptions` such as ``ur5e_description``.
        arguments: Arguments of a xacro file.
        package_path: Folders with ROS packages, or packages.
        allow_any_file: Let xacro read files outside its package and the package path.
        vendor_angles: Read the angles of a UR kinematics file as the vendor's tool means them, Rx Ry Rz.
        file: Name in messages of an unnamed source; its ending distinguishes formats.
        table_convention: Of a D-H table that does not state it: ``distal`` (also ``standard``, ``sdh``, ``DH``), ``proximal``
            (``modified``, ``mdh``, ``craig``), ``paper`` or ``hayati``.
        table_units: Of the numbers of a D-H table that state none, such as ``mm,deg``.
        convention: The same as `table_convention`.

    Raises:
        ArgumentError: The kind of source is unknown, or keywords exclude each other.
        ReadError: The file cannot be read.
        RobotError: The text is not a robot; `file`, `line`, `element` and `hint` say more.

    Examples:
        >>> import denavit as dn
        >>> arm = dn.load({"joint": ["shoulder", "elbow"], "theta": 0, "d": 0, "alpha": 0, "a": [0.4, 0.3]})
        >>> arm.chain().tips([0.0, 0.0])
        array([0.7, 0. , 0. ])
    """
    if isinstance(source, Robot):
        return source
    if convention is not None and table_convention is not None:
        raise ArgumentError("convention and table_convention are the same; give one of them")
    convention = table_convention if convention is None else convention
    name, text = text_of(source, file, convention, table_units)
    given = {key: _written(value) for key, value in (arguments or {}).items()}
    folders = tuple(os.fspath(folder) for folder in package_path)
    return Robot._of((name, text, given, folders, allow_any_file, vendor_angles, convention, table_units or ""))


def _written(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
