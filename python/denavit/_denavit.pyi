from collections.abc import Callable
from pathlib import Path
from typing import TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array = NDArray[np.float64]
_Residuals = tuple[NDArray[np.uintp], _Array, _Array]

COLUMNS_IN_WORDS: str

class Given(TypedDict):
    name: str
    content: str | bytes
    units: str
    columns: tuple[str, str] | None
    euler: str | None
    quaternion: str | None
    rotation_vector: bool
    joints: tuple[str, str] | None
    camera: tuple[str, str] | None
    board: str | None
    on_hand: bool

Wanted = Given | _Array

class RowsGiven(TypedDict):
    data: list[Given]
    sockets: list[tuple[str, Given]]
    distances: list[str]
    test: Given | None
    hold_out_setups: list[str]
    tips: list[str]

class SearchGiven(TypedDict):
    scales: list[str]
    pitches: list[str]
    effects: list[str]
    max_effects: int
    gear_ratios: list[str]
    prior: tuple[str, str] | None
    hold_out: float | None
    seed: int

@final
class Robot:
    @staticmethod
    def from_text(
        file: str,
        text: str,
        arguments: list[tuple[str, str]],
        package_path: list[str],
        allow_any_file: bool,
        vendor_angles: bool,
    ) -> Robot: ...
    @property
    def name(self) -> str: ...
    @property
    def file(self) -> str: ...
    @property
    def kind(self) -> str: ...
    @property
    def counts(self) -> tuple[int, int] | None: ...
    @property
    def urdf(self) -> str | None: ...
    def meshes(self, package_path: list[str], most: int) -> list[tuple[str, bytes]]: ...
    @property
    def notes(self) -> list[str]: ...
    def chains(self) -> list[tuple[str, str, list[str], bool]]: ...
    def chain(self, base: str | None, tip: str | None, exact: bool) -> Chain: ...
    def canonical(
        self, link_frames: str, frames: str, tip: str | None, exact: bool, tolerance: float
    ) -> tuple[str, list[str]]: ...

@final
class Chain:
    @property
    def name(self) -> str: ...
    @property
    def base(self) -> str: ...
    @property
    def tip(self) -> str: ...
    @property
    def size(self) -> float: ...
    @property
    def exact(self) -> bool: ...
    @property
    def notes(self) -> list[str]: ...
    @property
    def tip_moves_at_most(self) -> float: ...
    def coordinates(
        self,
    ) -> list[tuple[str, str, float | None, float | None, float | None, float | None, bool]]: ...
    def ranges(self) -> _Array: ...
    def poe(self, format: str) -> str: ...
    def fk(self, q: ArrayLike, out: _Array | None, threads: int) -> _Array: ...
    def tips(self, q: ArrayLike, out: _Array | None, threads: int) -> _Array: ...
    def jacobian(self, q: ArrayLike, frame: str, out: _Array | None, threads: int) -> _Array: ...
    def sample(self, count: int, seed: int) -> _Array: ...
    def table(self, convention: str | None, gauge: str | None, tolerance: float) -> Table: ...

@final
class Table:
    def render(self, format: str, units: str) -> str: ...
    def cells(self, units: str) -> tuple[list[str], list[tuple[str, str, str, list[str], str]], str]: ...
    def match(self, file: str, text: str) -> tuple[str, str]: ...

@final
class Comparison:
    @property
    def same(self) -> bool: ...
    def render(self, format: str) -> str: ...

@final
class Findings:
    @property
    def fails(self) -> bool: ...
    def render(self, format: str) -> str: ...

@final
class Effects:
    def __new__(cls, chain: Chain, text: str) -> Effects: ...
    def curve(self, joint: str, q: _Array) -> tuple[_Array, _Array] | None: ...
    def compensate(
        self,
        nominal: Chain,
        calibrated: Chain,
        wanted: Wanted,
        given: list[tuple[str, float]],
        allowed: tuple[float, float],
    ) -> tuple[str, str, str, list[str]]: ...

@final
class Fit:
    @property
    def notes(self) -> list[str]: ...
    def json(self) -> str: ...
    def text(self) -> str: ...
    def html(self) -> str: ...
    def urdf(self) -> tuple[str, str, list[str]] | None: ...
    def poe(self) -> str: ...
    def effects(self) -> str: ...
    def residuals(self) -> list[tuple[str, _Residuals, _Residuals]]: ...
    def predict(self, later: Given) -> tuple[str, _Residuals]: ...

@final
class FleetLedger:
    def __new__(cls, manifest: str, set: list[tuple[str, str]], store: Path) -> FleetLedger: ...
    @property
    def entries(self) -> int: ...
    def jobs(self) -> list[tuple[str, str | None, str, str]]: ...
    def later(self) -> list[tuple[str, str | None, str]]: ...
    def go_on(self) -> None: ...
    def keep(self, index: int, tables: list[tuple[str, bytes]], error: str | None) -> None: ...
    def close(self) -> str: ...
    def leave(self) -> None: ...

def fleet_run(
    manifest: str,
    set: list[tuple[str, str]],
    store: Path,
    threads: int,
    progress: Callable[[int, int, str], object] | None,
) -> str: ...
def fleet_compute(text: str) -> tuple[list[tuple[str, bytes]], str | None]: ...
def read_text(name: str) -> tuple[str, str]: ...
def read_bytes(name: str) -> tuple[str, bytes]: ...
def bag_rows(bag: str, chain: Chain, joint_topic: str | None, target_topic: str | None) -> tuple[str, list[str]]: ...
def cells(name: str, content: str | bytes) -> str | None: ...
def columns_draft(chain: Chain, name: str, content: str | bytes) -> str: ...
def compare(
    a: Robot,
    b: Robot,
    tolerance_m: float,
    tolerance_rad: float,
    only_kinematics: bool,
    up_to_base: bool,
    up_to_zeros: bool,
    count_names: bool,
    q_range: list[tuple[str | None, float, float]],
    samples: int,
    seed: int,
) -> Comparison: ...
def fingerprint(robot: Robot, tolerance: float) -> tuple[str, str]: ...
def fingerprint_matches(
    tolerance: float,
    motion: str,
    matter: str,
    other_motions: list[str],
    other_matters: list[str],
    written: str,
    only_motion: bool,
) -> bool: ...
def check(file: str, text: str, allow: list[str], deny: list[str], config: str | None, package_path: list[str]) -> Findings: ...
def calibrate(chain: Chain, rows: RowsGiven, search: SearchGiven, progress: Callable[[str], object] | None) -> Fit: ...
def plan(
    chain: Chain,
    wanted: int,
    measure: str,
    candidates: _Array | None,
    spread: int,
    box: list[float],
    target: list[float],
    anchor: list[float] | None,
    prior: tuple[str, str] | None,
    seed: int,
) -> tuple[str, str, str, _Array]: ...
def tell_apart(
    fit: Fit,
    wanted: int,
    candidates: _Array | None,
    spread: int,
    box: list[float],
    seed: int,
) -> tuple[str, str, str, _Array]: ...
def simulate(
    chain: Chain,
    rows: int,
    test_rows: int | None,
    measure: str,
    targets: int,
    seed: int,
    geometry_error: tuple[float, float],
    noise: tuple[float, float],
    outliers: float,
    effects: list[str],
    saved: str | None,
    columns: list[str],
    q: _Array | None,
    camera: tuple[str, str] | None,
    board: str | None,
    on_hand: bool,
    pixel_noise: float,
    sight_noise: tuple[float, float],
    repeatability: list[float],
) -> tuple[str, str | None, str]: ...
