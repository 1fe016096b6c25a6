"""The explorer's picture: names that do not overlap, meshes of every kind, and the same view in the pages of
`denavit doc`.
"""

import base64
import re
import struct
import subprocess
from pathlib import Path

import pytest
from explorer_page import DESKTOP, PHONE, ROBOTS, UR5E, VENDOR, cli, denavit, drop, drop_robot, has_table, needs_page, shot, with_page, zipped
from playwright.sync_api import expect

pytestmark = needs_page

NAMES = """() => {
  const view = document.querySelector('.view').getBoundingClientRect();
  const tags = [...document.querySelectorAll('.labels .tag')];
  const boxes = tags.filter((it) => !it.hidden).map((it) => [it.textContent, it.getBoundingClientRect()]);
  const errors = [];
  boxes.forEach(([one, a], k) => {
    if (a.left < view.left - 1 || a.right > view.right + 1 || a.top < view.top - 1 || a.bottom > view.bottom + 1) errors.push(`${one} sticks out`);
    for (const [other, b] of boxes.slice(k + 1)) {
      if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) errors.push(`${one} lies on ${other}`);
    }
  });
  return { errors, shown: boxes.map(([name]) => name), all: tags.map((it) => it.textContent) };
}"""

def names(page):
    """The names in the picture, and the misplaced ones, after it is drawn."""
    page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
    return page.evaluate(NAMES)


# An arm, a robot with two arms, and, if available, a hand and a humanoid.
ON_A_PHONE = [UR5E, ROBOTS / "rethink/baxter.urdf", *sorted(VENDOR.rglob("allegro*right.urdf"))[:1], *sorted(VENDOR.rglob("g1_29dof*.urdf"))[:1]]


@pytest.mark.parametrize(
    ("robot", "size"), [(UR5E, DESKTOP), *((robot, PHONE) for robot in ON_A_PHONE)], ids=lambda it: it.stem if isinstance(it, Path) else str(it["width"])
)
def test_names_of_frames_lie_beside_each_other_and_every_one_is_seen_when_it_is_asked_for(robot, size, explorer):
    page = explorer(size=size)
    drop_robot(page, robot)
    shot(page, f"names-{robot.stem}-{size['width']}")
    seen = names(page)
    assert seen["errors"] == [] and len(seen["shown"]) >= 2
    # From far away there is room for few of them, and still none overlap.
    page.focus(".view")
    for _ in range(12):
        page.keyboard.press("-")
    far = names(page)
    assert far["errors"] == [] and len(far["shown"]) <= len(seen["all"])
    rows = page.locator("#dh tbody tr")
    for index in range(rows.count()):
        rows.nth(index).focus()
        page.wait_for_function("name => [...document.querySelectorAll('.labels .tag.chosen')].some((it) => it.textContent === name && !it.hidden)", arg=seen["all"][index])


SIZES = """() => {
  const { view } = window.denavit.app;
  const [reach, rods] = [view.bodies[0].ball().radius, []];
  view.overlay.traverse((it) => { if (it.isMesh) rods.push([it.geometry.parameters.radiusTop, it.geometry.parameters.height]); });
  // How much of the picture the robot takes, and how long the axes of a frame are, both seen.
  const distance = view.camera.position.distanceTo(view.controls.target);
  return { filled: reach / (distance * Math.sin((view.camera.fov * Math.PI) / 360)), axis: Math.max(...view.overlay.children.filter((it) => it.userData.row !== undefined)[0].children.map((it) => it.geometry.parameters.height)), reach, thick: Math.max(...rods.map(([radius]) => radius)) };
}"""


def arm(scale):
    """A slewing, luffing, telescoping arm of this length of boom, m, with shapes."""
    link = lambda name, length: f'<link name="{name}"><visual><origin xyz="0 0 {length * scale / 2}"/><geometry><cylinder radius="{scale * 0.04}" length="{length * scale}"/></geometry></visual></link>'
    joint = lambda name, kind, parent, child, xyz, axis: f'<joint name="{name}" type="{kind}"><origin xyz="{xyz}"/><parent link="{parent}"/><child link="{child}"/><axis xyz="{axis}"/><limit lower="0" upper="{scale}" effort="1" velocity="1"/></joint>'
    return f"""<robot name="crane"><link name="base"/>{link("mast", 1)}{link("boom", 1)}{link("jib", 0.5)}
      {joint("slew", "revolute", "base", "mast", "0 0 0", "0 0 1")}{joint("luff", "revolute", "mast", "boom", f"{scale * 0.1} 0 {scale}", "0 1 0")}
      {joint("extend", "prismatic", "boom", "jib", f"0 0 {scale}", "0 0 1")}</robot>""".encode()


