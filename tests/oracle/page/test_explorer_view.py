"""The explorer's picture: names that do not lie on each other, meshes of every kind, and the same view in the pages of
`denavit doc`.
"""

import base64
import struct
import subprocess
from pathlib import Path

import pytest
from explorer_page import DESKTOP, PHONE, ROBOTS, UR5E, VENDOR, browser, cli, denavit, drop_robot, explorer, needs_page, shot, with_page, zipped
from playwright.sync_api import expect

pytestmark = needs_page

NAMES = """() => {
  const view = document.querySelector('.view').getBoundingClientRect();
  const tags = [...document.querySelectorAll('.labels .tag')];
  const boxes = tags.filter((it) => !it.hidden).map((it) => [it.textContent, it.getBoundingClientRect()]);
  const troubles = [];
  boxes.forEach(([one, a], k) => {
    if (a.left < view.left - 1 || a.right > view.right + 1 || a.top < view.top - 1 || a.bottom > view.bottom + 1) troubles.push(`${one} sticks out`);
    for (const [other, b] of boxes.slice(k + 1)) {
      if (a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom) troubles.push(`${one} lies on ${other}`);
    }
  });
  return { troubles, shown: boxes.map(([name]) => name), all: tags.map((it) => it.textContent) };
}"""

def names(page):
    """What is named in the picture, and what lies where it should not, once it is drawn."""
    page.evaluate("() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn)))")
    return page.evaluate(NAMES)


# An arm, a robot with two, and, where they are there, a hand and a humanoid.
ON_A_PHONE = [UR5E, ROBOTS / "rethink/baxter.urdf", *sorted(VENDOR.rglob("allegro*right.urdf"))[:1], *sorted(VENDOR.rglob("g1_29dof*.urdf"))[:1]]


@pytest.mark.parametrize(
    ("robot", "size"), [(UR5E, DESKTOP), *((robot, PHONE) for robot in ON_A_PHONE)], ids=lambda it: it.stem if isinstance(it, Path) else str(it["width"])
)
def test_names_of_frames_lie_beside_each_other_and_every_one_is_seen_when_it_is_asked_for(robot, size, explorer):
    page = explorer(size=size)
    drop_robot(page, robot)
    shot(page, f"names-{robot.stem}-{size['width']}")
    seen = names(page)
    assert seen["troubles"] == [] and len(seen["shown"]) >= 2
    # From far away there is room for few of them, and still none lies on another.
    page.focus(".view")
    for _ in range(12):
        page.keyboard.press("-")
    far = names(page)
    assert far["troubles"] == [] and len(far["shown"]) <= len(seen["all"])
    rows = page.locator("#dh tbody tr")
    for index in range(rows.count()):
        rows.nth(index).focus()
        page.wait_for_function("name => [...document.querySelectorAll('.labels .tag.chosen')].some((it) => it.textContent === name && !it.hidden)", arg=seen["all"][index])


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
    # A material file and a texture beside it, which must not be asked for.
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
    # The rule on meshes knows those that are there.
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


@pytest.mark.parametrize("size", [DESKTOP, PHONE], ids=["desktop", "phone"])
def test_documents_show_the_same_view(size, with_page, explorer, tmp_path):
    cli("doc", ROBOTS / "rethink/baxter.urdf", UR5E, "-o", tmp_path)
    page = explorer((tmp_path / "ur5e.html").as_uri(), size=size)
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
    assert named["troubles"] == [] and len(named["all"]) == 8
    page.locator(".view").scroll_into_view_if_needed()
    shot(page, f"document-{size['width']}")
    page.uncheck("#frames")
    assert names(page)["all"] == []
    page.uncheck("#shapes")
    expect(page.locator("#view")).to_be_visible()
    expect(page.locator(".view")).to_be_hidden()


def test_documents_of_hostile_robots_hold_no_markup_of_theirs(with_page, explorer, tmp_path):
    name = "&lt;/script&gt;&lt;script&gt;alert(1)&lt;/script&gt;"
    robot = tmp_path / "arm.urdf"
    robot.write_text(f"""<robot name="{name}"><link name="{name}"/><link name="t"><visual><geometry><box size="1 1 1"/></geometry></visual></link>
      <joint name="j{name}" type="continuous"><parent link="{name}"/><child link="t"/><axis xyz="0 0 1"/></joint></robot>""")
    cli("doc", robot, "-o", tmp_path / "out")
    page = explorer((tmp_path / "out/arm.html").as_uri())
    page.wait_for_function("() => window.denavit?.view.works")
    assert page.locator("script").count() == 4
