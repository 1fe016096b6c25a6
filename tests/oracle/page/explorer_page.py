"""Helpers for tests of the explorer in headless Chromium; conftest.py opens it."""

import io
import json
import math
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

import pytest
from playwright.sync_api import expect

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from built import denavit

WORKSPACE = Path(__file__).resolve().parents[3]
PAGE = WORKSPACE / "web/dist/explorer.html"
ROBOTS = WORKSPACE / "robots"
VENDOR = WORKSPACE.parent / "shared/vendor"
SHOTS = WORKSPACE / "target/tests/explorer"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
LARGE = tempfile.TemporaryDirectory()
# A small laptop: pictures of a larger window take longer to draw.
DESKTOP = {"width": 1100, "height": 640}
PHONE = {"width": 360, "height": 740}
# The machine may be busy: wait for up to a minute.
expect.set_options(timeout=60_000)
UR5E = ROBOTS / "universal_robots/ur5e.urdf"

needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="skipped, because Chromium is not installed (apt-get install chromium)")
needs_page = [
    needs_chromium,
    pytest.mark.skipif(not PAGE.is_file(), reason="skipped, because web/dist/explorer.html is not built (web/build)"),
]


def cli(*arguments, codes=(0,)):
    done = subprocess.run([denavit(), *map(str, arguments)], capture_output=True, text=True, cwd=WORKSPACE)
    assert done.returncode in codes, done.stderr
    # The page knows only the names of files.
    for argument in arguments:
        if isinstance(argument, Path):
            done.stdout = done.stdout.replace(str(argument), argument.name)
    return done.stdout


def drop(page, *files):
    """Chooses files in the dialog; a file is a path, or a name and its bytes."""
    page.set_input_files("#files", [chosen(file) for file in files])


def chosen(file):
    """In Playwright's form; large contents become a file, which Chromium reads by itself: 33 MB in a message take half a minute."""
    if isinstance(file, Path):
        return str(file)
    name, content = file
    if len(content) < 1 << 20:
        return {"name": name, "mimeType": "", "buffer": content}
    path = Path(LARGE.name) / name
    path.write_bytes(content)
    return str(path)


def drop_robot(page, *files):
    drop(page, *files)
    expect(page.locator("#dh tbody tr").first).to_be_visible()


def has_table(page, file):
    """Waits until the page, or the frame of a page, shows the robot of this file and its table."""
    page.wait_for_function("file => window.denavit.app.robot?.file === file && window.denavit.app.table", arg=file)
    expect(page.locator("#dh tbody tr").first).to_be_visible()


def drawn(page):
    """Waits until the requested change has been drawn: the frame requested before this one, and this one."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def downloaded(page, selector):
    with page.expect_download() as waited:
        page.click(selector)
    return Path(waited.value.path()).read_text(encoding="utf-8"), waited.value.suggested_filename


def same(found, expected, tolerance=0.0, path=""):
    """Compares two documents, number by number."""
    if isinstance(expected, dict):
        assert isinstance(found, dict) and found.keys() == expected.keys(), path
        for key in expected:
            same(found[key], expected[key], tolerance, f"{path}.{key}")
    elif isinstance(expected, list):
        assert len(found) == len(expected), path
        for index, (one, other) in enumerate(zip(found, expected, strict=True)):
            same(one, other, tolerance, f"{path}[{index}]")
    elif isinstance(expected, float) and isinstance(found, int | float):
        close = math.isclose(found, expected, rel_tol=tolerance, abs_tol=tolerance)
        assert found == expected or close, f"{path}: {found} is not {expected}"
    else:
        assert found == expected, f"{path}: {found!r} is not {expected!r}"


def without(document, *keys):
    return {key: value for key, value in document.items() if key not in keys}


def table_of(page):
    page.select_option("#format", "json")
    return json.loads(downloaded(page, "#download-table")[0])


def zipped(files):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return out.getvalue()


def complains(page, words):
    expect(page.locator(".said.wrong")).to_contain_text(words)


def shot(page, name):
    """A picture of the page for people to look at, where SHOTS=1 asks for pictures: no test compares them."""
    drawn(page)
    if os.environ.get("SHOTS") != "1":
        return
    SHOTS.mkdir(parents=True, exist_ok=True)
    page.wait_for_timeout(300)
    page.screenshot(path=SHOTS / f"{name}.png")


@pytest.fixture(scope="module")
def with_page():
    """Skips if the binary contains no page."""
    asked = subprocess.run([denavit(), "explore", str(UR5E), "-o", "-"], capture_output=True, text=True)
    assert asked.returncode == 0, asked.stderr
    if "the explorer is not installed" in asked.stderr:
        pytest.skip("skipped, because this binary was built without --features explorer")
