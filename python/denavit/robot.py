"""A robot from any source."""

from __future__ import annotations

import os
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
`yourdfpy` or `urchin`, or a name of `robot_descriptions`."""

Origin = tuple[str, str, dict[str, str], tuple[str, ...], bool, bool]


@dataclass(frozen=True, slots=True)
class ChainListing:
    """A chain from a base link to a leaf of the tree.

    Attributes:
        base: Base link.
        tip: Tip link.
        coordinates: Names of the joints that move it, in order.
        default: Whether it is the one that `Robot.chain` takes where none is named.
    """

    base: str
    tip: str
    coordinates: tuple[str, ...]
    default: bool


class Robot(Shown, Frozen):
    """A robot as its source gives it; made by `load`.

    Robots are values: they do not change, can be pickled, and are equal where their sources read the same.

    Examples:
        >>> import denavit as dn
        >>> robot = dn.load("robots/universal_robots/ur5e.urdf")
        >>> robot
        <denavit.Robot 'ur5e' from robots/universal_robots/ur5e.urdf: 8 links, 6 moving joints>
        >>> [chain.tip for chain in robot.chains if chain.default]
        ['tool0']
    """

    __slots__ = ("_native", "_origin")
    _made_by = "a robot is read, not made: use denavit.load"
    _native: _denavit.Robot
    _origin: Origin

    @classmethod
    def _of(cls, origin: Origin) -> Robot:
        file, text, arguments, package_path, allow_any_file, vendor_angles = origin
        native = _denavit.Robot.from_text(file, text, list(arguments.items()), list(package_path), allow_any_file, vendor_angles)
        if native.urdf is not None and native.file != file:
            # What a xacro file included is in the URDF: this is what is kept.
            origin = (native.file, native.urdf, {}, (), False, False)
        return cls._with(_native=native, _origin=origin)

    def __reduce__(self) -> tuple[Any, ...]:
        return Robot._of, (self._origin,)

    def _key(self) -> tuple[object, ...]:
        _, text, arguments, *others = self._origin
        return text, tuple(sorted(arguments.items())), *others

    def __repr__(self) -> str:
        counts = self._native.counts
        what = f"{counts[0]} links, {counts[1]} moving joints" if counts else f"one chain, from a {self.kind} file"
        return f"<denavit.Robot {self.name!r} from {self.file}: {what}>"

    @property
    def name(self) -> str:
        """The robot's name; empty where the source gives none."""
        return self._native.name

    @property
    def file(self) -> str:
        """What messages call its source."""
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
    def notes(self) -> tuple[str, ...]:
        """What was read otherwise than it is written."""
        return tuple(self._native.notes)

    @property
    def chains(self) -> tuple[ChainListing, ...]:
        """Every chain to a leaf."""
        return tuple(ChainListing(base, tip, tuple(names), default) for base, tip, names, default in self._native.chains())

    def chain(self, base: str | None = None, tip: str | None = None, *, exact: bool = False) -> Chain:
        """The chain between two links.

        Args:
            base: Link that it starts at; by default the root, or the link below the last floating joint.
            tip: Link that it ends at; by default the end of the longest actuated chain.
            exact: Take every number as it is written: no angle is read as the multiple of π that it was meant for.

        Raises:
            ChainError: There is no such link, or no chain between the two.
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
    ) -> Robot:
        """The same robot with its link frames on the D-H frames; `denavit export`.

        Args:
            link_frames: ``replace`` the old frames, ``keep`` each under its old name, or ``mark`` the D-H frames by links
                of their own and move nothing.
            frames: Where on a joint's axis its child link's frame lies.
            tip: The chain that ``mark`` marks.
            exact: Take every number as it is written.
            tolerance: Neighbouring axes closer to parallel than this are made parallel, rad.

        Raises:
            ExportError: The robot cannot be written so.
        """
        text, _ = self._native.canonical(link_frames, frames, tip, exact, tolerance)
        return Robot._of((f"{self.file} (canonical)", text, {}, (), False, False))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the URDF, as a whole or not at all.

        Raises:
            ArgumentError: The robot is no tree (take ``robot.canonical()`` first), or the file cannot be written.
        """
        if self.urdf is None:
            raise ArgumentError(f"{self.file} is no URDF; robot.canonical() makes one")
        save(path, self.urdf)

    def fingerprint(self, tolerance: float = 1e-6) -> Fingerprint:
        """A short hash of what the robot is; see `denavit.fingerprint`."""
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
    convention: str | None = None,
) -> Robot:
    """Read a robot from any source.

    Args:
        source: A path, ``git:REVISION:PATH``, the text of a URDF, xacro, table or set of screw axes (str or bytes), a D-H
            table as a mapping of columns, a list of rows or a data frame (θ and α in rad, d and a in m), a robot of
            `yourdfpy` or `urchin`, or a name of `robot_descriptions` such as ``ur5e_description``.
        arguments: Arguments of a xacro file.
        package_path: Folders with ROS packages, or packages.
        allow_any_file: Let xacro read files outside its package and the package path.
        vendor_angles: Read the angles of a UR kinematics file as the vendor's tool means them, Rx Ry Rz.
        file: What messages call a source that has no name; its ending tells formats apart.
        convention: Of a D-H table given as a mapping or data frame: ``distal`` (default) or ``proximal``.

    Raises:
        ReadError: The file cannot be read.
        RobotError: What was read is no robot; `file`, `line`, `element` and `hint` say more.

    Examples:
        >>> import denavit as dn
        >>> arm = dn.load({"joint": ["shoulder", "elbow"], "theta": 0, "d": 0, "alpha": 0, "a": [0.4, 0.3]})
        >>> arm.chain().tips([0.0, 0.0])
        array([0.7, 0. , 0. ])
    """
    if isinstance(source, Robot):
        return source
    name, text = text_of(source, file, convention)
    given = {key: _written(value) for key, value in (arguments or {}).items()}
    return Robot._of((name, text, given, tuple(os.fspath(folder) for folder in package_path), allow_any_file, vendor_angles))


def _written(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
