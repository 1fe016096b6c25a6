"""The first page's example runs as it stands, on files that are made here."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import denavit as dn

TOP = Path(__file__).resolve().parents[2]


def test_the_example_of_the_first_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pandas = pytest.importorskip("pandas", reason="skipped, because pandas is not installed")
    pytest.importorskip("matplotlib", reason="skipped, because matplotlib is not installed").use("Agg")
    folder = TOP / "robots/universal_robots"
    for name in ("ur5e.urdf", "ur5e_dh.csv"):
        shutil.copy(folder / name, tmp_path / name)
    monkeypatch.chdir(tmp_path)
    text = (tmp_path / "ur5e.urdf").read_text()
    (tmp_path / "arm.urdf").write_text(text.replace("0.1625", "0.1645"))
    for words in ("init -q", "add arm.urdf", "-c user.name=n -c user.email=e commit -qm first"):
        subprocess.run(["git", *words.split()], check=True)
    (tmp_path / "arm.urdf").write_text(text)
    chain = dn.load("ur5e.urdf").chain("base", "tool0")
    run = chain.simulate(120, seed=3, test=40, effect=["joint_compliance@elbow_joint=0.3mm"])
    df = run.data.to_pandas()
    df[list(chain.joints)] *= 180 / np.pi
    df[["x", "y", "z"]] *= 1e3
    df.to_csv("run.csv", index=False)
    q = np.linspace(-1.0, 1.0, 5)
    poses = chain.fk(0.3 * chain.sample(3, seed=1))
    names: dict[str, object] = {"df": run.data.to_pandas(), "later": run.test, "q": q, "poses": poses}
    (code,) = re.findall(r"```python\n(.*?)```", (TOP / "python/README.md").read_text(), re.DOTALL)
    exec(compile(code, "README.md", "exec"), names)
    for made in ("c.urdf", "calibrated.urdf", "fit.html"):
        assert (tmp_path / made).exists(), made
    fit, d = names["fit"], names["d"]
    assert isinstance(fit, dn.Fit)
    assert isinstance(d, dn.Diff)
    assert "joint_compliance" in {effect.kind for effect in fit.effects}
    assert not d.same
    assert isinstance(fit.parameters.to_pandas(), pandas.DataFrame)
