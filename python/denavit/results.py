"""The results of a calibration, part by part."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from denavit import _denavit
from denavit._given import array
from denavit.chain import Array, Chain, Coordinate
from denavit.records import html_table, people, written

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, slots=True)
class Errors:
    """Errors after a stage: numbers by name as in the JSON, such as ``position_rms_m``; m and rad.

    Attributes:
        stage: ``nominal``, ``geometric``, ``geometric + <kind>(<where>)`` …
        train: On the fitted rows, rejected ones left out.
        test: On the held-out rows; empty without any.
        adopted: Whether this stage is the calibrated robot.
    """

    stage: str
    train: dict[str, float]
    test: dict[str, float]
    adopted: bool

    @classmethod
    def _of(cls, entry: dict[str, Any]) -> Errors:
        return cls(entry["name"], dict(entry["train"]), dict(entry.get("test", {})), entry["adopted"])


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter of the calibrated robot compared with its nominal value.

    Attributes:
        name: Such as ``elbow_joint.turn_x``.
        joint: Its joint.
        change: Deviation from the nominal value, in `unit`.
        sd: Standard deviation of that, the prior included.
        interval: Half the width of the interval that holds the true value with 95 %.
        unit: ``rad``, ``m``, ``m/rad`` or ``1``.
        held_by_prior: Fraction of the variance from the prior: 1 if the data do not determine it.
    """

    name: str
    joint: str
    change: float
    sd: float
    interval: float
    unit: str
    held_by_prior: float

    @classmethod
    def _of(cls, entry: dict[str, Any]) -> Parameter:
        names = ("parameter", "joint", "change", "std", "half_interval_95", "unit", "held_by_prior")
        return cls(*(entry[name] for name in names))


@dataclass(frozen=True, slots=True)
class Coefficient:
    """A number of an effect.

    Attributes:
        name: Its name.
        value: In `unit`.
        sd: Its standard deviation; ``None`` for what was chosen rather than fitted.
        unit: SI.
    """

    name: str
    value: float
    sd: float | None
    unit: str

    def __str__(self) -> str:
        shown = people({"value": self.value, "sd": self.sd, "unit": self.unit})
        spread = "" if self.sd is None else f" ± {written(shown['sd'])}"
        return f"{self.name} {written(shown['value'])}{spread} {shown['unit']}".rstrip()


@dataclass(frozen=True, slots=True)
class Rival:
    """An alternative that the data cannot distinguish from an effect.

    Attributes:
        kind: Its kind.
        at: Where it would act.
        probability: That it acts instead; ``None`` where the calibration states none.
    """

    kind: str
    at: str
    probability: float | None = None

    def __str__(self) -> str:
        return f"{self.kind} at {self.at}"


@dataclass(frozen=True, slots=True)
class Effect:
    """A selected physical effect.

    Attributes:
        kind: Such as ``joint_compliance``; docs/effects-tables.md lists them.
        at: The joint, or ``base``, ``target``, ``instrument``, …
        value: The first coefficient, in `unit`.
        sd: Its standard deviation; ``None`` where none is stated.
        unit: SI.
        probability: That it acts; ``None`` where the calibration states none.
        rivals: Alternatives that the data cannot distinguish from it.
        coefficients: All coefficients.
        covariate: The recorded quantity that drives it.
        p_value: As in the JSON of the calibration; ``None`` where it states none.
        delta_bic: As in the JSON of the calibration; ``None`` where it states none.
    """

    kind: str
    at: str
    value: float
    sd: float | None
    unit: str
    probability: float | None
    rivals: tuple[Rival, ...]
    coefficients: tuple[Coefficient, ...]
    covariate: str | None
    p_value: float | None
    delta_bic: float | None

    @classmethod
    def _of(cls, entry: dict[str, Any]) -> Effect:
        of = entry["parameters"].items()
        coefficients = tuple(Coefficient(name, v["value"], v.get("std"), v["unit"]) for name, v in of)
        rivals = entry.get("rivals") or entry.get("ambiguous_with") or ()
        first = coefficients[0]
        return cls(
            kind=entry["kind"],
            at=entry.get("joint") or entry.get("where") or "",
            value=first.value,
            sd=first.sd,
            unit=first.unit,
            probability=entry.get("probability"),
            rivals=tuple(_rival(rival) for rival in rivals),
            coefficients=coefficients,
            covariate=entry.get("covariate"),
            p_value=entry.get("p_value"),
            delta_bic=entry.get("delta_bic"),
        )


