"""From measured data to a calibrated model."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from denavit import _denavit
from denavit import progress as _progress
from denavit._files import save
from denavit._frozen import Frozen
from denavit._given import array, joint_values, number, whole
from denavit._shown import Shown
from denavit.chain import Array, Chain
from denavit.commands import Commands, compensate, pairs
from denavit.errors import ArgumentError, ExportError
from denavit.measurements import Measurements, is_several, measurements
from denavit.records import Records
from denavit.results import Curve, Effect, Errors, Parameter, Prediction, Residuals, Unexplained, effects_of
from denavit.robot import Robot, load

if TYPE_CHECKING:
    from denavit.plot import Plots


@dataclass(frozen=True, slots=True)
class Found:
    """The results of a calibration as plain values: what pickling keeps."""

    json: str
    text: str
    effects: str
    poe: str
    urdf: tuple[str, str, list[str]] | ExportError | None
    stages: tuple[tuple[str, Residuals, Residuals], ...]
    notes: tuple[str, ...]

    @classmethod
    def of(cls, native: _denavit.Fit) -> Found:
        """All results of a native fit that need no further computation."""
        try:
            urdf: tuple[str, str, list[str]] | ExportError | None = native.urdf()
        except ExportError as error:
            urdf = error
        stages = tuple((name, Residuals(*train), Residuals(*test)) for name, train, test in native.residuals())
        texts = native.json(), native.text(), native.effects(), native.poe()
        return cls(*texts, urdf, stages, tuple(native.notes))


class Fit(Shown, Frozen):
    """A calibration's result; made by `calibrate`. Shows itself as `denavit calibrate` prints it.

    A pickled fit keeps its results; its `predict` and `report` repeat the fit when they are first called.
    """

    __slots__ = ("_asked", "_chain", "_found", "_json", "_native")
    _made_by = "a fit is made from data: use denavit.calibrate"
    _native: _denavit.Fit | None
    _chain: Chain
    _asked: tuple[_denavit.RowsGiven, _denavit.SearchGiven]
    _found: Found
    _json: dict[str, Any]

    @classmethod
    def _of(
        cls,
        chain: Chain,
        asked: tuple[_denavit.RowsGiven, _denavit.SearchGiven],
        found: Found,
        native: _denavit.Fit | None = None,
    ) -> Fit:
        return cls._with(_chain=chain, _asked=asked, _found=found, _native=native, _json=json.loads(found.json))

    def __reduce__(self) -> tuple[Any, ...]:
        return Fit._of, (self._chain, self._asked, self._found)

    def _key(self) -> tuple[Chain, str, str]:
        return self._chain, self._found.json, self._found.effects

    def _fitted(self) -> _denavit.Fit:
        if self._native is None:
            object.__setattr__(self, "_native", _denavit.calibrate(self._chain._native, *self._asked, None))
        assert self._native is not None
        return self._native

    def __repr__(self) -> str:
        return self._found.text.rstrip()

    @property
    def nominal(self) -> Chain:
        """The chain as drawn."""
        return self._chain

    @property
    def robot(self) -> Robot:
        """The calibrated robot: the URDF with its joint origins corrected, or screw axes where the source is no URDF.

        Raises:
            ExportError: A URDF cannot state what was fitted (scales, pitches); `chain` has it.
        """
        file = f"{self._chain.robot.file} (calibrated)"
        if isinstance(self._found.urdf, ExportError):
            raise self._found.urdf
        return load(self._found.poe if self._found.urdf is None else self._found.urdf[0], file=file)

    @property
    def chain(self) -> Chain:
        """The calibrated chain, without effects."""
        urdf = self._found.urdf
        if urdf is None or isinstance(urdf, ExportError):
            return load(self._found.poe, file=f"{self._chain.robot.file} (calibrated)").chain(exact=True)
        return self.robot.chain(self._chain.base, urdf[1], exact=True)

    @property
    def errors(self) -> Records[Errors]:
        """Errors after each stage."""
        return Records(Errors._of(stage) for stage in self._json["stages"])

    @property
    def parameters(self) -> Records[Parameter]:
        """Deviation of each axis of the calibrated robot from its nominal."""
        return Records(Parameter._of(entry) for entry in self._json["parameters"])

    @property
    def effects(self) -> Records[Effect]:
        """The selected effects."""
        return Records(Effect._of(entry) for entry in self._json["effects"])

    @property
    def effects_json(self) -> str:
        """Effects and error curves as ``denavit calibrate --effects-out`` writes them."""
        return self._found.effects

    @property
    def curves(self) -> dict[str, Curve]:
        """The error curve of each joint; 0 where the calibration has none (``effects="curves"`` searches for them)."""
        entries = {entry["joint"]: entry for entry in self._json.get("curves", ())}
        coordinates = self._chain.coordinates
        return {c.name: Curve._of(c, entries.get(c.name), self._chain, self._found.effects) for c in coordinates}

    @property
    def unexplained(self) -> Unexplained:
        """What no effect explains."""
        return Unexplained._of(self._json["unexplained"])

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on the data and on the calibrated URDF."""
        urdf = self._found.urdf
        return self._found.notes + (tuple(urdf[2]) if isinstance(urdf, tuple) else ())

    @property
    def residuals(self) -> Residuals:
        """Residuals of the calibrated robot on the fitted rows that were kept."""
        return self.residuals_of()

    def residuals_of(self, stage: str | int | None = None, *, test: bool = False) -> Residuals:
        """Residuals of a stage, by name or number (by default the one that was adopted), on fitted or held-out rows."""
        names = [name for name, _, _ in self._found.stages]
        if stage is None:
            stage = next(index for index, entry in enumerate(self._json["stages"]) if entry["adopted"])
        if isinstance(stage, str) and stage not in names:
            raise ArgumentError(f"there is no stage {stage!r}; the stages are {', '.join(names)}")
        _, train, held_out = self._found.stages[names.index(stage) if isinstance(stage, str) else stage]
        return held_out if test else train

    def fk(self, q: ArrayLike, *, given: Mapping[str, float] | None = None) -> Array:
        """Predict base_from_tip of the calibrated robot with its effects and error curves; needs no measurements.

        Args:
            q: Joint values, rad and m, shape ``(..., n)``.
            given: What effects follow, such as ``{"payload": 2.5}``.

        Returns:
            Homogeneous matrices, m, shape ``(..., 4, 4)``.

        Raises:
            ArgumentError: A quantity that an effect depends on is not given.
        """
        values = array("q", joint_values("q", q, self._chain.joints))
        n = len(self._chain)
        if values.ndim == 0 or values.shape[-1] != n:
            raise ArgumentError(
                f"q has shape {values.shape}, but the chain has {n} coordinates; give one value for each in the last axis"
            )
        rows = np.ascontiguousarray(values.reshape(-1, n))
        effects = effects_of(self._chain, self._found.effects)
        found = effects.fk(self.chain._native, rows, pairs(given)) if len(rows) else np.zeros((0, 4, 4))
        return found.reshape(*values.shape[:-1], 4, 4)

    def predict(self, later: Measurements | Any) -> Prediction:
        """Compare the calibrated model, effects included, with rows that were measured later.

        Args:
            later: Measurements, or what `calibrate` takes as such.

        Raises:
            DataError: The rows cannot be read.
            CalibrationError: They are of another kind, or of targets whose position is unknown.
        """
        errors, residuals = self._fitted().predict(measurements("later", later, self._chain)._given())
        return Prediction(json.loads(errors), Residuals(*residuals))

    def compensate(
        self,
        poses: Any,
        *,
        given: Mapping[str, float] | None = None,
        allowed_miss: tuple[float, float] = (1e-6, 1e-6),
    ) -> Commands:
        """Joint commands that reach poses with the real robot, effects included; `denavit compensate`.

        Args:
            poses: base_from_tip to reach, m, shape ``(N, 4, 4)``; or joint values of shape ``(N, n)``, which stand for the
                poses that the robot as drawn has there; or a file or data frame of either, as `denavit compensate` reads it.
            given: What effects follow, such as ``{"payload": 2.5}``.
            allowed_miss: How far a command may miss its pose and still count as reaching it, m and rad.

        Raises:
            ArgumentError: A quantity that an effect depends on is not given, or the poses are invalid.
        """
        return compensate(self, poses, given or {}, allowed_miss)

    def to_dict(self) -> dict[str, Any]:
        """The JSON of ``denavit calibrate --json``."""
        copied: dict[str, Any] = json.loads(self._found.json)
        return copied

    def to_json(self) -> str:
        """The text of ``denavit calibrate --json``."""
        return self._found.json

    def report(self, path: str | os.PathLike[str]) -> None:
        """Write the page with plots, as a whole or not at all."""
        save(path, self._fitted().html())

    def save_effects(self, path: str | os.PathLike[str]) -> None:
        """Write the effects as JSON, for ``denavit fk``, ``compensate`` and ``simulate``."""
        save(path, self._found.effects)

    @property
    def plot(self) -> Plots:
        """Plots with matplotlib: `effects()` and `residuals()`."""
        from denavit.plot import Plots

        return Plots(self)


