"""The explorer in a notebook: executed by a kernel, opened in Chromium without a network, numbers as the package has them."""

from __future__ import annotations

import base64
import html
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import denavit as dn
from denavit.view import PAGE

TOP = Path(__file__).resolve().parents[2]
UR5E = TOP / "robots/universal_robots/ur5e.urdf"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = [
    "--no-sandbox",
    "--disable-gpu-compositing",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
]

built = pytest.mark.skipif(not PAGE.is_file(), reason="skipped, because the wheel has no explorer (web/build)")
in_browser = pytest.mark.skipif(CHROMIUM is None, reason="skipped, because Chromium is not installed")


def test_what_is_shown_of_what() -> None:
    robot = dn.load(UR5E)
    changed = dn.load(robot.text.replace("0.1625", "0.1645"), file="changed.urdf")
    table = TOP / "robots/universal_robots/ur5e_dh.csv"
    assert dn.explore(robot).robots == (("ur5e.urdf", robot.urdf),)
    assert dn.explore(robot.chain()) == dn.explore(UR5E)
    assert dn.explore(dn.diff(robot, changed)).robots[1] == ("changed.urdf", changed.text)
    assert dn.explore(table).robots == (("ur5e_dh.csv", table.read_text()),)
    fit = dn.calibrate(robot.chain(), robot.chain().simulate(60, seed=1).data, effects=None)
    drawn, calibrated = dn.explore(fit).robots
    assert drawn == ("ur5e.urdf", robot.text)
    assert calibrated[1] == fit.robot.text != drawn[1]


def test_meshes_beside_the_robot_are_in_the_page_up_to_a_limit(tmp_path: Path) -> None:
    (tmp_path / "meshes").mkdir()
    mesh = b"solid a\nendsolid a\n"
    (tmp_path / "meshes/part.stl").write_bytes(mesh)
    (tmp_path / "secret.txt").write_text("nobody's business")
    shape = '<visual><geometry><mesh filename="{}"/></geometry></visual>'
    shapes = shape.format("meshes/part.stl") + shape.format("secret.txt")
    robot = tmp_path / "arm.urdf"
    robot.write_text(UR5E.read_text().replace('<link name="base">', f'<link name="base">{shapes}', 1))
    view = dn.explore(robot)
    assert view.meshes == ((("meshes/part.stl", mesh),),)
    assert dn.explore(robot, meshes=len(mesh) - 1).meshes == ()
    assert dn.explore(dn.diff(robot, UR5E)).meshes == ((("meshes/part.stl", mesh),), ())
    if PAGE.is_file():
        assert base64.b64encode(mesh).decode() in view.page


def test_the_wheel_has_the_page_that_was_built() -> None:
    page = TOP / "web/dist/explorer.html"
    if not page.is_file():
        pytest.skip("skipped, because web/dist/explorer.html is not built (web/build)")
    assert PAGE.read_bytes() == page.read_bytes()


@built
def test_no_text_of_a_robot_leaves_its_place(tmp_path: Path) -> None:
    text = UR5E.read_text().replace("<robot ", '<!-- </script><script>alert(1)</script>" onload="x --><robot ', 1)
    view = dn.explore(text)
    assert "</script><script>alert" not in view.page
    shown = view._repr_html_()
    assert shown.count("<iframe") == 1
    assert shown.count('"') == 8, "the page is one attribute"
    view.save(tmp_path / "page.html")
    assert (tmp_path / "page.html").read_text() == view.page


def test_without_the_page_it_says_how_to_make_it(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("denavit.view.PAGE", tmp_path / "explorer.html")
    with pytest.raises(dn.ExportError, match="run web/build"):
        dn.explore(UR5E)._repr_html_()


def test_values_show_the_explorer_where_that_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    robot = dn.load(UR5E)
    difference = dn.diff(robot, robot.text.replace("0.1625", "0.1645"))
    for value in (robot, robot.chain(), difference):
        assert value._repr_html_() is None, "three megabytes are not for every cell"
    monkeypatch.setattr(dn, "show_explorer", True)
    monkeypatch.setattr(dn.View, "_repr_html_", lambda view: f"[{len(view.robots)}]")
    assert robot._repr_html_() == f"<pre>{html.escape(repr(robot))}</pre>[1]"
    shown = difference._repr_html_()
    assert shown is not None
    assert shown.startswith("<pre>") and shown.endswith("</pre>[2]")


@pytest.fixture(scope="module")
def outputs() -> list[str]:
    """What cells of a notebook show, as a kernel sends it: one asks for the explorer, the others are values that show it."""
    nbformat = pytest.importorskip("nbformat", reason="skipped, because nbformat is not installed")
    nbclient = pytest.importorskip("nbclient", reason="skipped, because nbclient is not installed")
    make = nbformat.v4.new_code_cell
    begin = f"import denavit as dn\nrobot = dn.load({str(UR5E)!r})\nchain = robot.chain()"
    cells = [
        f"{begin}\ndn.explore(robot)",
        'dn.show_explorer = True\ndn.diff(robot, robot.text.replace("0.1625", "0.1645"))',
        "dn.calibrate(chain, chain.simulate(60, seed=1).data, effects=None)",
        "robot",
    ]
    notebook = nbformat.v4.new_notebook(cells=[make(cell) for cell in cells])
    nbclient.NotebookClient(notebook, timeout=120).execute()
    return ["".join(output.get("data", {}).get("text/html", "") for output in cell.outputs) for cell in notebook.cells]


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    api = pytest.importorskip("playwright.sync_api", reason="skipped, because playwright is not installed")
    with api.sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS, timeout=120_000)
        yield chromium
        chromium.close()


@built
@in_browser
@pytest.mark.parametrize("theme", ["light", "dark"])
def test_views_of_an_executed_notebook_in_a_browser(theme: str, browser: Any, outputs: list[str], tmp_path: Path) -> None:
    """All of them stand in one document, as in a notebook."""
    document = tmp_path / "notebook.html"
    document.write_text("<!doctype html><meta charset=utf-8><body>" + "".join(f"<div>{output}</div>" for output in outputs))
    context = browser.new_context(viewport={"width": 1100, "height": 3200}, color_scheme=theme)
    page = context.new_page()
    page.set_default_timeout(60_000)
    asked: list[str] = []
    errors: list[str] = []
    context.on("request", lambda request: asked.append(request.url))
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto(document.as_uri())
    robot, diff, fit, itself = (page.frame_locator(f"iframe >> nth={index}") for index in range(4))
    robot.locator("#dh tbody tr").first.wait_for()
    rows = robot.locator("#dh tbody tr").all_inner_texts()
    assert len(rows) == len(dn.load(UR5E).chain().table().rows)
    assert "0.1625" in rows[1] or "162.5" in rows[1]
    for frame, words in ((diff, "2 mm"), (fit, "mm")):
        panel = frame.locator("[role=tabpanel]")
        panel.get_by_text(words).first.wait_for()
    itself.locator("#dh tbody tr").first.wait_for()
    assert itself.locator("#dh tbody tr").all_inner_texts() == rows
    assert "different" in page.locator("pre").nth(0).inner_text()
    if os.environ.get("SHOTS") == "1":
        shots = TOP / "target/tests/notebook"
        shots.mkdir(parents=True, exist_ok=True)
        page.screenshot(path=str(shots / f"{theme}.png"), full_page=True)
    assert errors == []
    assert [url for url in asked if not url.startswith(("file:", "blob:", "data:", "about:"))] == []
    context.close()
