"""The first page's example runs as it stands, on files that are made here, and so does the same as one types it."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import denavit as dn

TOP = Path(__file__).resolve().parents[2]

TYPED = """
import numpy as np, denavit as dn
robot = dn.load("ur5e.urdf")                    # path, text, bytes, xacro with arguments, git:REV:PATH, D-H as dict or frame
chain = robot.chain("base", "tool0")            # robot.chains lists them
table = chain.table("distal"); table            # _repr_html_, _repr_latex_ in a notebook
table.to_pandas(); table.notes; table.match("ur5e_dh.csv").exact
Q = chain.sample(100_000, seed=0)               # (N, n) within limits
T = chain.fk(Q); p = chain.tips(Q); J = chain.jacobian(Q, frame="space")   # (N,4,4), (N,3), (N,6,n); out=…; threads=
d = dn.diff("git:HEAD:arm.urdf", robot); d.same, d.tip.bound; d            # shows itself
dn.fingerprint(robot); dn.check("arm.urdf"); robot.canonical().save("c.urdf")
m = dn.Measurements.read("run.csv", units="mm,deg"); m2 = dn.Measurements.from_pandas(df)
fit = dn.calibrate(chain, m, hold_out=0.3)      # progress in a notebook, Ctrl-C works
fit.errors; fit.parameters.to_pandas(); fit.residuals
for f in fit.effects: print(f.kind, f.at, f.value, f.sd, f.probability, f.rivals)
fit.curves["elbow_joint"](q); fit.unexplained; fit.robot.save("calibrated.urdf")
fit.predict(later); fit.compensate(poses); chain.plan(40); chain.simulate()
fit.plot.effects(); fit.plot.residuals(); fit.report("fit.html")
"""


def first_page() -> str:
    (code,) = re.findall(r"```python\n(.*?)```", (TOP / "python/README.md").read_text(), re.DOTALL)
    return str(code)


@pytest.mark.parametrize("code", [first_page(), TYPED], ids=["first page", "typed"])
def test_the_example_runs(code: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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
    exec(compile(code, "README.md", "exec"), names)
    for made in ("c.urdf", "calibrated.urdf", "fit.html"):
        assert (tmp_path / made).exists(), made
    fit, d = names["fit"], names["d"]
    assert isinstance(fit, dn.Fit)
    assert isinstance(d, dn.Diff)
    assert names["T"].shape == (100_000, 4, 4)  # type: ignore[attr-defined]
    assert names["J"].shape == (100_000, 6, 6)  # type: ignore[attr-defined]
    assert "joint_compliance" in {effect.kind for effect in fit.effects}
    assert not d.same
    assert isinstance(fit.parameters.to_pandas(), pandas.DataFrame)