@pytest.mark.parametrize("scale", [10, 0.02], ids=["crane of 30 m", "arm of 5 cm"])
def test_frames_are_drawn_in_proportion_whatever_the_size_of_the_robot(scale, explorer):
    page = explorer()
    drop_robot(page, (f"arm{scale}.urdf", arm(scale)))
    seen = page.evaluate(SIZES)
    assert 0.5 < seen["filled"] < 1
    assert 0.05 < seen["axis"] / seen["reach"] < 0.4 and seen["thick"] < 0.02 * seen["reach"]
    shot(page, f"size-{scale}")


def test_frames_of_a_finger_are_as_large_as_a_finger_and_a_hand_fills_the_view(explorer):
    page = explorer()
    drop_robot(page, ROBOTS / "robotiq/2f_85.urdf")
    seen = page.evaluate(SIZES)
    assert 0.5 < seen["filled"] < 1 and seen["axis"] < 0.03
    shot(page, "gripper")
    # The same gripper at the end of a long boom: its frames keep their size.
    text = (ROBOTS / "robotiq/2f_85.urdf").read_text()
    root = re.search(r'<link name="([^"]+)"', text).group(1)
    boom = f'<link name="ground"/><joint name="boom" type="revolute"><origin xyz="20 0 20"/><parent link="ground"/><child link="{root}"/><axis xyz="0 1 0"/><limit lower="0" upper="1" effort="1" velocity="1"/></joint></robot>'
    drop(page, ("boom.urdf", text.replace("</robot>", boom).encode()))
    has_table(page, "boom.urdf")
    beside = page.evaluate(SIZES)
    assert beside["reach"] > 10 and beside["axis"] < 0.05


def test_links_whose_meshes_are_missing_are_drawn_as_rods(explorer):
    page = explorer()
    rods = "() => { let n = 0; window.denavit.app.view.bodies[0].group.traverse((it) => { if (it.isMesh && it.geometry.type === 'CylinderGeometry') n++; }); return n; }"
    mesh, ball = '<mesh filename="gone.stl"/>', '<sphere radius="0.05"/>'
    joint = '<joint name="{0}{1}" type="continuous"><origin xyz="0 0 0.3"/><parent link="{0}"/><child link="{1}"/><axis xyz="1 0 0"/></joint>'
    links = '<link name="a"><visual><geometry><box size="0.1 0.1 0.1"/></geometry></visual></link><link name="b"><visual><geometry>{}</geometry></visual></link><link name="c"/>'
    robot = "<robot name='arm'>" + links + joint.format("a", "b") + joint.format("b", "c") + "</robot>"
    drop_robot(page, ("arm.urdf", robot.format(mesh).encode()))
    # From b to c, and the axes of the two joints below a.
    assert page.evaluate(rods) == 3
    drop(page, ("arm2.urdf", robot.format(ball).encode()))
    page.wait_for_function("() => window.denavit.app.robot?.file === 'arm2.urdf'")
    assert page.evaluate(rods) == 0


