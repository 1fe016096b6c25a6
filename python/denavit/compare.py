"""Is it still the same robot? Differences with bounds, fingerprints, rules for URDF files."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from denavit import _denavit
from denavit._given import whole
from denavit._shown import Shown
from denavit.bridges.sources import text_of
from denavit.errors import ArgumentError
from denavit.records import Records
from denavit.robot import Robot, Source, load

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True)
class TipDifference:
    """Displacement of a leaf link's frame, in the root frame.

    Attributes:
        tip: The link.
        sampled: Largest displacement found by sampling and ascent, m.
        bound: No configuration within the joint ranges displaces the tip by more, m.
        at: The joint values (rad, m) at which `sampled` occurs.
    """

    tip: str
    sampled: float
    bound: float
    at: tuple[tuple[str, float], ...]


@dataclass(frozen=True, slots=True)
class JointDifference:
    """A joint and what changed about it.

    Attributes:
        joint: Its name in a.
        changes: What changed, as in the JSON of ``denavit diff``, each with its kind as ``change``.
        renamed: Its name in b, where that is another.
        line: Line of its element in b's file.
    """

    joint: str
    changes: tuple[dict[str, Any], ...]
    renamed: str | None = None
    line: int | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Diff(Shown):
    """How two robots differ; shows itself as `denavit diff` prints it. True in conditions if they differ.

    Attributes:
        same: Whether they are the same within the tolerances.
        joints: Joints with changes, in a's order from the root.
        tips: Every leaf link that both have, by how far it moved.
        parts: Joints and links that only one of the two has, and what they carry, as in the JSON.
        notes: Changes without effect on motion, such as new names or another order.
        reports: The report in every format of `denavit diff`, by name: text, json, junit, sarif, github, markdown.
        robots: The two.
    """

    same: bool
    joints: tuple[JointDifference, ...]
    tips: tuple[TipDifference, ...]
    parts: tuple[dict[str, Any], ...]
    notes: tuple[str, ...]
    reports: dict[str, str]
    robots: tuple[Robot, Robot] = field(compare=False)

    @property
    def tip(self) -> TipDifference | None:
        """The tip that is displaced most; ``None`` where the two have no tip in common."""
        return max(self.tips, key=lambda tip: tip.sampled, default=None)

    def to_dict(self) -> dict[str, Any]:
        """The JSON of ``denavit diff --json``."""
        found: dict[str, Any] = json.loads(self.reports["json"])
        return found

    def __bool__(self) -> bool:
        return not self.same

    def __hash__(self) -> int:
        return hash(self.reports["json"])

    def __repr__(self) -> str:
        return self.reports["text"].rstrip()


def diff(
    a: Source,
    b: Source,
    *,
    tolerance_m: float = 1e-7,
    tolerance_rad: float = 1e-6,
    only: Literal["kinematics"] | None = None,
    up_to_base: bool = False,
    up_to_zeros: bool = False,
    count_names: bool = False,
    q_range: tuple[float, float] | Mapping[str, tuple[float, float]] | None = None,
    samples: int = 4096,
    seed: int = 1,
) -> Diff:
    """Compare two robots: per joint, and at the tips, sampled and bounded.

    Args:
        a: The robot as it was: any source.
        b: The robot as it is: any source.
        tolerance_m: Lengths closer than this are equal, m.
        tolerance_rad: Angles closer than this are equal, rad.
        only: ``kinematics``: no inertials, shapes, speeds and efforts.
        up_to_base: Ignore the robot's pose on its root link.
        up_to_zeros: Ignore joint zero offsets and senses.
        count_names: Also count added, removed and renamed links, joints and frames.
        q_range: Range to sample instead of the joint limits, rad or m: one for all joints, or by name.
        samples: Configurations to sample.
        seed: Start of the low-discrepancy sequence.

    Examples:
        >>> import denavit as dn
        >>> d = dn.diff("robots/universal_robots/ur5e.urdf", "robots/universal_robots/ur5e_dh.csv")
        >>> d.same, d.tip.bound < 1e-9
        (True, True)
    """
    if q_range is None:
        ranges: list[tuple[str | None, float, float]] = []
    elif isinstance(q_range, Mapping):
        ranges = [(name, *ends) for name, ends in q_range.items()]
    else:
        ranges = [(None, *q_range)]
    before, after = load(a), load(b)
    found = _denavit.compare(
        before._native,
        after._native,
        tolerance_m,
        tolerance_rad,
        only == "kinematics",
        up_to_base,
        up_to_zeros,
        count_names,
        ranges,
        whole("samples", samples),
        whole("seed", seed),
    )
    reports = {name: found.render(name) for name in ("text", "json", "junit", "sarif", "github", "markdown")}
    values = json.loads(reports["json"])
    return Diff(
        same=found.same,
        joints=tuple(
            JointDifference(entry["joint"], tuple(entry["changes"]), entry.get("renamed"), entry.get("line"))
            for entry in values["joints"]
        ),
        tips=tuple(
            TipDifference(
                tip["tip"],
                tip["sampled_m"],
                tip["bound_m"],
                tuple((value["joint"], value["value"]) for value in tip["at"]),
            )
            for tip in values["tips"]
        ),
        parts=tuple(values["parts"]),
        notes=tuple(values["notes"]),
        reports=reports,
        robots=(before, after),
    )


@dataclass(frozen=True, slots=True, repr=False)
class Fingerprint:
    """A short hash of a robot that does not depend on link frames; `str` gives what `denavit fingerprint` prints.

    Attributes:
        text: The complete fingerprint.
        tolerance: Cell size: m, rad, and relative for masses.
        motion: Of axes, kinds, pitches, limits, couplings and empty leaf frames.
        matter: Of masses, shapes, speeds and efforts.
    """

    text: str
    tolerance: float
    motion: str
    matter: str
    other_motions: tuple[str, ...] = ()
    other_matters: tuple[str, ...] = ()

    def matches(self, written: str, *, only_motion: bool = False) -> bool:
        """Whether a recorded fingerprint is that of this robot, or of one that moves in the same way."""
        return _denavit.fingerprint_matches(
            self.tolerance,
            self.motion,
            self.matter,
            list(self.other_motions),
            list(self.other_matters),
            written,
            only_motion,
        )

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<denavit.Fingerprint {self.text}>"


def fingerprint(robot: Source, tolerance: float = 1e-6) -> Fingerprint:
    """A short hash of the robot, to fix in a test.

    Examples:
        >>> import denavit as dn
        >>> pinned = str(dn.fingerprint("robots/universal_robots/ur5e.urdf"))
        >>> dn.fingerprint("robots/universal_robots/ur5e.urdf").matches(pinned)
        True
    """
    written, text = _denavit.fingerprint(load(robot)._native, tolerance)
    found = json.loads(written)
    others = {name: tuple(found.get(name, ())) for name in ("other_motions", "other_matters")}
    return Fingerprint(text, found["tolerance"], found["motion"], found["matter"], **others)


@dataclass(frozen=True, slots=True)
class Finding:
    """A finding of a rule in a URDF.

    Attributes:
        rule: Its code.
        level: ``error``, ``warning`` or ``note``.
        file: The file.
        line: The line, from 1.
        element: The element.
        message: What is wrong, and what to do.
        fixable: Whether ``denavit check --fix`` can fix it.
    """

    rule: str
    level: str
    file: str
    line: int
    element: str
    message: str
    fixable: bool


@dataclass(frozen=True, slots=True, repr=False)
class Check:
    """What the rules found; shows itself as `denavit check` prints it.

    Attributes:
        ok: Whether no finding is an error.
        findings: In the order of the file.
        reports: The report in every format of `denavit check`, by name.
    """

    ok: bool
    findings: tuple[Finding, ...]
    reports: dict[str, str]

    def __bool__(self) -> bool:
        return self.ok

    def __len__(self) -> int:
        return len(self.findings)

    def __iter__(self) -> Iterator[Finding]:
        return iter(self.findings)

    def __getitem__(self, at: int) -> Finding:
        return self.findings[at]

    def to_pandas(self) -> pd.DataFrame:
        """A row for each finding. Needs pandas."""
        return Records(self.findings).to_pandas()

    def _repr_html_(self) -> str:
        return Records(self.findings)._repr_html_() if self.findings else "<p>nothing found</p>"

    def __hash__(self) -> int:
        return hash(self.reports["json"])

    def __repr__(self) -> str:
        return self.reports["text"].rstrip() or "nothing found"


def check(
    source: Source,
    *,
    allow: Sequence[str] = (),
    deny: Sequence[str] = (),
    config: str | os.PathLike[str] | None = None,
    package_path: Sequence[str | os.PathLike[str]] = (),
) -> Check:
    """Check a URDF against numbered rules.

    Args:
        source: A path, ``git:REVISION:PATH``, text, bytes, or a robot.
        allow: Rules to leave out, by code or name; ``all`` leaves out all that are not denied.
        deny: Rules whose findings are errors, by code or name.
        config: Configuration file; by default ``denavit.toml`` beside the file or in a folder above.
        package_path: Folders with ROS packages, or packages, to find meshes in.

    Examples:
        >>> import denavit as dn
        >>> found = dn.check("robots/universal_robots/ur5e.urdf", allow=["D035"])
        >>> found.ok, len(found)
        (True, 0)
    """
    if isinstance(source, Robot) and source.urdf is None:
        raise ArgumentError(
            f"{source.file} is not a URDF, and the rules are about URDF files; check robot.canonical()", file=source.file
        )
    file, text = (source.file, source.urdf or "") if isinstance(source, Robot) else text_of(source, None)
    folders = [os.fspath(folder) for folder in package_path]
    chosen = None if config is None else os.fspath(config)
    found = _denavit.check(file, text, list(allow), list(deny), chosen, folders)
    reports = {name: found.render(name) for name in ("text", "json", "junit", "sarif", "github", "markdown")}
    findings = tuple(Finding(**entry) for entry in json.loads(reports["json"])["findings"])
    return Check(not found.fails, findings, reports)