def _rival(entry: dict[str, Any]) -> Rival:
    return Rival(entry["kind"], entry.get("joint") or entry.get("where") or "", entry.get("probability"))


@dataclass(frozen=True, slots=True)
class Curve:
    """The error of a joint's value as a smooth function of its own reading, whatever its cause; call it with readings.

    Every joint of a fit has one. Where none was searched for or selected, it is 0 and its standard deviation is
    not known.

    Attributes:
        joint: The joint.
        fitted: Whether the calibration has a curve of this joint.
        unit: Of readings and errors: ``rad`` or ``m``.
        rms: Root mean square over the range of the data, about the mean.
        length: Distance of readings over which the curve changes.
        range: Lowest and highest reading in the data.
        sd_without_data: Standard deviation of the curve far from the data, where the curve is 0.
    """

    joint: str
    fitted: bool
    unit: str
    rms: float
    length: float | None
    range: tuple[float, float] | None
    sd_without_data: float | None
    _chain: Chain = field(repr=False)
    _effects: str = field(repr=False)

    @classmethod
    def _of(cls, coordinate: Coordinate, entry: dict[str, Any] | None, chain: Chain, effects: str) -> Curve:
        if entry is None:
            unit = "rad" if coordinate.quantity == "angle" else "m"
            return cls(coordinate.name, False, unit, 0.0, None, None, None, chain, effects)
        ends = entry["table"][0]["at"], entry["table"][-1]["at"]
        numbers = entry["rms"], entry["length"], ends, entry["std_without_data"]
        return cls(entry["joint"], True, entry["unit"], *numbers, chain, effects)

    def __call__(self, q: ArrayLike) -> Array:
        """The correction to add to readings `q` (rad, m; any shape) to get the joint's true value; 0 far from the data."""
        return self._at(q)[0]

    def sd(self, q: ArrayLike) -> Array:
        """Standard deviation of the curve at readings `q`, rad or m, of the shape of `q`; NaN where there is no curve."""
        return self._at(q)[1]

    def _at(self, q: ArrayLike) -> tuple[Array, Array]:
        readings = np.asarray(array("q", q)).reshape(np.shape(q))
        found = effects_of(self._chain, self._effects).curve(self.joint, np.ascontiguousarray(readings).reshape(-1))
        if found is None:
            return np.zeros(readings.shape), np.full(readings.shape, np.nan)
        values, spread = found
        return values.reshape(readings.shape), spread.reshape(readings.shape)


@lru_cache(maxsize=32)
def effects_of(chain: Chain, text: str) -> _denavit.Effects:
    """The effects of a chain, from their JSON."""
    return _denavit.Effects(chain._native, text)


@dataclass(frozen=True, slots=True)
class Place:
    """A quantity that explains part of the residuals.

    Attributes:
        of: A joint, a recorded quantity, or ``run order``.
        share: Fraction of the residual sum of squares that functions of it explain.
    """

    of: str
    share: float


@dataclass(frozen=True, slots=True)
class Unexplained:
    """What no effect explains.

    Attributes:
        structured: Whether the residuals have structure.
        p_value: Probability of such structure by chance.
        places: Where it is, the largest share first.
    """

    structured: bool
    p_value: float
    places: tuple[Place, ...]

    @classmethod
    def _of(cls, entry: dict[str, Any]) -> Unexplained:
        def places(entries: Iterable[dict[str, Any]]) -> Iterable[Place]:
            return (Place(place.get("joint") or place.get("covariate") or "run order", place["share"]) for place in entries)

        return cls(entry["structured"], entry["p_value"], tuple(places(entry["where"])))


