"""The explorer's tools: named postures, playback, pictures, the ruler, hold-out, and the folder for a static host."""

import csv
import io
import json
import math
import re
import subprocess
import urllib.parse
from xml.etree import ElementTree

import numpy as np
import pytest
from explorer_page import PAGE, ROBOTS, UR5E, cli, denavit, downloaded, drawn, drop, drop_robot, needs_page, shot
from playwright.sync_api import expect

pytestmark = needs_page

JOINTS = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint", "wrist_2_joint", "wrist_3_joint"]
POSTURE = [0.6, -1.1, 1.3, -0.8, -1.2, 0.3]
VALUE = "name => window.denavit.app.value(name)"


def moved(page, values):
    page.evaluate("([names, values]) => { const { app } = window.denavit; names.forEach((name, k) => app.q.set(name, values[k])); app.refresh(); }", [JOINTS, values])
    page.wait_for_function("q => Math.abs(JSON.parse(document.getElementById('tip').dataset.q ?? '{}').elbow_joint - q) < 1e-12", arg=values[2])


def test_named_postures_of_an_srdf_move_the_robot(explorer):
    states = '<group_state name="home" group="arm"><joint name="elbow_joint" value="1.25"/><joint name="finger" value="1"/></group_state><group_state name="up" group="arm"><joint name="elbow_joint" value="0"/><joint name="shoulder_lift_joint" value="-1.5"/></group_state>'
    page = explorer()
    drop(page, ("ur5e.urdf", UR5E.read_bytes()), ("arm.srdf", f'<robot name="ur5e">{states}</robot>'.encode()))
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    expect(page.locator("#posture option")).to_have_text(["named …", "home (arm)", "up (arm)"])
    page.select_option("#posture", "1")
    assert page.evaluate(VALUE, "shoulder_lift_joint") == -1.5
    page.select_option("#posture", "0")
    assert page.evaluate(VALUE, "elbow_joint") == 1.25 and page.evaluate(VALUE, "shoulder_lift_joint") == -1.5
    expect(page.locator(".said")).to_contain_text("finger")
    # Another robot has none of them; an SRDF can be added later.
    drop_robot(page, ROBOTS / "kuka/iiwa14.urdf")
    expect(page.locator("#posture")).to_have_count(0)
    drop(page, ("empty.srdf", b'<robot name="iiwa"/>'))
    expect(page.locator(".said.wrong")).to_contain_text("names no posture")


def test_what_denavit_ik_writes_can_be_played(explorer):
    # In the form of `denavit ik --all`.
    rows = [dict(zip(JOINTS, (10.0 * k, -30.5 - k, 90.0, -45.25, k, 1.5), strict=True)) for k in range(5)]
    lines = [f'{k + 1},1,{",".join(str(row[joint]) for joint in JOINTS)},reached,"front, elbow up, wrist not flipped"' for k, row in enumerate(rows)]
    text = "\n".join(["# base → tool0: closed form", "# units: m,deg", f"line,solution,{','.join(JOINTS)},state,branch", *lines, ""])
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, ("joints.csv", text.encode()))
    expect(page.locator("#row-words")).to_have_text(f"row 1 of {len(rows)}")
    for at in (len(rows) - 1, 2):
        page.locator("#row").fill(str(at))
        for joint in JOINTS:
            assert page.evaluate(VALUE, joint) == pytest.approx(math.radians(float(rows[at][joint])), abs=1e-12)
    page.click("#play")
    expect(page.locator("#row-words")).to_have_text(f"row {len(rows)} of {len(rows)}")
    expect(page.locator("#play")).to_have_text("Play")
    # A file with times, whose third row lacks a number.
    drop(page, ("cut.csv", b"time,elbow_joint [deg]\n0,1\n0.5,2\n1,\n"))
    expect(page.locator(".said.wrong")).to_contain_text("cut.csv, line 4: column elbow_joint")
    drop(page, ("timed.csv", b"time,elbow_joint [deg]\n10,1\n10.5,2\n"))
    page.locator("#row").fill("1")
    expect(page.locator("#row-words")).to_have_text("row 2 of 2, 0.5 s")
    assert page.evaluate(VALUE, "elbow_joint") == pytest.approx(math.radians(2))
    page.click("#play-end")
    expect(page.locator(".playback")).to_be_hidden()


