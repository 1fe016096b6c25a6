"""A robot's URDF in; screw axes, Denavit-Hartenberg tables, a verdict on edits, and a calibrated model out.

Lengths are m and angles rad everywhere; text for people is in m and degrees.
"""

from __future__ import annotations

from importlib.metadata import version as _version

from denavit.chain import Chain, Coordinate
from denavit.compare import (
    Check,
    Diff,
    Finding,
    Fingerprint,
    JointDifference,
    TipDifference,
    check,
    diff,
    fingerprint,
)
from denavit.errors import (
    ArgumentError,
    CalibrationError,
    ChainError,
    DataError,
    DenavitError,
    ExportError,
    ReadError,
    RobotError,
)
from denavit.robot import ChainListing, Robot, load
from denavit.table import Match, Note, Row, Table

__version__ = _version("denavit")

__all__ = [
    "ArgumentError",
    "CalibrationError",
    "Chain",
    "ChainError",
    "ChainListing",
    "Check",
    "Coordinate",
    "DataError",
    "DenavitError",
    "Diff",
    "ExportError",
    "Finding",
    "Fingerprint",
    "JointDifference",
    "Match",
    "Note",
    "ReadError",
    "Robot",
    "RobotError",
    "Row",
    "Table",
    "TipDifference",
    "check",
    "diff",
    "fingerprint",
    "load",
]
