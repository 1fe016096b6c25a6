"""Types: mypy --strict over package and script, pyright's strict mode over the script, the stub against the native module."""

from __future__ import annotations

import json
import os
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).resolve().parent


def run(*words: str, folder: Path) -> None:
    pytest.importorskip("mypy", reason="skipped, because mypy is not installed")
    done = subprocess.run([sys.executable, "-m", *words], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_package_and_a_script_pass_mypy_strict(tmp_path: Path) -> None:
    options = ["--strict", "--config-file", os.fspath(HERE.parent / "pyproject.toml"), "--cache-dir", os.fspath(tmp_path)]
    shutil.copy(HERE / "user_script.py", tmp_path)
    run("mypy", *options, "-p", "denavit", "-m", "user_script", folder=tmp_path)


def test_a_script_passes_pyright_strict(tmp_path: Path) -> None:
    pytest.importorskip("basedpyright", reason="skipped, because basedpyright is not installed")
    import denavit

    settings = {"include": [os.fspath(HERE / "user_script.py")], "typeCheckingMode": "strict"}
    settings["extraPaths"] = [os.fspath(Path(denavit.__file__).parents[1])]
    (tmp_path / "pyrightconfig.json").write_text(json.dumps(settings))
    words = [sys.executable, "-m", "basedpyright", "-p", os.fspath(tmp_path), "--pythonpath", sys.executable]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "0 errors" in done.stdout


def test_names_docstrings_and_form_are_as_agreed() -> None:
    """Every public name has a docstring (ruff's rules D)."""
    pytest.importorskip("ruff", reason="skipped, because ruff is not installed")
    for words in (("check", "--no-cache"), ("format", "--check", "--no-cache")):
        run("ruff", *words, ".", "../docs/site", folder=HERE.parent)


def test_the_script_runs() -> None:
    names = runpy.run_path(os.fspath(HERE / "user_script.py"))
    assert names["same"]


def test_the_stub_is_that_of_the_native_module(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed"
    # Aliases of the stub, and what the interpreter adds to a module.
    names = ("_Array", "Given", "_Residuals", "Wanted", "RowsGiven", "SearchGiven", "__all__")
    allowed.write_text("".join(f"denavit\\._denavit\\.{name}\n" for name in names))
    run("mypy.stubtest", "denavit._denavit", "--allowlist", os.fspath(allowed), "--ignore-unused-allowlist", folder=tmp_path)