def test_the_frame_of_the_link_under_the_pointer_is_drawn_and_named(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    links = page.evaluate("() => window.denavit.app.robot.opened.scene.links.map((it) => it.name)")
    box = page.locator(".view").bounding_box()
    for step in range(1, 60):
        page.mouse.move(box["x"] + step / 60 * box["width"], box["y"] + 0.45 * box["height"])
        words = page.locator(".tag.pointer").inner_text() if page.locator(".tag.pointer").is_visible() else ""
        if words in links:
            break
    assert words in links
    apart = page.evaluate(
        """link => {
          const { view } = window.denavit.app;
          const at = view.pose(0, link).elements.slice(12, 15);
          const drawn = view.pointed.children[0].children.map((it) => it.position.toArray());
          return Math.min(...drawn.map((point) => Math.hypot(...point.map((value, axis) => value - at[axis])))) / view.size;
        }""",
        words,
    )
    assert apart < 0.1
    page.mouse.move(2, 2)
    page.wait_for_function("() => window.denavit.app.view.pointed.children.length === 0")


def test_a_tap_names_what_lies_under_it_inside_of_the_view(browser, explorer):
    page = explorer(size=PHONE)
    drop_robot(page, UR5E)
    box = page.locator(".view").bounding_box()
    named = set()
    for share in range(1, 120):
        page.evaluate(
            """([x, y]) => document.querySelector('.view canvas').dispatchEvent(new MouseEvent('click', { clientX: x, clientY: y, bubbles: true }))""",
            [box["x"] + share / 120 * box["width"], box["y"] + (0.3 + 0.1 * (share % 5)) * box["height"]],
        )
        pointer = page.locator(".tag.pointer")
        if pointer.is_visible():
            named.add(pointer.inner_text())
            own = pointer.bounding_box()
            assert own["x"] >= box["x"] - 1 and own["x"] + own["width"] <= box["x"] + box["width"] + 1
    assert len(named) >= 2, named


# Four triangles of a tetrahedron with edges of 0.1 m along the axes, in every kind of file.
POINTS = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def stl_text():
    facets = "".join("facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*POINTS[k]) for k in face) + "endloop\nendfacet\n" for face in FACES)
    return f"solid t\n{facets}endsolid t\n".encode()


def stl_binary():
    facets = b"".join(struct.pack("<12fH", 0, 0, 0, *(value for k in face for value in POINTS[k]), 0) for face in FACES)
    return b"\0" * 80 + struct.pack("<I", len(FACES)) + facets


def obj():
    # A material file and a texture beside it, which must not be requested.
    points = "".join("v {} {} {}\n".format(*point) for point in POINTS)
    return ("mtllib http://127.0.0.1:9/evil.mtl\n" + points + "".join("f {} {} {}\n".format(*(k + 1 for k in face)) for face in FACES)).encode()


def dae(up="Z_UP"):
    return f"""<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>{up}</up_axis></asset>
<library_images><image id="i"><init_from>http://127.0.0.1:9/evil.png</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><phong><diffuse><color>0 0.5 0 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="pa" count="12">{" ".join(str(v) for point in POINTS for v in point)}</float_array>
<technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles material="m" count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>{" ".join(str(k) for face in FACES for k in face)}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m" target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()


def robot_of(meshes):
    visuals = "".join(f'<visual><origin xyz="0 0 {k}"/><geometry><mesh filename="{mesh}" scale="1 2 1"/></geometry></visual>' for k, mesh in enumerate(meshes))
    return f"""<robot name="arm"><link name="base">{visuals}</link><link name="tip"/><joint name="j" type="continuous"><origin xyz="0 0 0.5"/><parent link="base"/><child link="tip"/><axis xyz="0 0 1"/></joint></robot>"""


SHAPES = """() => {
  const found = [];
  window.denavit.app.view.bodies[0].group.traverse((it) => {
    const points = it.isMesh && it.geometry.attributes.position;
    if (!points || points.count !== 12) return;
    const high = [0, 0, 0];
    for (let k = 0; k < points.count; k++) {
      const at = it.position.clone().fromBufferAttribute(points, k).applyMatrix4(it.matrixWorld);
      at.toArray().forEach((value, axis) => { high[axis] = Math.max(high[axis], value); });
    }
    found.push({ high, green: it.material.color.g > 2 * it.material.color.b });
  });
  return found.sort((a, b) => a.high[2] - b.high[2]);
}"""


def shapes_stand_where_they_belong(page):
    shapes = page.evaluate(SHAPES)
    for k, shape in enumerate(shapes):
        assert shape["high"] == pytest.approx([0.1, 0.2, k + 0.1], abs=1e-6)
    return shapes


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_meshes_of_a_dropped_folder_are_shown_whatever_their_kind(theme, explorer, tmp_path):
    files = {"text.stl": stl_text(), "binary.STL": stl_binary(), "arm.dae": dae(), "arm.obj": obj()}
    names = ["package://arm_description/meshes/text.stl", "../meshes/binary.STL", "package://arm_description/meshes/arm.dae", "package://arm_description/meshes/arm.obj"]
    folder = tmp_path / "arm_description"
    for name, content in {**{f"meshes/{name}": content for name, content in files.items()}, "urdf/arm.urdf": robot_of(names).encode(), "package.xml": b"<package><name>arm_description</name></package>"}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    page = explorer(theme=theme)
    page.set_input_files("#folder", str(folder))
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    shapes = shapes_stand_where_they_belong(page)
    assert len(shapes) == 4 and page.evaluate("() => window.denavit.app.view.missing") == []
    assert [shape["green"] for shape in shapes] == [False, False, True, False]
    shot(page, f"meshes-{theme}")


def test_meshes_that_are_damaged_or_not_there_are_named(explorer):
    page = explorer()
    lies = b"\0" * 80 + struct.pack("<I", 0xFFFFFFFF) + b"\0" * 50
    names = ["lies.stl", "cut.dae", "empty.obj", "gone.stl"]
    drop_robot(page, ("arm.zip", zipped({"arm.urdf": robot_of(names), "lies.stl": lies, "cut.dae": dae()[:400], "empty.obj": b"# nothing\n"})))
    missing = page.evaluate("() => window.denavit.app.view.missing")
    assert "gone.stl" in missing and "empty.obj" in missing and "lies.stl" in missing, missing
    expect(page.locator(".notes")).to_contain_text("meshes are not shown")


def test_explore_brings_the_meshes(with_page, explorer, tmp_path):
    folder = tmp_path / "arm_description"
    (folder / "meshes").mkdir(parents=True)
    (folder / "package.xml").write_text("<package><name>arm_description</name></package>")
    (folder / "meshes/arm.stl").write_bytes(stl_binary())
    (folder / "meshes/arm.dae").write_bytes(dae())
    (tmp_path / "secret.txt").write_text("nobody's business")
    names = ["package://arm_description/meshes/arm.stl", "meshes/arm.dae", "../secret.txt"]
    robot = folder / "arm.urdf"
    robot.write_text(robot_of(names))
    file = tmp_path / "page.html"
    cli("explore", robot, "-o", file)
    assert base64.b64encode(b"nobody's")[:8].decode() not in file.read_text()
    page = explorer(file.as_uri())
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    assert len(shapes_stand_where_they_belong(page)) == 2
    assert page.evaluate("() => window.denavit.app.view.missing") == ["../secret.txt"]
    # The rule on meshes finds the existing ones.
    mentioned = page.locator(".finding summary").all_inner_texts()
    assert not any("arm.stl" in words or "arm.dae" in words for words in mentioned), mentioned


def test_explore_compares_a_revision_with_the_file(with_page, explorer, tmp_path):
    def git(*words):
        subprocess.run(["git", "-c", "user.name=a", "-c", "user.email=a@b", *words], cwd=tmp_path, check=True, capture_output=True)

    git("init", "-q")
    robot = tmp_path / "arm.urdf"
    robot.write_text(UR5E.read_text())
    git("add", "arm.urdf")
    git("commit", "-qm", "arm")
    robot.write_text(UR5E.read_text().replace("0.425", "0.435"))
    done = subprocess.run([denavit(), "explore", "git:HEAD:arm.urdf", "arm.urdf", "-o", "page.html"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    page = explorer((tmp_path / "page.html").as_uri())
    expect(page.locator("#verdict")).to_have_text("Different robots")
    expect(page.locator("#worst")).to_contain_text("mm")


@pytest.mark.parametrize(("size", "theme"), [(DESKTOP, "light"), (PHONE, "dark"), (DESKTOP, "dark")], ids=["desktop", "phone", "dark"])
def test_documents_show_the_same_view(size, theme, with_page, explorer, tmp_path):
    cli("doc", ROBOTS / "rethink/baxter.urdf", UR5E, "-o", tmp_path)
    page = explorer((tmp_path / "ur5e.html").as_uri(), size=size, theme=theme)
    unreadable = page.evaluate(UNREADABLE)
    assert unreadable == []
    page.wait_for_function("() => window.denavit?.view.works")
    expect(page.locator("#view")).to_be_hidden()
    expect(page.locator(".view canvas")).to_be_visible()
    assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth")
    slider = page.locator("#sliders input").nth(1)
    slider.evaluate("it => { it.value = -1.2; it.dispatchEvent(new Event('input', { bubbles: true })); }")
    said = [float(page.get_attribute(f"#tip-{name}", "data-value")) for name in "xyz"]
    seen = page.evaluate("() => window.denavit.view.pose(0, 'tool0').elements.slice(12, 15)")
    assert seen == pytest.approx(said, abs=1e-9)
    named = names(page)
    assert named["errors"] == [] and len(named["all"]) == 8
    page.locator(".view").scroll_into_view_if_needed()
    shot(page, f"document-{size['width']}-{theme}")
    page.uncheck("#frames")
    assert names(page)["all"] == []
    page.uncheck("#shapes")
    expect(page.locator("#view")).to_be_visible()
    expect(page.locator(".view")).to_be_hidden()


# Words with too little contrast to their background (WCAG 2, 4.5 : 1), except words in drawings.
UNREADABLE = """() => {
  const canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
  const read = (colour) => { canvas.clearRect(0, 0, 1, 1); canvas.fillStyle = colour; canvas.fillRect(0, 0, 1, 1); return [...canvas.getImageData(0, 0, 1, 1).data]; };
  const light = (rgb) => { const [r, g, b] = rgb.slice(0, 3).map((c) => { const s = c / 255; return s <= 0.04045 ? s / 12.92 : ((s + 0.055) / 1.055) ** 2.4; }); return 0.2126 * r + 0.7152 * g + 0.0722 * b; };
  const under = (it) => { for (let at = it; at; at = at.parentElement) { const colour = read(getComputedStyle(at).backgroundColor); if (colour[3] === 255) return colour; } return [255, 255, 255, 255]; };
  const texts = [...document.querySelectorAll('body *')].filter((it) => !it.closest('svg, .view, script, style') && [...it.childNodes].some((child) => child.nodeType === 3 && child.textContent.trim()) && it.getClientRects().length);
  return texts.flatMap((it) => {
    const [a, b] = [light(read(getComputedStyle(it).color)), light(under(it))];
    const contrast = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    return contrast < 4.5 ? [`${it.tagName} "${it.textContent.trim().slice(0, 30)}" ${contrast.toFixed(1)}`] : [];
  });
}"""


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_reports_can_be_read_in_either_theme(theme, explorer, tmp_path):
    data = ROBOTS / "universal_robots/ur5e_tracker.csv"
    cli("calibrate", UR5E, "--data", data, "--effects", "none", "--html", tmp_path / "report.html", "--json", tmp_path / "report.json")
    page = explorer((tmp_path / "report.html").as_uri(), theme=theme)
    assert page.evaluate(UNREADABLE) == []
    dark = page.evaluate("() => getComputedStyle(document.body).backgroundColor") != "rgb(255, 255, 255)"
    assert dark == (theme == "dark")
    shot(page, f"report-{theme}")


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_every_word_of_the_explorer_can_be_read_in_either_theme(theme, explorer):
    page = explorer(theme=theme)
    assert page.evaluate(UNREADABLE) == []
    drop_robot(page, UR5E)
    for tab in ("See", "Calibrate", "Learn"):
        page.click(f"#tab-{tab}")
        page.wait_for_timeout(300)
        # Disabled buttons are pale on purpose.
        pale = [words for words in page.evaluate(UNREADABLE) if not words.startswith('BUTTON "Back"')]
        assert pale == [], tab


def test_documents_of_hostile_robots_hold_no_markup_of_theirs(with_page, explorer, tmp_path):
    name = "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;"
    robot = tmp_path / "arm.urdf"
    robot.write_text(f"""<robot name="{name}"><link name="{name}"/><link name="t"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
      <joint name="j{name}" type="continuous"><parent link="{name}"/><child link="t"/><axis xyz="0 0 1"/></joint></robot>""")
    cli("doc", robot, "-o", tmp_path / "out")
    page = explorer((tmp_path / "out/arm.html").as_uri())
    page.wait_for_function("() => window.denavit?.view.works")
    assert page.locator("script").count() == 4
