"""Code and documents that denavit writes, run by their consumers: roboticstoolbox executes the DHRobot, pdflatex sets the table."""

import json
import random
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import built

TOP = Path(__file__).resolve().parents[3]
ROBOTS = {
    "universal_robots/ur5e.urdf": [],
    "franka/panda.urdf": ["--tip", "panda_link8"],
    "stanford/stanford_arm.urdf": [],
    "kuka/kr16_2_on_rail.urdf": [],
}


def denavit(*arguments):
    run = subprocess.run([built.denavit(), *arguments], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.mark.parametrize("convention", ["distal", "proximal"])
@pytest.mark.parametrize("robot", ROBOTS)
def test_a_dhrobot_moves_as_fk_says(robot, convention):
    file = str(TOP / "robots" / robot)
    scope = {}
    exec(denavit("table", file, "--format", "rtb", "--convention", convention, *ROBOTS[robot]), scope)
    made = scope["robot"]
    seeded = random.Random(1)
    for _ in range(5):
        q = [seeded.uniform(-1, 1) for _ in range(made.n)]
        words = ",".join(map(repr, q))
        pose = np.array(json.loads(denavit("fk", file, "--json", "--q", words, *ROBOTS[robot]))["pose"])
        assert np.abs(made.fkine(q).A - pose).max() < 1e-12


@pytest.mark.parametrize("robot", ROBOTS)
def test_latex_compiles(robot, tmp_path):
    if shutil.which("pdflatex") is None:
        pytest.skip("skipped, because pdflatex is not installed")
    table = denavit("table", str(TOP / "robots" / robot), "--format", "tex", *ROBOTS[robot])
    text = "\\documentclass{article}\\usepackage{booktabs}\\begin{document}\n" + table + "\\end{document}\n"
    (tmp_path / "table.tex").write_text(text, encoding="utf-8")
    run = subprocess.run(
        ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "table.tex"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )
    assert run.returncode == 0, run.stdout[-2000:]