@dataclass(frozen=True, slots=True, eq=False)
class Residuals:
    """Measured minus predicted values, in the base frame.

    Attributes:
        rows: Index of each observation's row among the rows of its part, shape ``(k,)``.
        place: Errors of the lengths, m, shape ``(k, 3)``; a single number is in the first column.
        turn: Errors of the orientation as rotation vectors, rad, shape ``(k, 3)``; 0 where none is measured.
    """

    rows: NDArray[np.uintp]
    place: Array
    turn: Array

    @property
    def distance(self) -> Array:
        """Norms of the errors of the lengths, m, shape ``(k,)``."""
        return np.asarray(np.linalg.norm(self.place, axis=1), dtype=np.float64)

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[tuple[int, Array, Array]]:
        """Row, errors of its lengths (m), errors of its orientation (rad), one after the other."""
        return iter(zip(self.rows.tolist(), self.place, self.turn, strict=True))

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        """Errors of lengths (m), then of orientation (rad), shape ``(k, 6)``."""
        return np.hstack([self.place, self.turn]).astype(dtype or np.float64, copy=False)

    def to_pandas(self) -> pd.DataFrame:
        """A row for each observation, indexed by its row: x, y, z and their norm in m, rx, ry, rz in rad. Needs pandas."""
        import pandas as pd

        columns = ["x", "y", "z", "rx", "ry", "rz"]
        frame = pd.DataFrame(np.asarray(self), columns=columns, index=pd.Index(self.rows.astype(np.int64), name="row"))
        return frame.assign(distance=self.distance)

    def _repr_html_(self) -> str:
        if not len(self):
            return "<p>no residuals</p>"
        mm = 1e3 * self.distance
        columns = {"observations": str(len(self)), "rms, mm": f"{float(np.sqrt(np.mean(mm**2))):.4g}"}
        columns |= {
            f"{name}, mm": f"{float(np.quantile(mm, share)):.4g}"
            for name, share in (("median", 0.5), ("95 %", 0.95), ("largest", 1.0))
        }
        if self.turn.any():
            columns["rms, mrad"] = f"{1e3 * float(np.sqrt(np.mean(np.sum(self.turn**2, axis=1)))):.4g}"
        return html_table([list(columns), list(columns.values())])

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Residuals):
            return NotImplemented
        pairs = ((self.rows, other.rows), (self.place, other.place), (self.turn, other.turn))
        return all(np.array_equal(a, b) for a, b in pairs)

    def __hash__(self) -> int:
        return hash((self.rows.tobytes(), self.place.tobytes()))

    def __repr__(self) -> str:
        rms = 1e3 * float(np.sqrt(np.mean(self.distance**2))) if len(self) else 0.0
        return f"<denavit.Residuals of {len(self)} observations, {rms:.4g} mm rms>"


@dataclass(frozen=True, slots=True)
class Prediction:
    """Rows measured later, compared with the calibrated model.

    Attributes:
        errors: Numbers by name, such as ``position_rms_m``; m and rad.
        residuals: Row by row.
    """

    errors: dict[str, float]
    residuals: Residuals

    def __len__(self) -> int:
        return len(self.residuals)

    def __iter__(self) -> Iterator[tuple[int, Array, Array]]:
        return iter(self.residuals)

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return np.asarray(self.residuals, dtype=dtype)

    def to_pandas(self) -> pd.DataFrame:
        """The residuals, a row for each observation. Needs pandas."""
        return self.residuals.to_pandas()

    def _repr_html_(self) -> str:
        shown = {name: value for name, value in people(self.errors).items() if value is not None}
        return html_table([["error", ""], *([name, written(value)] for name, value in shown.items())])

    def __hash__(self) -> int:
        return hash(self.residuals)
