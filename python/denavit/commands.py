"""Joint commands that make up for the errors of a robot."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from denavit import _denavit
from denavit._files import save
from denavit.chain import Array
from denavit.errors import ArgumentError
from denavit.measurements import Measurements
from denavit.results import effects_of

if TYPE_CHECKING:
    from denavit.fit import Fit


@dataclass(frozen=True, slots=True, repr=False)
class Commands:
    """Joint commands that reach poses with the robot as it is.

    Attributes:
        json: Everything, as ``denavit compensate --json`` prints it.
        csv: The commands as a file.
        text: What is expected of them, in words; names the poses that are out of reach.
        notes: What has no part in them.
    """

    json: dict[str, Any]
    csv: str
    text: str
    notes: tuple[str, ...] = ()

    @property
    def q(self) -> Array:
        """Joint values to command, rad and m, shape ``(N, n)``."""
        return np.array([list(entry["joints"].values()) for entry in self.json["commands"]], dtype=np.float64)

    @property
    def nominal(self) -> Array:
        """Joint values that the robot as drawn would need, rad and m, shape ``(N, n)``."""
        return np.array([list(entry["nominal"].values()) for entry in self.json["commands"]], dtype=np.float64)

    @property
    def position_errors(self) -> Array:
        """How far each command is expected to miss, m, shape ``(N,)``."""
        return self._column("position_error_m")

    @property
    def uncompensated(self) -> Array:
        """How far the command of the robot as drawn would miss, m, shape ``(N,)``."""
        return self._column("uncompensated_m")

    @property
    def states(self) -> tuple[str, ...]:
        """``reached``, ``outside of limits`` or ``out of reach``, for each."""
        return tuple(entry["state"] for entry in self.json["commands"])

    @property
    def reached(self) -> bool:
        """Whether every command reaches its pose and keeps the limits."""
        return all(state == "reached" for state in self.states)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the commands as CSV, as a whole or not at all."""
        save(path, self.csv)

    def _column(self, name: str) -> Array:
        return np.array([entry[name] for entry in self.json["commands"]], dtype=np.float64)

    def __len__(self) -> int:
        return len(self.json["commands"])

    def __hash__(self) -> int:
        return hash(self.csv)

    def __repr__(self) -> str:
        return self.text.rstrip()


def compensate(fit: Fit, poses: Any, given: Mapping[str, float], allowed_miss: tuple[float, float]) -> Commands:
    """Commands with which the calibrated robot reaches poses."""
    effects = effects_of(fit.nominal, fit.effects_json)
    pairs = [(str(name), float(value)) for name, value in given.items()]
    wanted = _wanted(poses)
    found, csv, text, notes = effects.compensate(fit.nominal._native, fit.chain._native, wanted, pairs, allowed_miss)
    return Commands(json.loads(found), csv, text, tuple(notes))


def _wanted(poses: Any) -> _denavit.Wanted:
    if isinstance(poses, Measurements):
        return poses._given()
    if isinstance(poses, str | os.PathLike):
        return Measurements.read(poses)._given()
    if hasattr(poses, "columns"):
        return Measurements.from_pandas(poses, file="<poses>")._given()
    array = np.ascontiguousarray(poses, dtype=np.float64)
    if array.ndim not in (2, 3):
        shape = "poses of shape (N, 4, 4), joint values of shape (N, n), a data frame or a file"
        raise ArgumentError(f"poses has shape {array.shape}; give {shape}")
    if array.shape == (4, 4):
        array = array[None]
    return array
