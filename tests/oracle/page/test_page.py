"""Pages in headless Chromium: no console message, no network, sliders that move the tip to where forward kinematics says,
figures whose words do not lie on each other, and nothing wider than a phone.

The pages, and the poses that `Chain::fk` gives for a few postures, are written by crates/export/tests/page_written.rs.
"""

import html
import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest

WORKSPACE = Path(__file__).resolve().parents[3]
PAGES = WORKSPACE / "target/oracle/pages"
DRIVER = Path(__file__).with_name("driver.js")
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
NAMES = sorted(path.stem for path in PAGES.glob("*.json"))
FLAGS = """--headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking
--disable-component-update --disable-sync --hide-scrollbars --enable-logging=stderr --virtual-time-budget=5000
--host-resolver-rules=MAP-*-~NOTFOUND --dump-dom""".split()

needs_chromium = pytest.mark.skipif(CHROMIUM is None, reason="skipped, because Chromium is not installed (apt-get install chromium)")
needs_pages = pytest.mark.skipif(
    not NAMES, reason="skipped, because target/oracle/pages is empty (cargo test -p denavit-export --test page_written)"
)


# Chromium makes no window narrower than 500 px, so the phone is a frame.
PHONE = """<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,"><iframe src="page.html" width="390" height="844"
style="border:0"></iframe><pre id="result"></pre>
<script>addEventListener("message", (event) => { document.getElementById("result").textContent = event.data; });</script>"""


def opened(page, tmp_path, address=""):
    """The document as Chromium has it after loading, and what it wrote to the console."""
    flags = [flag.replace("MAP-*-", "MAP * ") for flag in FLAGS]
    command = [CHROMIUM, *flags, f"--user-data-dir={tmp_path / 'profile'}", "--window-size=1280,900", page.as_uri() + address]
    run = subprocess.run(command, capture_output=True, text=True, timeout=120, check=True)
    console = [line for line in run.stderr.splitlines() if "CONSOLE" in line]
    return run.stdout, console


def tip(document):
    cell = re.compile(r'id="tip-(\w+)" data-value="([^"]+)"')
    return {name: float(value) for name, value in cell.findall(document)}


def farthest(found, expected):
    return max(abs(found[name] - expected[name]) for name in expected)


@needs_chromium
@needs_pages
@pytest.mark.parametrize("name", NAMES)
def test_page_opens_at_the_posture_in_its_address_without_a_word_on_the_console(name, tmp_path):
    posture = json.loads((PAGES / f"{name}.json").read_text())[-1]
    values = ",".join(repr(value) for value in posture["q"])
    document, console = opened(PAGES / f"{name}.html", tmp_path, f"#chain={posture['chain']}&q={values}")
    assert console == []
    assert farthest(tip(document), posture["tip"]) < 1e-9


@needs_chromium
@needs_pages
@pytest.mark.parametrize("name", NAMES)
def test_sliders_move_the_tip_to_where_forward_kinematics_says_on_a_phone(name, tmp_path):
    postures = json.loads((PAGES / f"{name}.json").read_text())
    wanted = json.dumps(postures)
    scripts = f'<script type="application/json" id="postures">{wanted}</script><script>{DRIVER.read_text()}</script></body>'
    page = tmp_path / "page.html"
    page.write_text((PAGES / f"{name}.html").read_text(encoding="utf-8").replace("</body>", scripts), encoding="utf-8")
    around = tmp_path / "phone.html"
    around.write_text(PHONE, encoding="utf-8")
    document, console = opened(around, tmp_path)
    assert console == []
    result = json.loads(html.unescape(re.search(r'<pre id="result">(.*?)</pre>', document, re.DOTALL).group(1)))
    off = max(farthest(found, posture["tip"]) for found, posture in zip(result["tips"], postures, strict=True))
    print(f"{name}: {len(postures)} postures, largest difference {off:.1e}")
    assert off < 1e-9
    assert result["window"] == 390 and result["document"] <= 390
    assert min(result["colours"].values()) > 20
    assert result["figures"] >= 3
    assert result["troubles"] == []


@needs_pages
@pytest.mark.parametrize("name", [*NAMES, "index"])
def test_page_asks_for_no_other_file(name):
    text = (PAGES / f"{name}.html").read_text(encoding="utf-8")
    addresses = {address for address in re.findall(r"(?:https?:)?//[\w.-]+\.\w{2,}[^\s\"'<]*", text)}
    assert addresses <= {"http://www.w3.org/2000/svg"}
    assert "default-src 'none'" in text
    assert not re.search(r"<(?:link|img|iframe|object|embed)\b(?![^>]*href=\"data:,\")|<script[^>]*\bsrc=|@import|url\((?!#)", text)


@needs_pages
def test_index_leads_to_every_page():
    text = (PAGES / "index.html").read_text(encoding="utf-8")
    assert set(re.findall(r'<a href="([^"]+)\.html">', text)) == set(NAMES)
