"""The tip dragged in the page: the posture follows on its branch, ghosts are the other solutions of `denavit ik`, and unreachable poses are reported."""

import json
import math

import numpy as np
import pytest
from explorer_page import ROBOTS, UR5E, cli, drawn, drop_robot, needs_page, shot
from playwright.sync_api import expect

pytestmark = needs_page

POSTURE = {"shoulder_pan_joint": 0.6, "shoulder_lift_joint": -1.1, "elbow_joint": 1.3, "wrist_1_joint": -0.8, "wrist_2_joint": -1.2, "wrist_3_joint": 0.3}
STATE = """() => {
  const { app, chain } = window.denavit;
  const { base, tip, coordinates } = chain(app.robot);
  const from = app.view.pose(0, base).clone().invert().multiply(app.view.pose(0, tip));
  return { q: coordinates.map((name) => app.value(name)), tip: from.toArray(), ghosts: app.view.phantoms.length };
}"""
AT = """() => {
  const { view } = window.denavit.app;
  const seen = view.held.position.clone().project(view.camera);
  const box = view.element.getBoundingClientRect();
  return [box.left + ((seen.x + 1) / 2) * box.width, box.top + ((1 - seen.y) / 2) * box.height];
}"""


def pose(page, values):
    for name, value in values.items():
        page.locator(f'input[data-joint="{name}"]').evaluate("(it, q) => { it.value = q; it.dispatchEvent(new Event('input')); }", value)


def begin(page, robot=UR5E, values=POSTURE):
    drop_robot(page, robot)
    pose(page, values)
    page.click("#drag")
    expect(page.locator("#reach")).to_have_attribute("data-state", "reached")
    at_rest(page)


def at_rest(page):
    """Waits until every question was answered, and the results are drawn."""
    page.wait_for_function("() => window.denavit.reach.settled")
    drawn(page)


def drag(page, *steps):
    """Grabs the middle of the handle and moves by these steps, in pixels; the button stays down."""
    x, y = page.evaluate(AT)
    page.mouse.move(x, y)
    page.mouse.down()
    for dx, dy in steps:
        page.mouse.move(x + dx, y + dy)
        at_rest(page)


def solutions(found, near):
    """The command line's solutions for a pose of the tip."""
    matrix = np.array(found["tip"]).reshape(4, 4).T
    roll, pitch = math.atan2(matrix[2, 1], matrix[2, 2]), math.atan2(-matrix[2, 0], math.hypot(matrix[0, 0], matrix[1, 0]))
    numbers = [*matrix[:3, 3], roll, pitch, math.atan2(matrix[1, 0], matrix[0, 0])]
    text = cli("ik", UR5E, f"--pose={','.join(map(repr, map(float, numbers)))}", f"--near={','.join(map(repr, near))}", "--units", "m,rad", "--all", "--json")
    return json.loads(text)["poses"][0]["solutions"]


def test_the_posture_follows_the_tip_on_its_branch(explorer):
    page = explorer()
    begin(page)
    before = page.evaluate(STATE)
    branch = page.locator("#branch option").first.text_content()
    drag(page, (10, -5), (22, -12), (36, -20))
    shot(page, "drag")
    page.mouse.up()
    at_rest(page)
    after = page.evaluate(STATE)
    moved = np.subtract(after["tip"], before["tip"])
    assert np.linalg.norm(moved[12:15]) > 0.02
    assert np.abs(moved[:12]).max() < 1e-6, "moved, not turned"
    # The tip by the view's own kinematics is where the handle was dragged to.
    wanted = json.loads(page.get_attribute("#reach", "data-wanted"))
    assert np.abs(np.subtract(after["tip"], wanted)).max() < 1e-8
    assert 0 < np.abs(np.subtract(after["q"], before["q"])).max() < 0.5
    assert page.locator("#branch option").first.text_content() == branch
    # The sliders and the line of the tip show the posture.
    page.wait_for_function("q => JSON.parse(document.getElementById('tip').dataset.q).elbow_joint === q", arg=after["q"][2])
    print("milliseconds that the engine took for the last answer:", page.get_attribute("#reach", "data-took"))


