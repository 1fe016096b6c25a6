"""A robot's URDF in; screw axes, Denavit-Hartenberg tables, a verdict on edits, and a calibrated model out.

Lengths are m and angles rad everywhere; text for people is in m and degrees.
"""

from __future__ import annotations

from importlib.metadata import version as _version

from denavit import fleet
from denavit.chain import Chain, Coordinate, Solutions
from denavit.commands import Commands
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
    ManifestError,
    ReadError,
    RobotError,
    StoreError,
)
from denavit.fit import Fit, calibrate
from denavit.handeye import HandEye, hand_eye
from denavit.measurements import Measurements, Told
from denavit.records import Records
from denavit.results import (
    Coefficient,
    Curve,
    Effect,
    Errors,
    Parameter,
    Place,
    Prediction,
    Residuals,
    Rival,
    Unexplained,
)
from denavit.robot import ChainListing, Robot, load
from denavit.run import Plan, Simulation
from denavit.table import Match, Note, Row, Table
from denavit.view import View, explore

__version__ = _version("denavit")

show_explorer: bool = False
"""Whether a notebook shows robots, chains, diffs and fits in the explorer, as `explore` does: three megabytes
for each cell. Otherwise it shows their text."""

__all__ = [
    "ArgumentError",
    "CalibrationError",
    "Chain",
    "ChainError",
    "ChainListing",
    "Check",
    "Coefficient",
    "Commands",
    "Coordinate",
    "Curve",
    "DataError",
    "DenavitError",
    "Diff",
    "Effect",
    "Errors",
    "ExportError",
    "Finding",
    "Fingerprint",
    "Fit",
    "HandEye",
    "JointDifference",
    "ManifestError",
    "Match",
    "Measurements",
    "Note",
    "Parameter",
    "Place",
    "Plan",
    "Prediction",
    "ReadError",
    "Records",
    "Residuals",
    "Rival",
    "Robot",
    "RobotError",
    "Row",
    "Simulation",
    "Solutions",
    "StoreError",
    "Table",
    "TipDifference",
    "Told",
    "Unexplained",
    "View",
    "calibrate",
    "check",
    "diff",
    "explore",
    "fingerprint",
    "fleet",
    "hand_eye",
    "load",
    "show_explorer",
]


def __dir__() -> list[str]:
    return [*__all__, "__doc__", "__file__", "__name__", "__version__"]