def calibrate(
    chain: Chain | Robot | Any,
    data: Measurements | Sequence[Measurements] | Any = (),
    *,
    test: Measurements | Any | None = None,
    hold_out: float | None = None,
    hold_out_setups: Sequence[str] = (),
    tips: Sequence[str] = (),
    seed: int = 0,
    socket: Mapping[str, Measurements] | None = None,
    distance: Sequence[str] = (),
    effects: Literal["auto", "curves", "none"] | Sequence[str] | None = "auto",
    max_effects: int | None = None,
    mass: float | None = None,
    scales: Iterable[str] | Literal["all"] = (),
    pitches: Iterable[str] | Literal["all"] = (),
    zeros: Iterable[str] | Literal["all"] = (),
    gear_ratio: Mapping[str, float] | None = None,
    prior: str | os.PathLike[str] | Fit | None = None,
    progress: Callable[[str], object] | None = None,
) -> Fit:
    """Calibrate a chain from measured data; `denavit calibrate`. Ctrl-C stops it at once.

    Args:
        chain: The chain as drawn; of a robot, or of a source that `load` takes, the chain that it takes where none is named.
        data: Measurements to fit: `Measurements`, a file, a data frame, a mapping of columns, or a pair of arrays, joint values
            ``(N, n)`` and positions ``(N, 3)``. The poses of instrument and target are estimated. Several in a
            list are several setups: each has its own instrument frame and targets.
        test: Test data, never fitted; sockets in it are new places.
        hold_out: Without `test`: fraction of the rows to hold out.
        hold_out_setups: Setups, or placements of sockets, to hold out.
        tips: Several tips of the robot that are measured, the chain's among them, such as both hands: they are one fit, and
            joints that they share are fitted once. A column ``tip`` of the data names the tip of each row.
            ``fit.robot`` is calibrated as a whole, ``fit.chain`` and its effects end at the chain's tip.
        seed: Of the choice of rows held out.
        socket: Bare joint readings (no header, a column per joint) taken with a ball on the tip in a socket, by label; or read
            them with ``Measurements.read(file, socket=label)`` and give them as `data`.
        distance: Known distances between sockets: ``"front/0,front/1=50mm"``, or ``"*/0,*/1=50mm"`` for every placement; how
            sure one is may follow as ``+-0.1mm``.
        effects: Effects to search for besides geometry: ``"auto"``, kinds such as ``["backlash"]``, ``"curves"`` (error curves
            of the joints alone), or ``None``.
        max_effects: No more effects than this; by default as many as the data support.
        mass: Mass of all moving links, kg, as on the data sheet, where the description has no masses.
        scales: Joints whose scale is also fitted (the paper's normalisation factor): names, or ``"all"``.
        pitches: Revolute joints whose pitch is also fitted: names, or ``"all"``.
        zeros: Joints of which only the zeros are fitted: names, or ``"all"``. ``fit.parameters["elbow_joint.zero"]``
            is what is added to the joint's reading, rad or m.
        gear_ratio: Motor turns per joint turn, by joint.
        prior: An earlier calibration of this robot to continue from, as a fit or as the JSON file that ``Fit.save`` or
            ``denavit calibrate --json`` wrote: what it knows of the axes replaces the drawing's tolerances, and its effects
            and error curves are carried over (unless `effects` is ``None``), so that a few new poses bring the robot up to date.
        progress: Called with the current step, ``geometry``, ``effects``, ``curves``, ``judgement``; an exception that it
            raises ends the fit. By default it is shown in a notebook and on a terminal.

    Raises:
        DataError: The measurements cannot be read; `file`, `line` and `hint` say more.
        CalibrationError: No calibration is possible from them.

    Examples:
        >>> import denavit as dn
        >>> chain = dn.load("robots/universal_robots/ur5e.urdf").chain("base", "tool0")
        >>> m = dn.Measurements.read("robots/universal_robots/ur5e_tracker.csv")
        >>> fit = dn.calibrate(chain, m, hold_out=0.3, effects=None)
        >>> [errors.stage for errors in fit.errors], len(fit.parameters)
        (['nominal', 'geometric'], 24)
    """
    if test is not None and (hold_out is not None or hold_out_setups):
        raise ArgumentError("test, hold_out and hold_out_setups exclude each other; give one of them")
    if hold_out is not None and hold_out_setups:
        raise ArgumentError("hold_out and hold_out_setups exclude each other; give one of them")
    if effects is not None and not isinstance(effects, str) and not list(effects):
        effects = None
    if not isinstance(chain, Chain):
        chain = load(chain).chain()
    several = [measurements("data", part, chain) for part in (data if is_several(data) else (data,))]
    in_sockets = {label: measurements(f"socket {label}", part, chain) for label, part in (socket or {}).items()}
    sockets = [(part.socket, part) for part in several if part.socket is not None] + list(in_sockets.items())
    test = None if test is None else measurements("test", test, chain)
    rows: _denavit.RowsGiven = {
        "data": [part._given() for part in several if part.socket is None],
        "sockets": [(label, part._given()) for label, part in sockets],
        "distances": _words(distance),
        "test": None if test is None else test._given(),
        "hold_out_setups": _words(hold_out_setups),
        "tips": _words(tips),
    }
    search: _denavit.SearchGiven = {
        "scales": _words(scales),
        "pitches": _words(pitches),
        "zeros": _words(zeros),
        "effects": ["none"] if effects is None else _words(effects),
        "max_effects": None if max_effects is None else whole("max_effects", max_effects),
        "mass": None if mass is None else number("mass", mass),
        "gear_ratios": [f"{joint}={number(f'gear_ratio[{joint!r}]', ratio)!r}" for joint, ratio in (gear_ratio or {}).items()],
        "prior": earlier(prior),
        "hold_out": None if hold_out is None else number("hold_out", hold_out),
        "seed": whole("seed", seed),
    }
    if progress is not None:
        native = _denavit.calibrate(chain._native, rows, search, progress)
    else:
        with _progress.shown() as show:
            native = _denavit.calibrate(chain._native, rows, search, show)
    return Fit._of(chain, (rows, search), Found.of(native), native)


def earlier(prior: str | os.PathLike[str] | Fit | None) -> tuple[str, str] | None:
    """Name and JSON of an earlier calibration."""
    if prior is None:
        return None
    if isinstance(prior, Fit):
        return "prior", prior._found.json
    name, content = _denavit.read_bytes(os.fspath(prior))
    return name, content.decode("utf-8", errors="replace")


def _words(words: str | Iterable[str]) -> list[str]:
    return [words] if isinstance(words, str) else list(words)
