"""Calibration in the explorer: questions about columns, and effects whose display shows how certain they are."""

import csv
import json
import subprocess

import pytest
from explorer_page import DESKTOP, PHONE, ROBOTS, UR5E, WORKSPACE, cli, complains, denavit, downloaded, drop, drop_robot, needs_page, same, shot, without, zipped
from playwright.sync_api import expect

pytestmark = needs_page

TRACKER = ROBOTS / "universal_robots/ur5e_tracker.csv"


def calibrated(page):
    page.click("#calibrate")
    page.wait_for_selector("#stages, #failed", timeout=300_000)
    assert page.locator("#failed").count() == 0, page.locator("#failed").inner_text()
    return json.loads(page.locator("#report").get_attribute("data-json"))


def test_columns_whose_names_say_it_are_not_asked_about(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, TRACKER)
    expect(page.locator("#columns-verdict")).to_contain_text("120 rows are read")
    assert not page.locator("#columns").evaluate("it => it.open")
    assert page.locator("#columns tr.guess").count() == 0


def test_a_list_of_anything_in_the_calibrate_panel_is_asked_about_and_not_taken_for_a_robot(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    page.click("#tab-Calibrate")
    drop(page, ("list.txt", b"1;2;3;4\n5;6;7;8\n"))
    expect(page.locator("#columns-verdict")).to_have_class("wrong")
    expect(page.locator("#columns-table tbody tr")).to_have_count(4)


def export(width):
    """The tracker's file as from another program: other names, mm and degrees, semicolons, an unused column."""
    rows = list(csv.DictReader(line for line in TRACKER.read_text().splitlines() if not line.startswith("#")))
    joints = [name for name in rows[0] if name.endswith("_joint")]
    header = [*(f"J{k + 1}" for k in range(6)), "T_x [mm]", "T_y [mm]", "T_z [mm]", "remark"]
    lines = [";".join(header)]
    for row in rows[:width]:
        lines.append(";".join([*(repr(float(row[name]) * 57.29577951308232) for name in joints), *(repr(float(row[axis]) * 1000) for axis in "xyz"), "ok"]))
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(("size", "theme"), [(DESKTOP, "light"), (PHONE, "dark")], ids=["desktop", "phone"])
def test_unclear_columns_are_asked_about_one_by_one(size, theme, explorer, tmp_path):
    page = explorer(size=size, theme=theme)
    drop_robot(page, UR5E)
    data = tmp_path / "export.csv"
    data.write_text(export(60).replace("J3;", "elbow angle;"))
    page.click("#tab-Calibrate")
    drop(page, data)
    # A joint is missing: the form is open and says so.
    expect(page.locator("#columns")).to_have_attribute("open", "")
    expect(page.locator("#columns-verdict")).to_contain_text("elbow_joint")
    expect(page.locator("#columns-verdict")).to_have_class("wrong")
    assert page.locator("#columns tr.guess").count() >= 8
    page.select_option("#column-2", "elbow_joint")
    for at, axis in enumerate("xyz"):
        page.select_option(f"#column-{6 + at}", axis)
    page.select_option("#data-units", "mm,deg")
    expect(page.locator("#columns-verdict")).to_contain_text("60 rows are read")
    page.locator("#columns-table").scroll_into_view_if_needed()
    # All questions can be answered without scrolling sideways.
    table, asked = (page.locator(it).bounding_box() for it in ("#columns .scroll", "#column-2"))
    assert asked["x"] + asked["width"] <= table["x"] + table["width"] + 1
    shot(page, f"columns-{size['width']}-{theme}")
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    page.select_option("#column-9", "")
    page.select_option("#search", "none")
    found = calibrated(page)
    map_file = tmp_path / "columns.toml"
    map_file.write_text(downloaded(page, "#columns-file")[0])
    expected = tmp_path / "report.json"
    cli("calibrate", UR5E, "--data", data, "--columns", map_file, "--units", "mm,deg", "--effects", "none", "--json", expected)
    # The page knows no files and no date.
    same(without(found, "origin"), without(json.loads(expected.read_text()), "origin"), 1e-5)


BOOK = WORKSPACE / "tests/measured/files/readings.xlsx"


def test_a_workbook_is_read_as_the_command_line_reads_it(explorer, tmp_path):
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, BOOK)
    page.select_option("#data-units", "mm,deg")
    expect(page.locator("#columns-verdict")).to_contain_text("rows are read")
    page.select_option("#search", "none")
    found = calibrated(page)
    expected = tmp_path / "report.json"
    cli("calibrate", UR5E, "--data", BOOK, "--units", "mm,deg", "--effects", "none", "--json", expected)
    same(without(found, "origin"), without(json.loads(expected.read_text()), "origin"), 1e-5)


