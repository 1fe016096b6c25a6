"""Joint commands that compensate a robot's errors."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from denavit import _denavit
from denavit._files import save
from denavit._given import array, is_frame, joint_values, number
from denavit.chain import Array, Chain
from denavit.errors import ArgumentError
from denavit.measurements import Measurements
from denavit.results import effects_of

if TYPE_CHECKING:
    import pandas as pd

    from denavit.fit import Fit


@dataclass(frozen=True, slots=True, repr=False)
class Commands:
    """Joint commands that reach poses with the real robot.

    Attributes:
        json: Everything, as ``denavit compensate --json`` prints it.
        csv: The commands as a file.
        text: The expected result as text; names the poses that are out of reach.
        notes: What they do not take into account.
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
        """Joint values that the nominal robot would need, rad and m, shape ``(N, n)``."""
        return np.array([list(entry["nominal"].values()) for entry in self.json["commands"]], dtype=np.float64)

    @property
    def position_errors(self) -> Array:
        """Expected position error of each command, m, shape ``(N,)``."""
        return self._column("position_error_m")

    @property
    def uncompensated(self) -> Array:
        """Position error of the nominal robot's command, m, shape ``(N,)``."""
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

    def __iter__(self) -> Iterator[Array]:
        return iter(self.q)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self.q.astype(dtype or np.float64, copy=False)

    def to_pandas(self) -> pd.DataFrame:
        """One row per command: joint values, rad and m, the state, and the expected errors, m. Needs pandas."""
        import pandas as pd

        rest = {"state": self.states, "position_error_m": self.position_errors, "uncompensated_m": self.uncompensated}
        return pd.DataFrame([entry["joints"] for entry in self.json["commands"]]).assign(**rest)

    def __hash__(self) -> int:
        return hash(self.csv)

    def __repr__(self) -> str:
        return self.text.rstrip()


def compensate(fit: Fit, poses: Any, given: Mapping[str, float], allowed_miss: tuple[float, float]) -> Commands:
    """Commands with which the calibrated robot reaches poses."""
    effects = effects_of(fit.nominal, fit.effects_json)
    wanted = _wanted(poses, fit.nominal)
    found, csv, text, notes = effects.compensate(fit.nominal._native, fit.chain._native, wanted, pairs(given), allowed_miss)
    return Commands(json.loads(found), csv, text, tuple(notes))


def pairs(given: Mapping[str, float] | None) -> list[tuple[str, float]]:
    """The quantities that effects depend on, for the native part."""
    return [(str(name), number(f"given[{name!r}]", value)) for name, value in (given or {}).items()]


def _wanted(poses: Any, chain: Chain) -> _denavit.Wanted:
    if isinstance(poses, Measurements):
        return poses._given()
    if isinstance(poses, str | os.PathLike):
        return Measurements.read(poses)._given()
    if is_frame(poses):
        return Measurements.from_pandas(poses, file="<poses>")._given()
    if isinstance(poses, Mapping):
        poses = joint_values("poses", poses, chain.joints)
    found: Array = array("poses", poses)
    if found.ndim not in (2, 3):
        shape = "poses of shape (N, 4, 4), joint values of shape (N, n), a data frame or a file"
        raise ArgumentError(f"poses has shape {found.shape}; give {shape}")
    return found[None] if found.shape == (4, 4) else found
