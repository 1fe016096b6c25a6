"""The notebooks run from top to bottom, and their outputs are kept."""

from __future__ import annotations

from pathlib import Path

import pytest

FOLDER = Path(__file__).resolve().parents[2] / "examples/notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_there_are_four() -> None:
    assert [path.name[0] for path in NOTEBOOKS] == ["1", "2", "3", "4"]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_and_keeps_its_outputs(path: Path) -> None:
    nbformat = pytest.importorskip("nbformat", reason="skipped, because nbformat is not installed")
    nbclient = pytest.importorskip("nbclient", reason="skipped, because nbclient is not installed")
    pytest.importorskip("pandas", reason="skipped, because pandas is not installed")
    pytest.importorskip("matplotlib", reason="skipped, because matplotlib is not installed")
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    kept = {cell["id"]: bool(cell.outputs) for cell in notebook.cells if cell.cell_type == "code"}
    assert any(kept.values())
    nbclient.NotebookClient(notebook, timeout=240, resources={"metadata": {"path": str(FOLDER)}}).execute()
    for cell in notebook.cells:
        if cell.cell_type == "code":
            shown = [output for output in cell.outputs if output.get("data") != {"text/plain": ""}]
            assert bool(shown) == kept[cell["id"]], f"run {path.name} again and keep its outputs: {cell['id']}"