def test_ghosts_are_the_other_solutions_and_a_click_takes_one(explorer):
    page = explorer()
    begin(page)
    before = page.evaluate(STATE)
    found = solutions(before, before["q"])
    assert before["ghosts"] == len(found) - 1 == 7
    told = page.locator("#branch option").all_text_contents()
    assert sorted(told) == sorted(solution["branch"] for solution in found)
    shot(page, "ghosts")
    # A point away from the handle and from the edges, where a ghost is in front of everything else.
    spot = page.evaluate(
        """([tipX, tipY]) => {
          const { view } = window.denavit.app;
          const box = view.element.getBoundingClientRect();
          const ghost = (x, y) => view.ghostUnder(view.ray({ clientX: x, clientY: y }));
          for (let y = Math.ceil(box.top) + 40; y < box.bottom - 40; y += 8) for (let x = Math.ceil(box.left) + 40; x < box.right - 40; x += 8) {
            if (Math.hypot(x - tipX, y - tipY) < 150) continue;
            const here = ghost(x, y);
            if (here !== undefined && [[3, 0], [-3, 0], [0, 3], [0, -3]].every(([dx, dy]) => ghost(x + dx, y + dy) === here)) return [x, y, here];
          }
        }""",
        page.evaluate(AT),
    )
    x, y, ghost = spot
    page.mouse.move(x, y)
    drawn(page)
    expect(page.locator(".tag.pointer:not([hidden])")).to_have_text(told[ghost + 1])
    shot(page, "ghost-pointed")
    page.mouse.click(x, y)
    at_rest(page)
    after = page.evaluate(STATE)
    assert np.abs(np.subtract(after["tip"], before["tip"])).max() < 1e-8
    assert page.locator("#branch option").first.text_content() == told[ghost + 1]
    joints = next(solution["joints"] for solution in found if solution["branch"] == told[ghost + 1])
    # The same turns of each joint; `near` is another posture now.
    turns = np.subtract(after["q"], list(joints.values())) / math.tau
    assert np.abs(turns - np.round(turns)).max() < 1e-8
    # The box has the effect of a click on a ghost.
    page.select_option("#branch", label=told[0])
    at_rest(page)
    back = page.evaluate(STATE)
    assert np.abs(np.subtract(back["q"], before["q"])).max() < 1e-8
    page.keyboard.press("Escape")
    expect(page.locator("#reach")).to_be_hidden()
    assert page.evaluate(STATE)["ghosts"] == 0


def test_the_tip_can_be_turned_and_typed(explorer):
    page = explorer()
    begin(page)
    before = page.evaluate(STATE)
    page.click("#turning")
    # The outer ring turns about the line of sight: search for it beside the middle.
    x, y = page.evaluate(AT)
    for radius in range(20, 130, 4):
        page.mouse.move(x + radius, y)
        if page.evaluate("() => window.denavit.app.view.grip.axis"):
            break
    page.mouse.down()
    page.mouse.move(x + radius, y + 15)
    at_rest(page)
    page.mouse.move(x + radius, y + 30)
    at_rest(page)
    page.mouse.up()
    at_rest(page)
    turned = page.evaluate(STATE)
    assert np.abs(np.subtract(turned["tip"], before["tip"])[12:15]).max() < 1e-8
    assert np.abs(np.subtract(turned["tip"], before["tip"])[:11]).max() > 0.05
    shot(page, "turned")
    # Typed in millimetres and degrees, in the form that `denavit ik` reads.
    for name, value in (("x", "300"), ("y", "-250,5"), ("z", "420"), ("roll", "180"), ("pitch", "0"), ("yaw", "30")):
        field = page.locator(f'[data-pose="{name}"]')
        field.fill(value)
        field.press("Tab")
        at_rest(page)
    tip = np.array(page.evaluate(STATE)["tip"]).reshape(4, 4).T
    assert tip[:3, 3] == pytest.approx([0.3, -0.2505, 0.42], abs=1e-8)
    c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
    assert tip[:3, :3] == pytest.approx(np.array([[c, s, 0], [s, -c, 0], [0, 0, -1]]), abs=1e-8)


