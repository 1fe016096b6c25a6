"""Pages in headless Chromium: no console message, no network, sliders that move the tip to the pose from forward kinematics,
figures whose words do not overlap, and nothing wider than a phone.

The pages, and the poses from `Chain::fk` for a few postures, are written by crates/export/tests/page_written.rs.
"""

import json
import re
from pathlib import Path

import pytest
from explorer_page import WORKSPACE, needs_chromium

PAGES = WORKSPACE / "target/oracle/pages"
DRIVER = Path(__file__).with_name("driver.js").read_text()
NAMES = sorted(path.stem for path in PAGES.glob("*.json"))
DESKTOP = {"width": 1280, "height": 900}
PHONE = {"width": 390, "height": 844}

needs_pages = pytest.mark.skipif(
    not NAMES, reason="skipped, because target/oracle/pages is empty (cargo test -p denavit-export --test export page_written)"
)


@pytest.fixture
def opened(opener):
    """Opens a page in a window of a size; at the end of the test it must have requested nothing and written nothing."""
    open_page, used = opener
    yield open_page
    assert [words for _, page in used for words in page.console] == []
    asked = [url for _, page in used for url in page.asked]
    assert len(asked) == len(used), asked


def farthest(found, expected):
    return max(abs(found[name] - expected[name]) for name in expected)


@needs_chromium
@needs_pages
@pytest.mark.parametrize("name", NAMES)
def test_page_opens_at_the_posture_in_its_address(name, opened):
    posture = json.loads((PAGES / f"{name}.json").read_text())[-1]
    values = ",".join(repr(value) for value in posture["q"])
    page = opened(f"{(PAGES / f'{name}.html').as_uri()}#chain={posture['chain']}&q={values}", DESKTOP)
    tip = page.evaluate("names => names.map(name => Number(document.getElementById(`tip-${name}`).dataset.value))", list(posture["tip"]))
    assert farthest(dict(zip(posture["tip"], tip, strict=True)), posture["tip"]) < 1e-9
    names_in_the_3d_view_lie_inside_and_off_each_other(page)


@needs_chromium
@needs_pages
@pytest.mark.parametrize("name", NAMES)
def test_page_on_a_phone(name, opened):
    page = opened((PAGES / f"{name}.html").as_uri(), PHONE)
    what_is_wider_than_the_window_shows_that_it_scrolls(page)
    sliders_move_the_tip_to_where_forward_kinematics_says(page, name)
    names_in_the_3d_view_lie_inside_and_off_each_other(page)


def sliders_move_the_tip_to_where_forward_kinematics_says(page, name):
    postures = json.loads((PAGES / f"{name}.json").read_text())
    result = page.evaluate(DRIVER, postures)
    off = max(farthest(found, posture["tip"]) for found, posture in zip(result["tips"], postures, strict=True))
    print(f"{name}: {len(postures)} postures, largest difference {off:.1e}")
    assert off < 1e-9
    assert result["width"] <= PHONE["width"]
    assert min(result["colours"].values()) > 20
    assert result["figures"] >= 3
    assert result["errors"] == []


def names_in_the_3d_view_lie_inside_and_off_each_other(page):
    for view in ("isometric", "front", "side", "top"):
        page.click(f'button[data-view="{view}"]')
        page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
        named = json.loads(page.evaluate("() => document.getElementById('view').dataset.named"))
        words = named["words"]
        assert len(words) >= 1 or named["asked"] == 0
        for index, one in enumerate(words):
            assert 0 <= one["x"] - one["wide"] and one["x"] + one["wide"] <= named["width"], (view, one)
            assert 0 <= one["y"] - one["high"] and one["y"] + one["high"] <= named["height"], (view, one)
            for other in words[:index]:
                apart = abs(one["x"] - other["x"]) >= one["wide"] + other["wide"] or abs(one["y"] - other["y"]) >= 12
                assert apart, (view, one, other)


def what_is_wider_than_the_window_shows_that_it_scrolls(page):
    found = page.evaluate(
        """() => [...document.querySelectorAll(".wide")].filter((part) => part.scrollWidth > part.clientWidth + 1).map((part) => {
          const style = getComputedStyle(part);
          return [style.overflowX, style.backgroundImage.split("gradient").length - 1, style.scrollbarWidth];
        })"""
    )
    assert all(overflow in ("auto", "scroll") and shades == 4 and bar == "thin" for overflow, shades, bar in found), found


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