def test_the_picture_can_be_kept_as_svg(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    moved(page, POSTURE)
    drawn(page)
    shown = page.evaluate("() => [...document.querySelectorAll('.labels .tag')].filter((it) => !it.hidden).map((it) => it.textContent)")
    with page.expect_download() as waited:
        page.click("#drawing")
    assert waited.value.suggested_filename == "ur5e.svg"
    text = open(waited.value.path(), encoding="utf-8").read()
    drawing = ElementTree.fromstring(text)
    space = "{http://www.w3.org/2000/svg}"
    assert drawing.tag == f"{space}svg" and len(list(drawing.iter(f"{space}path"))) > 50
    assert sorted(it.text for it in drawing.iter(f"{space}text")) == sorted(shown)
    page.set_content(text)
    shot(page, "picture-svg")


def screen(page, point):
    """Screen position of a point in the root's frame."""
    return page.evaluate(
        """([x, y, z]) => {
          const { view } = window.denavit.app;
          const box = view.element.getBoundingClientRect();
          const seen = view.camera.position.clone().set(x, y, z).project(view.camera);
          return [box.left + (seen.x + 1) / 2 * box.width, box.top + (1 - seen.y) / 2 * box.height];
        }""",
        list(point),
    )


def frames(rows, q):
    """The frames of a distal D-H table at joint values."""
    at, out, k = np.eye(4), {}, 0
    for row in rows:
        theta, d, alpha, a = (row.get(name, 0) for name in ("theta", "d", "alpha", "a"))
        if row["row"] not in ("base", "tool"):
            theta, k = theta + q[k], k + 1
        (ct, st), (ca, sa) = (math.cos(theta), math.sin(theta)), (math.cos(alpha), math.sin(alpha))
        at = at @ np.array([[ct, -st * ca, st * sa, a * ct], [st, ct * ca, -ct * sa, a * st], [0, sa, ca, d], [0, 0, 0, 1]])
        out[row["row"]] = at
    return out


def test_the_ruler_measures_between_frames_and_follows_them(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    moved(page, POSTURE)
    page.click("#measure")
    drawn(page)
    origins = page.evaluate(
        """() => { const { app } = window.denavit; const base = app.view.pose(0, app.table.base);
          return Object.fromEntries(window.denavit.placed(app.table, (name) => app.value(name)).map(({ label, to }) => [label, to.clone().premultiply(base).elements.slice(12, 15)])); }"""
    )
    for label in ("2", "6"):
        page.mouse.click(*screen(page, origins[label]))
    expect(page.locator("#measured")).to_contain_text(re.compile("mm from frame 2 to frame "))
    named = re.search("to frame (\\S+);", page.locator("#measured").inner_text()).group(1)
    shot(page, "ruler")
    rows = page.evaluate("() => window.denavit.app.table.rows")
    for q in (POSTURE, [0, -0.4, 0.9, 0.1, 0.2, 0]):
        moved(page, q)
        at = frames(rows, q)
        apart = np.linalg.norm(at[named][:3, 3] - at["2"][:3, 3])
        assert float(page.get_attribute("#measured", "data-metres")) == pytest.approx(apart, abs=1e-9)
    page.keyboard.press("Escape")
    expect(page.locator("#measured")).to_be_hidden()


def page_with(tmp_path, *robots):
    """A page with robots in it, as `denavit explore -o` writes it."""
    place = '<script type="application/json" id="robots">[]</script>'
    held = json.dumps([{"file": file, "text": text} for file, text in robots]).replace("<", "\\u003c")
    path = tmp_path / "page.html"
    path.write_text(PAGE.read_text(encoding="utf-8").replace(place, place.replace("[]", held)), encoding="utf-8")
    return path.as_uri()


def test_differences_stand_by_joint_meshes_last_and_a_pair_begins_where_it_is_apart(explorer, tmp_path):
    text = UR5E.read_text()
    mesh = '<visual name="case"><geometry><mesh filename="package://ur/{}.stl"/></geometry></visual>'
    link = '<link name="forearm_link">'
    one = text.replace(link, link + mesh.format("old"))
    other = text.replace(link, link + mesh.format("new")).replace("0.425", "0.435").replace('upper="3.141592653589793"', 'upper="3"')
    page = explorer(page_with(tmp_path, ("drawn.urdf", one), ("measured.urdf", other)))
    expect(page.locator("#verdict")).to_have_text("Different robots")
    titles = page.locator("#differences h3").all_inner_texts()
    assert titles[0].startswith("tip ") and any(it.startswith('joint "elbow_joint"') for it in titles) and len(titles) == len(set(titles))
    meshes = [at for at, words in enumerate(page.locator("#differences section").all_inner_texts()) if ".stl" in words]
    assert meshes == [len(titles) - 1]
    expect(page.locator(".key.mine")).to_have_text("ur5e (drawn.urdf)")
    found = json.loads(page.locator("#words").get_attribute("data-json"))
    worst = max(found["tips"], key=lambda it: it["sampled_m"])
    for at in worst["at"]:
        assert page.evaluate(VALUE, at["joint"]) == at["value"]
    shot(page, "differences")


def test_rows_can_be_held_out_and_a_fit_shows_where_it_errs_most(explorer, tmp_path):
    data = ROBOTS / "universal_robots/ur5e_tracker.csv"
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, data)
    expect(page.locator("#columns-verdict")).to_contain_text("rows are read")
    page.select_option("#search", "none")
    page.select_option("#hold-out", "0.2")
    page.click("#calibrate")
    expect(page.locator("#stages .bar.test").first).to_be_visible()
    report = json.loads(page.locator("#report").get_attribute("data-json"))
    rows = sum(1 for line in data.read_text().splitlines() if line and line[0] not in "#s")
    assert report["samples"]["test"] == pytest.approx(0.2 * rows, abs=1)
    lefts = page.evaluate("""() => { const q = Object.fromEntries(window.denavit.app.q); return q; }""")
    row = int(re.search(r"Row (\d+) is shown", page.locator("#erring").inner_text()).group(1))
    lines = list(csv.reader(io.StringIO("\n".join(line for line in data.read_text().splitlines() if not line.startswith("#")))))
    columns = [lines[0].index(joint) for joint in JOINTS]
    assert any(all(abs(float(line[at]) - lefts[joint]) < 1e-9 for at, joint in zip(columns, JOINTS, strict=True)) for line in lines[1:]), row
    shot(page, "held-out")


def test_measurements_of_another_robot_are_said_to_be(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    lines = "axis_a,axis_b,x,y,z\n" + "".join(f"{k / 10},{k / 20},0.{k},0.2,0.3\n" for k in range(1, 9))
    drop(page, ("other.csv", lines.encode()))
    expect(page.locator("#columns-verdict")).to_contain_text("This does not look like a measurement of this robot")
    expect(page.locator("#columns-verdict")).to_contain_text("shoulder_pan_joint")


def test_of_several_descriptions_the_ordinary_one_is_shown_and_the_others_are_listed(explorer, tmp_path):
    folder = tmp_path / "a_long_name_of_a_vendor" / "arm_description" / "urdf"
    folder.mkdir(parents=True)
    for name in ("arm_calibrated.urdf", "arm.urdf", "arm_with_gripper.urdf"):
        (folder / name).write_text(UR5E.read_text().replace('name="ur5e"', f'name="{name[:-5]}"', 1))
    page = explorer()
    page.set_input_files("#folder", str(tmp_path / "a_long_name_of_a_vendor"))
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    shown = page.locator("#which option").all_inner_texts()
    assert [words.split(" in ")[0] for words in shown] == ["arm.urdf", "arm_with_gripper.urdf", "arm_calibrated.urdf"]
    assert page.title().startswith("arm ·")
    page.select_option("#which", index=2)
    page.wait_for_function("() => window.denavit.app.robot.opened.robot === 'arm_calibrated'")


def test_a_static_host_has_a_gallery_with_a_link_for_each_robot(explorer):
    site = PAGE.parent / "site"
    links = re.findall(r'href="(explorer\.html#robot=[^"]+)"', (site / "index.html").read_text(encoding="utf-8"))
    named = sorted(urllib.parse.unquote(link.partition("=")[2]) for link in links)
    assert named == sorted(path.relative_to(ROBOTS).as_posix() for path in ROBOTS.rglob("*.urdf"))
    gallery = explorer((site / "index.html").as_uri())
    shot(gallery, "gallery")
    assert gallery.evaluate("() => getComputedStyle(document.querySelector('ul')).display") == "grid"
    page = explorer((site / "explorer.html").as_uri() + next(link for link in links if "iiwa14" in link).removeprefix("explorer.html"))
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    assert page.title().startswith("iiwa14")
    expect(page.locator("#which option")).to_have_count(len(named))


def test_an_edit_says_its_proof_and_gives_the_file_of_the_command_line(explorer, tmp_path):
    page = explorer()
    drop_robot(page, UR5E)
    page.click("#tab-Edit")
    expect(page.locator("#operation option").first).to_have_text("flip")
    offered = page.locator("#operation option").all_text_contents()
    # Every operation of the program except those that need files that a page does not have.
    refused = subprocess.run([denavit(), "edit", UR5E, "nothing", "-o", tmp_path / "none.urdf"], capture_output=True, text=True)
    known = re.search(r"try (.*)", refused.stderr)[1].split(", ")
    assert [*offered] == [name for name in known if name not in ("set-calibration", "simplify-collision", "meshes")]
    shapes = "() => window.denavit.app.view.bodies.map((it) => it?.group.visible ?? false)"
    for name, fields, words in (
        ("flip", {"joint": "wrist_1_joint"}, ["flip", "wrist_1_joint"]),
        ("reroot", {"link": "tool0"}, ["reroot", "tool0"]),
        ("rename", {"old": "tool0", "new": "hand"}, ["rename", "tool0=hand"]),
        ("merge", {}, ["merge"]),
        ("extract", {"link": "forearm_link"}, ["extract", "forearm_link"]),
        ("canonical", {}, ["canonical"]),
        ("origin", {"link": "tool0", "to": "0,0,10mm,0,0,90deg"}, ["origin", "tool0", "--to", "0,0,10mm,0,0,90deg"]),
        ("scale", {"factor": "2"}, ["scale", "2"]),
        ("mirror", {"plane": "xz", "names": "left=right"}, ["mirror", "xz", "--names", "left=right"]),
        ("zero", {"joint": "elbow_joint", "value": "90deg"}, ["zero", "elbow_joint=90deg"]),
    ):
        page.select_option("#operation", name)
        for label, value in fields.items():
            field = page.locator(f"#edit-{label}")
            (field.select_option if field.evaluate("it => it.tagName") == "SELECT" else field.fill)(value)
        page.click("#edit")
        expect(page.locator("#proof li").first).to_contain_text(name)
        said = cli("edit", UR5E, *words, "-o", tmp_path / "edited.urdf")
        assert "; ".join(page.locator("#proof li").all_text_contents()) == said.strip().splitlines()[-1]
        assert downloaded(page, "#download-edited")[0] == (tmp_path / "edited.urdf").read_text()
        assert page.evaluate(shapes) == [False, True]
        page.click("#seen-both")
        assert page.evaluate(shapes) == [True, True]
        shot(page, f"edit-{name}")
    page.click("#seen-before")
    assert page.evaluate(shapes) == [True, False]
    # An impossible edit gives the reason, and nothing is drawn.
    page.select_option("#operation", "cut")
    page.select_option("#edit-link", "base")
    page.click("#edit")
    expect(page.locator("#refused")).to_contain_text("it is the root, so nothing would remain")
    expect(page.locator("#proof")).to_have_count(0)
    assert page.evaluate(shapes) == [True, False]
    shot(page, "edit-refused")
    # An edit may be edited.
    page.select_option("#operation", "prefix")
    page.fill("#edit-prefix", "left_")
    page.click("#edit")
    page.click("#go-on")
    expect(page.locator('input[data-joint="left_elbow_joint"]')).to_be_visible()


def test_another_robot_is_put_on_the_flange(explorer, tmp_path):
    page = explorer()
    drop_robot(page, UR5E)
    page.click("#tab-Edit")
    page.select_option("#operation", "attach")
    page.click("#edit")
    expect(page.locator("#refused")).to_contain_text("write attach FILE --at LINK")
    page.set_input_files("#edit-other", str(ROBOTS / "robotiq/2f_85.urdf"))
    page.select_option("#edit-link", "tool0")
    page.fill("#edit-pose", "0,0,10mm,0,0,90deg")
    page.fill("#edit-prefix", "gripper_")
    page.click("#edit")
    expect(page.locator("#proof")).to_be_visible()
    cli("edit", UR5E, "attach", ROBOTS / "robotiq/2f_85.urdf", "--at", "tool0", "--pose", "0,0,10mm,0,0,90deg", "--prefix", "gripper_", "-o", tmp_path / "edited.urdf")
    assert downloaded(page, "#download-edited")[0] == (tmp_path / "edited.urdf").read_text()
    page.locator("details summary", has_text="Changed lines").click()
    expect(page.locator("#diff .here").first).to_be_visible()
    shot(page, "edit-attach")