def test_what_no_posture_reaches_is_said(explorer):
    page = explorer()
    begin(page)
    before = page.evaluate(STATE)
    field = page.locator('[data-pose="x"]')
    field.fill("1500")
    field.press("Enter")
    at_rest(page)
    expect(page.locator("#reached")).to_contain_text("Out of reach: no posture was found for this pose; the nearest is ")
    assert page.evaluate(STATE) == before | {"ghosts": 0}
    shot(page, "out-of-reach")
    field.fill("abc")
    field.press("Enter")
    expect(page.locator("#reached")).to_have_text("x takes a number")
    # The handle follows a joint that is moved by hand.
    pose(page, {"elbow_joint": 1.0})
    at_rest(page)
    expect(page.locator("#reach")).to_have_attribute("data-state", "reached")
    # At the end of the branch the nearest other one is used, and the page says so.
    start, joint, rest = UR5E.read_text().partition('<joint name="elbow_joint"')
    bent = start + joint + rest.replace('lower="-6.283185307179586" upper="6.283185307179586"', 'lower="0.9" upper="1.4"', 1)
    page.click("#drag")
    drop_robot(page, ("bent.urdf", bent.encode()))
    page.wait_for_function("() => window.denavit.app.robot?.file === 'bent.urdf'")
    page.click("#drag")
    at_rest(page)
    field.fill("150")
    field.press("Enter")
    at_rest(page)
    expect(page.locator("#reached")).to_contain_text("Another branch now: back, elbow up, wrist not flipped. 1 other posture reaches this pose")
    # No posture within limits reaches it: the page names the joints that would have to exceed theirs.
    wide = 'lower="-6.283185307179586" upper="6.283185307179586"'
    pan, lift, elbow, rest = UR5E.read_text().split(wide, 3)
    tight = f'{pan}lower="0" upper="1.2"{lift}{wide}{elbow}lower="0.9" upper="1.4"{rest}'
    page.click("#drag")
    pose(page, POSTURE)
    drop_robot(page, ("tight.urdf", tight.encode()))
    page.wait_for_function("() => window.denavit.app.robot?.file === 'tight.urdf'")
    page.click("#drag")
    at_rest(page)
    field.fill("150")
    field.press("Enter")
    at_rest(page)
    expect(page.locator("#reached")).to_contain_text("Only outside of limits: a posture reaches this pose, but not within the limits of shoulder_pan_joint, elbow_joint.")


@pytest.mark.parametrize("robot", ["kuka/iiwa14.urdf", "franka/panda.urdf", "abb/irb120.urdf"])
def test_other_arms_follow_too(robot, explorer):
    page = explorer()
    drop_robot(page, ROBOTS / robot)
    names = page.evaluate("() => window.denavit.chain(window.denavit.app.robot).coordinates")
    limits = page.evaluate("() => Object.fromEntries(window.denavit.app.robot.opened.scene.joints.map((joint) => [joint.name, [joint.lower ?? -2, joint.upper ?? 2]]))")
    pose(page, {name: np.mean(limits[name]) + 0.1 * (limits[name][1] - limits[name][0]) * (1 if at % 2 else -1) for at, name in enumerate(names)})
    page.click("#drag")
    expect(page.locator("#reach")).to_have_attribute("data-state", "reached")
    at_rest(page)
    before = page.evaluate(STATE)
    drag(page, (6, 4), (12, 8))
    page.mouse.up()
    at_rest(page)
    after = page.evaluate(STATE)
    wanted = json.loads(page.get_attribute("#reach", "data-wanted"))
    assert np.abs(np.subtract(after["tip"], wanted)).max() < 1e-8
    assert np.linalg.norm(np.subtract(after["tip"], before["tip"])[12:15]) > 1e-3
    print(robot, "milliseconds of the last answer:", page.get_attribute("#reach", "data-took"), "solutions", after["ghosts"] + 1)


def test_an_arm_of_four_joints_goes_where_it_can(explorer):
    page = explorer()
    begin(page, ROBOTS / "adept/cobra600.urdf", {})
    names = page.evaluate("() => window.denavit.chain(window.denavit.app.robot).coordinates")
    assert len(names) == 4
    pose(page, {names[0]: 0.4, names[1]: 0.7})
    at_rest(page)
    before = page.evaluate(STATE)
    drag(page, (8, 3), (16, 6))
    page.mouse.up()
    at_rest(page)
    after = page.evaluate(STATE)
    assert np.linalg.norm(np.subtract(after["tip"], before["tip"])[12:15]) > 1e-3
    shot(page, "scara")
