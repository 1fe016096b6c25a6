"""The explorer shows the current data: never a previous robot's rows, another chain's name, or half a number."""

import math
import struct

import pytest
from explorer_page import ROBOTS, UR5E, drawn, drop, drop_robot, needs_page, shot
from playwright.sync_api import expect

pytestmark = needs_page

FAILS = UR5E.read_text().replace("0.1625", "1.625e8")


def test_a_robot_without_a_table_shows_none(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    drop(page, ("second.urdf", FAILS.encode()))
    page.wait_for_function("() => window.denavit.app.robot?.file === 'second.urdf'")
    expect(page.locator("#no-table")).to_be_visible()
    expect(page.locator("#dh")).to_have_count(0)
    assert page.evaluate("() => window.denavit.app.view.overlay.children.length") == 0
    assert page.evaluate("() => document.querySelectorAll('.labels .tag').length") == 0
    shot(page, "no-table")
    # The next robot has its own table again.
    drop_robot(page, UR5E)
    expect(page.locator("#no-table")).to_have_count(0)


def test_the_panel_of_a_robot_before_does_not_stay(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    page.click("#tab-Learn")
    expect(page.locator("[aria-label=Learn]")).not_to_be_empty()
    drop(page, ("second.urdf", FAILS.encode()))
    page.wait_for_function("() => window.denavit.app.robot?.file === 'second.urdf'")
    expect(page.locator("[aria-label=Learn]")).to_contain_text("no derivation")


def long_robot(count):
    joints = "".join(
        f'<link name="l{k + 1}"/><joint name="j{k + 1}" type="continuous"><parent link="l{k}"/><child link="l{k + 1}"/>'
        f'<origin xyz="0.001 0 0" rpy="{1.5707963267948966 if k % 2 else 0} 0 0"/><axis xyz="0 0 1"/></joint>'
        for k in range(count)
    )
    return f'<robot name="long"><link name="l0"/>{joints}</robot>'.encode()


def test_four_thousand_joints_are_shown(explorer):
    page = explorer()
    drop(page, ("long.urdf", long_robot(4000)))
    page.wait_for_function("() => window.denavit.app.robot?.file === 'long.urdf'", timeout=120_000)
    expect(page.locator(".said.wrong:not(:empty)")).to_have_count(0)
    expect(page.locator(".tree li")).to_have_count(4001)
    expect(page.locator("#dh tbody tr")).to_have_count(4002, timeout=240_000)


CUT = """() => {
  const box = document.querySelector('#dh').closest('.scroll').getBoundingClientRect();
  const shown = [box.left - 0.5, Math.min(box.right, innerWidth) + 0.5];
  return [...document.querySelectorAll('#dh .number')].filter((cell) => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    const { left, right } = range.getBoundingClientRect();
    return right > left && left < shown[1] && right > shown[1] || left < shown[0] && right > shown[0];
  }).map((cell) => cell.textContent);
}"""


@pytest.mark.parametrize("robot", ["universal_robots/ur5e.urdf", "rethink/baxter.urdf", "denso/hsr065_screw_spline.urdf"])
def test_no_number_of_a_table_is_cut(robot, explorer):
    page = explorer()
    drop_robot(page, ROBOTS / robot)
    for width in (1360, 1024, 900, 768, 360):
        page.set_viewport_size({"width": width, "height": 800})
        for convention in ("distal", "proximal", "hayati"):
            page.select_option("#convention", convention)
            page.wait_for_function("name => window.denavit.app.table?.convention === name", arg=convention)
            drawn(page)
            assert page.evaluate(CUT) == [], (width, convention)
            if convention == "distal" and robot.startswith("rethink"):
                shot(page, f"table-{width}")


def test_joint_values_can_be_typed(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    typed = page.locator('[data-typed="elbow_joint"]')
    for written, value in (("-90", -math.pi / 2), ("12,5", math.radians(12.5)), ("30 °", math.radians(30))):
        typed.fill(written)
        typed.press("Enter")
        assert page.evaluate("() => window.denavit.app.value('elbow_joint')") == pytest.approx(value, abs=1e-12)
    page.wait_for_function("() => JSON.parse(document.getElementById('tip').dataset.q).elbow_joint > 0.5")
    for written in ("900", "here", ""):
        typed.fill(written)
        typed.press("Enter")
        expect(page.locator(".said.wrong")).to_contain_text("elbow_joint takes a number from -360 to 360 °")
        assert page.evaluate("() => window.denavit.app.value('elbow_joint')") == pytest.approx(math.radians(30))


COUNT = "() => { let n = 0; window.denavit.app.view.bodies[0].group.traverse((it) => { if (it.isMesh && visible(it)) n++; }); return n; function visible(it) { for (let at = it; at; at = at.parent) if (!at.visible) return false; return true; } }"


def test_collision_inertia_centres_axes_and_frames_are_shown_on_demand(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    before = page.evaluate(COUNT)
    seen = {}
    for layer in ("inertia", "mass", "axes", "frames"):
        page.check(f'[data-layer="{layer}"]')
        seen[layer] = page.evaluate(COUNT) - before
        shot(page, f"layer-{layer}")
        page.uncheck(f'[data-layer="{layer}"]')
        assert page.evaluate(COUNT) == before
    links = page.evaluate("() => window.denavit.app.robot.opened.scene.links.filter((link) => link.inertial?.mass > 0).length")
    assert seen["mass"] == links > 0
    assert seen["frames"] == 3 * page.evaluate("() => window.denavit.app.robot.opened.scene.links.length")
    assert seen["axes"] == page.evaluate("() => window.denavit.app.robot.opened.scene.joints.filter((joint) => joint.kind !== 'fixed').length")
    page.uncheck('[data-layer="visual"]')
    assert page.evaluate(COUNT) < before


def test_a_box_of_inertia_is_the_box_that_has_it(explorer):
    # A solid box of 2 kg, 0.3 by 0.2 by 0.1 m, turned about z by a quarter turn.
    moments = [2 * (0.2**2 + 0.1**2) / 12, 2 * (0.3**2 + 0.1**2) / 12, 2 * (0.3**2 + 0.2**2) / 12]
    inertia = f'<inertia ixx="{moments[1]!r}" iyy="{moments[0]!r}" izz="{moments[2]!r}" ixy="0" ixz="0" iyz="0"/>'
    text = f"""<robot name="box"><link name="a"/><link name="b"><inertial><origin xyz="0.1 0 0.5"/><mass value="2"/>{inertia}</inertial>
      <collision><geometry><sphere radius="0.1"/></geometry></collision></link>
      <joint name="j" type="continuous"><parent link="a"/><child link="b"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/></joint></robot>"""
    page = explorer()
    drop_robot(page, ("box.urdf", text.encode()))
    shapes = page.evaluate(COUNT)
    page.check('[data-layer="collision"]')
    assert page.evaluate(COUNT) == shapes + 1
    page.check('[data-layer="inertia"]')
    box = page.evaluate(
        """() => {
          let found;
          window.denavit.app.view.bodies[0].group.traverse((it) => { if (it.geometry?.type === 'BoxGeometry') found = it; });
          found.geometry.computeBoundingBox();
          const { min, max } = found.geometry.boundingBox.clone().applyMatrix4(found.matrixWorld);
          return [max.x - min.x, max.y - min.y, max.z - min.z, (max.x + min.x) / 2, (max.y + min.y) / 2, (max.z + min.z) / 2];
        }"""
    )
    assert box == pytest.approx([0.2, 0.3, 0.1, 0.1, 0, 1.5], abs=1e-6)


def test_the_picture_can_be_kept(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    drawn(page)
    with page.expect_download() as waited:
        page.click("#picture")
    assert waited.value.suggested_filename == "ur5e.png"
    content = open(waited.value.path(), "rb").read()
    width, height = struct.unpack(">II", content[16:24])
    box = page.locator(".view").bounding_box()
    assert content[:8] == b"\x89PNG\r\n\x1a\n"
    assert abs(width - 2 * box["width"]) <= 2 and abs(height - 2 * box["height"]) <= 2


def test_findings_stand_before_notes(explorer):
    page = explorer()
    drop_robot(page, ("cut.urdf", UR5E.read_text().replace("1.5707963267948966", "1.5708").encode()))
    expect(page.locator(".finding").first).to_be_visible()
    first = page.evaluate("() => document.querySelector('.finding').compareDocumentPosition(document.querySelector('.notes')) & Node.DOCUMENT_POSITION_FOLLOWING")
    assert first
    expect(page.locator(".noted")).not_to_have_attribute("open", "")
    expect(page.locator(".noted summary")).to_contain_text("Notes (")


def test_compare_looks_at_both_robots(explorer):
    page = explorer()
    far = UR5E.read_text().replace('<origin xyz="0 0 0" rpy="0 0 0"/>', '<origin xyz="4 0 0" rpy="0 0 0"/>', 1)
    drop_robot(page, UR5E)
    page.click("#tab-Compare")
    drop(page, ("far.urdf", far.encode()))
    expect(page.locator("#verdict")).to_be_visible()
    page.wait_for_function(
        """() => {
          const { view } = window.denavit.app;
          return [0, 1].flatMap((at) => view.bodies[at].places()).every((place) => {
            const seen = place.clone().project(view.camera);
            return Math.abs(seen.x) < 1 && Math.abs(seen.y) < 1;
          });
        }"""
    )


def test_arrow_keys_go_from_tab_to_tab(explorer):
    page = explorer()
    drop_robot(page, UR5E)
    page.focus("#tab-See")
    for key, name in (("ArrowRight", "Compare"), ("ArrowLeft", "See"), ("ArrowLeft", "Learn"), ("Home", "See")):
        page.keyboard.press(key)
        expect(page.locator(f"#tab-{name}")).to_be_focused()
        expect(page.locator(f"#tab-{name}")).to_have_attribute("aria-selected", "true")


def test_long_names_wrap_or_are_shown_on_hover(explorer):
    page = explorer()
    name = "left_manipulator_of_the_second_cell_shoulder_pan_joint"
    drop_robot(page, ("cell.urdf", UR5E.read_text().replace("shoulder_pan_joint", name).replace('"tool0"', '"tool_of_the_left_manipulator_of_the_cell"').encode()))
    slider = page.locator(".slider .name").first
    assert (slider.text_content(), slider.get_attribute("title")) == (name, name)
    expect(page.locator("#chain")).to_have_attribute("title", "base → tool_of_the_left_manipulator_of_the_cell  (6)")
    page.click("#tab-Edit")
    expect(page.locator("#edit-joint")).to_have_attribute("title", name)
    page.select_option("#edit-joint", "elbow_joint")
    expect(page.locator("#edit-joint")).to_have_attribute("title", "elbow_joint")
    cut = """() => [...document.querySelectorAll('header *, .joints *, .right *')].filter((it) => it.children.length === 0 && it.tagName !== 'OPTION'
      && it.clientWidth > 0 && it.scrollWidth > it.clientWidth + 1 && !it.title && it.textContent.trim()).map((it) => it.textContent)"""
    assert page.evaluate(cut) == []