def test_damaged_and_bloated_workbooks_get_one_sentence(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, ("cut.xlsx", BOOK.read_bytes()[:400]))
    complains(page, "cut.xlsx")
    drop(page, ("bomb.xlsx", zipped({"xl/worksheets/sheet1.xml": b" " * (200 << 20)})))
    complains(page, "bomb.xlsx: more than 128 MB")
    page.click("#tab-Calibrate")
    drop(page, ("letter.xlsx", zipped({"word/document.xml": "<a/>"})))
    expect(page.locator("#columns-verdict, .said.wrong").filter(has_text="this Excel workbook cannot be read").first).to_be_visible()


def test_names_in_a_file_of_measurements_are_text(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    page.click("#tab-Calibrate")
    drop(page, ("run.csv", b"<img src=x onerror=alert(1)>,<b>b</b>,c\n1,2,3\n4,5,6\n"))
    expect(page.locator("#columns-table tbody tr")).to_have_count(3)
    assert page.locator("img, #columns-table b").count() == 0


def test_effects_look_as_sure_as_they_are(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, TRACKER)
    report = calibrated(page)
    assert [effect["kind"] for effect in report["effects"]] == ["joint_compliance"] and "one_of" not in report
    named = page.locator("#effects-found .named")
    expect(named).to_have_count(1)
    # The sentences are those of the command line's report: heading, effects and end.
    lines = [line.strip() for line in page.locator("#report").text_content().splitlines()]
    shown = page.locator("#effects").inner_text()
    for words in (page.locator("#effects-heading").inner_text(), named.locator("b").inner_text(), page.locator("#effects > p").last.inner_text()):
        assert words[0].lower() + words[1:] in lines, words
    why = named.locator(".rivals").inner_text().split("; ")
    assert f"why: {why[0]}" in lines and all(words in lines for words in why[1:])
    rivals = [words for words in why if words.startswith("alternatives: ")]
    assert len(rivals) == bool(report["effects"][0].get("ambiguous_with")), why
    assert float(named.locator("meter").get_attribute("value")) == pytest.approx(report["effects"][0]["probability"], rel=1e-9)
    assert page.locator("#effects-found .open, #unnamed").count() == 0 and "No unexplained structure" in shown
    page.locator("#effects").scroll_into_view_if_needed()
    shot(page, "effects-light")
    # The same effect, less certain, and unexplained structure: the page itself draws it, and differently from a named one.
    unsure = {"title": "one of: joint_compliance at shoulder_lift_joint (60 %), link_compliance at elbow_joint (30 %)", "named": False, "numbers": ["coefficient 1"], "why": "corrected for, not named"}
    said = {"heading": "no cause is certain enough to be named, of 9 candidates", "effects": [{"said": unsure, "probability": 0.6}], "structured": True, "ending": "unexplained structure (p 1.0e-4): wrist_1_joint 40 %"}
    page.evaluate("said => document.getElementById('effects').replaceWith(window.denavit.effects(said))", said)
    expect(page.locator("#effects-heading")).to_have_text("No cause is certain enough to be named, of 9 candidates")
    assert page.locator("#effects-found .named").count() == 0
    expect(page.locator("#effects-found .open b")).to_have_text(unsure["title"])
    expect(page.locator("#unnamed")).to_have_text(said["ending"])
    edges = page.evaluate("() => [...document.querySelectorAll('#effects-found > li')].map((it) => getComputedStyle(it).borderLeftStyle)")
    assert edges == ["dashed", "dotted"]
    shot(page, "effects-unsure-light")
    page.click("#theme")
    shot(page, "effects-unsure-dark")
