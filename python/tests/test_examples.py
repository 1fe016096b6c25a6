"""Every example of a docstring and of the documentation runs."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import pkgutil
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import denavit

TOP = Path(__file__).resolve().parents[2]
MODULES = [module.name for module in pkgutil.walk_packages(denavit.__path__, "denavit.") if not module.name.endswith("_denavit")]


@pytest.mark.parametrize("name", ["denavit", *MODULES])
def test_examples_of(name: str) -> None:
    found = doctest.testmod(importlib.import_module(name))
    assert found.failed == 0


def test_there_are_examples() -> None:
    finder = doctest.DocTestFinder(exclude_empty=True)
    counts = [len(test.examples) for name in MODULES for test in finder.find(importlib.import_module(name))]
    assert sum(counts) >= 15


def test_every_call_of_the_documentation_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The table of calls and the code of docs/python.md, with the names that they speak of."""
    pandas = pytest.importorskip("pandas", reason="skipped, because pandas is not installed")
    pytest.importorskip("matplotlib", reason="skipped, because matplotlib is not installed").use("Agg")
    text = (TOP / "docs/python.md").read_text(encoding="utf-8")
    for name in ("ur5e.urdf", "ur5e_dh.csv"):
        shutil.copy(TOP / "robots/universal_robots" / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_bytes(Path("ur5e.urdf").read_bytes())
    Path("vendor.csv").write_bytes(Path("ur5e_dh.csv").read_bytes())
    chain = denavit.load("ur5e.urdf").chain()
    run = chain.simulate(60, seed=1, test=30, measure="poses")
    run.data.save("run.csv")
    frame = run.data.to_pandas()
    frame.rename(columns={"x": "PX", "y": "PY", "z": "PZ"}).to_csv("run.xlsx", index=False)
    angles = Rotation.from_quat(frame[["qx", "qy", "qz", "qw"]].to_numpy()).as_euler("ZYX")
    frame.drop(columns=["qx", "qy", "qz", "qw"]).assign(A=angles[:, 0], B=angles[:, 1], C=angles[:, 2]).to_csv("kuka.csv")
    Path("webcam.yaml").write_text("camera_matrix: [600, 0, 320, 0, 600, 240, 0, 0, 1]\n")
    chain.simulate(3, camera="webcam.yaml", board="7x5:30mm").data.save("corners.csv")
    Path("plant.csv").write_text("serial,robot\nSN-1,ur5e.urdf\n")
    np.savetxt("front_0.csv", chain.sample(5), delimiter=",")
    some = {
        "robot": chain.robot,
        "chain": chain,
        "Q": chain.sample(10),
        "N": 5,
        "seed": 1,
        "positions": chain.tips(chain.sample(10)),
        "q": np.zeros(2),
        "data": run.data,
    }
    some |= {"table": chain.table(), "source": "ur5e.urdf", "base": "base", "tip": "tool0", "convention": "distal"}
    some |= {"a": "ur5e.urdf", "b": "arm.urdf", "file": "run.csv", "units": "m,rad", "frame": frame, "later": run.test}
    some |= {"fit": denavit.calibrate(chain, run.data)}
    some |= {"columns": {name: frame[name] for name in frame}, "poses": chain.fk(chain.sample(3)), "dn": denavit}
    calls = [
        call
        for line in text.splitlines()
        if re.match(r"\| [^|]* \| `", line) and "µs" not in line
        for call in re.findall(r"`([^`]*)`", line.split("|")[2])
    ]
    assert len(calls) >= 35
    has_jax = importlib.util.find_spec("jax") is not None
    for call in calls:
        if has_jax or "to_jax" not in call:
            exec(compile(call, "docs/python.md", "exec"), some)
    codes = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert codes
    for code in codes:
        exec(compile(code, "docs/python.md", "exec"), some)
    assert isinstance(some["fit"], denavit.Fit)
    assert isinstance(frame, pandas.DataFrame)
