"""A measurement run before it is made: which poses to measure, and simulated results."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from denavit import _denavit
from denavit._files import save
from denavit._given import array, joint_values, number, whole
from denavit.chain import Array, Chain
from denavit.errors import ArgumentError
from denavit.measurements import Measurements, Told, camera_file

if TYPE_CHECKING:
    import pandas as pd

    from denavit.fit import Fit


@dataclass(frozen=True, slots=True, eq=False, repr=False)
class Plan:
    """Poses to measure.

    Attributes:
        q: The poses, rad and m, shape ``(count, n)``.
        json: Everything, as ``denavit plan --json`` prints it.
        csv: The poses as a file.
        text: Their expected benefit as text.
    """

    q: Array
    json: dict[str, Any]
    csv: str
    text: str

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the poses as CSV, as a whole or not at all."""
        save(path, self.csv)

    def __len__(self) -> int:
        return len(self.q)

    def __iter__(self) -> Iterator[Array]:
        return iter(self.q)

    def __getitem__(self, at: Any) -> Array:
        found: Array = self.q[at]
        return found

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        return self.q.astype(dtype or np.float64, copy=False)

    def to_pandas(self) -> pd.DataFrame:
        """A row for each pose, a column for each joint, rad and m. Needs pandas."""
        import pandas as pd

        return pd.DataFrame(self.q, columns=list(self.json["joints"]))

    def __eq__(self, other: object) -> bool:
        return (self.json, self.csv) == (other.json, other.csv) if isinstance(other, Plan) else NotImplemented

    def __hash__(self) -> int:
        return hash(self.csv)

    def __repr__(self) -> str:
        return self.text.rstrip()


@dataclass(frozen=True, slots=True)
class Simulation:
    """A simulated run.

    Attributes:
        data: What was measured.
        test: Later measurements of the same robot, if requested.
        truth: The true values, as ``denavit simulate --truth`` writes them.
    """

    data: Measurements
    test: Measurements | None
    truth: dict[str, Any]

    def __hash__(self) -> int:
        return hash((self.data, self.test))


def _joint_rows(name: str, q: ArrayLike | Plan | None, chain: Chain) -> Array | None:
    if q is None:
        return None
    found: Array = array(name, q.q if isinstance(q, Plan) else joint_values(name, q, chain.joints))
    if found.ndim != 2:
        raise ArgumentError(f"{name} has shape {found.shape}; give one row of joint values per pose, shape (N, {len(chain)})")
    return found


def _numbers(name: str, values: Sequence[float], count: int | None = None) -> list[float]:
    """Numbers, of which there must be `count`."""
    found: list[float] = array(name, list(values)).tolist()
    if count is not None and len(found) != count:
        raise ArgumentError(f"{name} has {len(found)} numbers; give {count}")
    return found


def plan(
    chain: Chain,
    count: int,
    measure: str,
    candidates: ArrayLike | None,
    spread: int,
    box: Sequence[float],
    target: Sequence[float],
    anchor: Sequence[float] | None,
    prior: tuple[str, str] | None,
    seed: int,
) -> Plan:
    """See `Chain.plan`."""
    rows = _joint_rows("candidates", candidates, chain)
    away = None if anchor is None else _numbers("anchor", anchor, 3)
    where = _numbers("box", box), _numbers("target", target, 3), away
    counts = whole("count", count), whole("spread", spread)
    found, csv, text, q = _denavit.plan(chain._native, counts[0], measure, rows, counts[1], *where, prior, whole("seed", seed))
    return Plan(q, json.loads(found), csv, text)


def tell_apart(fit: Fit, count: int, candidates: ArrayLike | None, spread: int, box: Sequence[float], seed: int) -> Plan:
    """See `Chain.plan`."""
    rows = _joint_rows("candidates", candidates, fit.nominal)
    counts = whole("count", count), whole("spread", spread)
    found, csv, text, q = _denavit.tell_apart(
        fit._fitted(), counts[0], rows, counts[1], _numbers("box", box), whole("seed", seed)
    )
    return Plan(q, json.loads(found), csv, text)


def simulate(
    chain: Chain,
    rows: int,
    q: ArrayLike | Plan | None,
    test: int | None,
    measure: str,
    targets: int,
    seed: int,
    geometry_error: tuple[float, float],
    noise: tuple[float, float],
    outliers: float,
    effect: Sequence[str],
    effects: Fit | None,
    columns: Sequence[str],
    camera: str | os.PathLike[str] | None,
    board: str | None,
    on_hand: bool,
    pixel_noise: float,
    sight_noise: tuple[float, float],
    repeatability: float | Mapping[str, float],
) -> Simulation:
    """See `Chain.simulate`."""
    names = [coordinate.name for coordinate in chain.coordinates]
    if isinstance(repeatability, Mapping):
        if unknown := [name for name in repeatability if name not in names]:
            raise ArgumentError(f'repeatability: there is no joint "{unknown[0]}"; there are {", ".join(names)}')
        spreads = [number(f"repeatability[{name!r}]", repeatability.get(name, 0.0)) for name in names]
    else:
        spreads = [number("repeatability", repeatability)] * len(names)
    saved = None if effects is None else effects.effects_json
    lens = camera_file(camera, board, on_hand)
    data, later, truth = _denavit.simulate(
        chain._native,
        whole("rows", rows),
        None if test is None else whole("test", test),
        measure,
        whole("targets", targets),
        whole("seed", seed),
        geometry_error,
        noise,
        outliers,
        list(effect),
        saved,
        list(columns),
        _joint_rows("q", q, chain),
        lens,
        board,
        on_hand,
        pixel_noise,
        sight_noise,
        spreads,
    )
    name = f"<simulated {chain.name}>"
    told = Told(camera=lens, board=board, on_hand=on_hand)
    measured_later = None if later is None else Measurements(later, f"<simulated {chain.name}, later>", told=told)
    return Simulation(Measurements(data, name, told=told), measured_later, json.loads(truth))
