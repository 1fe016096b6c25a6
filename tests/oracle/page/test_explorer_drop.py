"""Files and folders dragged onto the explorer: real drags in the browser, onto the page opened from disk, from a server
and in a notebook's frame; and which dropped file is used for a robot's mesh."""

import functools
import html
import http.server
import threading

import pytest
from explorer_page import DESKTOP, PAGE, UR5E, has_table, needs_page, zipped
from playwright.sync_api import expect
from test_explorer_view import robot_of, stl_binary

pytestmark = needs_page


def drag(page, *paths, at=(400, 400)):
    """Drags files from outside the browser onto the page and drops them."""
    devtools = page.context.new_cdp_session(page)
    data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
    for kind in ("dragEnter", "dragOver", "drop"):
        devtools.send("Input.dispatchDragEvent", {"type": kind, "x": at[0], "y": at[1], "data": data})
    devtools.detach()


def write(folder, files):
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content if isinstance(content, bytes) else content.encode())
    return folder


def package(name):
    return f"<package format='3'><name>{name}</name></package>"


@pytest.fixture
def served():
    handler = functools.partial(http.server.SimpleHTTPRequestHandler, directory=PAGE.parent)
    handler.log_message = lambda *_: None
    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/explorer.html"
    server.shutdown()


@pytest.fixture(params=["disk", "server", "notebook"])
def opened(request, explorer, served, tmp_path):
    """The page, and the frame with the explorer in it."""
    if request.param == "disk":
        page = explorer()
        return page, page.main_frame
    if request.param == "server":
        page = explorer(served)
        return page, page.main_frame
    # Like denavit.View in a cell.
    inner = html.escape(PAGE.read_text(encoding="utf-8"), quote=True)
    notebook = tmp_path / "notebook.html"
    frame = f'<iframe style="width:100%;height:800px" sandbox="allow-scripts allow-downloads" srcdoc="{inner}"></iframe>'
    notebook.write_text(f"<!doctype html><meta charset=\"utf-8\"><title>notebook</title>{frame}", encoding="utf-8")
    page = explorer(notebook.as_uri())
    expect(page.frame_locator("iframe").locator("#example")).to_be_visible()
    return page, page.frames[1]


ARM = {
    "ws/arm_checkout/package.xml": package("arm_description"),
    "ws/arm_checkout/urdf/arm.urdf": robot_of(["package://arm_description/meshes/visual/base.stl", "package://arm_description/meshes/collision/base.stl"]),
    "ws/arm_checkout/meshes/visual/base.stl": stl_binary(),
    "ws/arm_checkout/meshes/collision/base.stl": b"\1" + stl_binary()[1:],
    "ws/arm_checkout/.git/HEAD": "ref: refs/heads/main",
}


def test_a_dragged_file_opens_and_a_dragged_folder_with_its_meshes(opened, tmp_path):
    page, frame = opened
    drag(page, UR5E)
    expect(frame.locator("#dh tbody tr")).to_have_count(8)
    expect(frame.locator(".said.wrong")).to_have_count(0)
    drag(page, write(tmp_path, ARM) / "ws")
    has_table(frame, "ws/arm_checkout/urdf/arm.urdf")
    assert frame.evaluate("() => window.denavit.app.view.missing") == []
    # No message calls a drawn mesh missing, although the folder and its package have different names.
    expect(frame.locator("#download-urdf, #clean")).to_have_count(1)
    said = frame.locator(".finding summary").all_inner_texts()
    assert not any("not found" in words or "base.stl" in words for words in said), said


def test_files_and_folders_and_archives_are_dragged_together(explorer, tmp_path):
    page = explorer()
    write(tmp_path, {**ARM, "more.zip": zipped({"other/readme.md": "nothing of a robot's"})})
    drag(page, tmp_path / "ws", tmp_path / "more.zip")
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    assert page.evaluate("() => window.denavit.app.view.missing") == []


def test_two_dragged_files_are_compared(explorer, tmp_path):
    page = explorer()
    other = tmp_path / "longer.urdf"
    other.write_text(UR5E.read_text().replace("0.425", "0.435"))
    drag(page, UR5E, other)
    expect(page.locator("#verdict")).to_have_text("Different robots")


# Files beside a robot, its mesh, and whether no file is that mesh.
MESHES = {
    # From the package of that name, and not from the first one.
    "by name": ({"a/package.xml": package("other"), "a/meshes/base.stl": b"x", "b/package.xml": package("arm"), "b/meshes/base.stl": stl_binary()}, "package://arm/meshes/base.stl", False),
    # The dropped package has no such file: another robot's mesh is not shown instead.
    "not there": ({"a/package.xml": package("other"), "a/meshes/base.stl": stl_binary(), "b/package.xml": package("arm")}, "package://arm/meshes/base.stl", True),
    "of another": ({"a/package.xml": package("other"), "a/meshes/base.stl": stl_binary()}, "package://arm/meshes/base.stl", True),
    # No package.xml at all: the longest common end of the path.
    "longest end": ({"x/low/base.stl": b"broken", "x/high/base.stl": stl_binary()}, "package://arm/meshes/high/base.stl", False),
    "bare": ({"base.stl": stl_binary()}, "package://arm/meshes/base.stl", False),
    "file": ({"meshes/base.stl": stl_binary()}, "file:///home/somebody/ws/arm/meshes/base.stl", False),
    # Two equally good candidates: neither is chosen.
    "two alike": ({"x/base.stl": stl_binary(), "y/base.stl": b"\1" + stl_binary()[1:]}, "package://arm/meshes/base.stl", True),
}  # fmt: skip


def test_a_mesh_is_the_file_that_its_name_means(explorer, tmp_path):
    page = explorer()
    for case, (files, mesh, missing) in MESHES.items():
        robot = f"{case.replace(' ', '_')}.urdf"
        drag(page, write(tmp_path / case, {f"top/{name}": content for name, content in {**files, robot: robot_of([mesh])}.items()}) / "top")
        has_table(page, f"top/{robot}")
        assert page.evaluate("() => window.denavit.app.view.missing") == [mesh] * missing, case


MODELS = {
    "arm.xml": """<mujoco model="arm"><worldbody><body name="base"><geom size=".1"/><body name="tip" pos="0 0 .5">
        <joint name="j" axis="0 1 0" range="-90 90"/><geom size=".1"/></body></body></worldbody></mujoco>""",
    "arm.sdf": """<sdf version="1.9"><model name="arm"><link name="base"/><link name="tip"/><joint name="j" type="revolute">
        <pose relative_to="base">0 0 .5 0 0 0</pose><parent>base</parent><child>tip</child><axis><xyz>0 1 0</xyz></axis></joint></model></sdf>""",
}


def test_models_in_other_formats_are_dragged(explorer, tmp_path):
    page = explorer()
    for name, model in MODELS.items():
        drag(page, write(tmp_path, {name: model}) / name)
        has_table(page, name)
        expect(page.locator(".said.wrong")).to_have_count(0)


INCLUDING = {
    "mjcf": {
        "top/arm.xml": MODELS["arm.xml"].replace("<worldbody>", '<include file="parts/joints.xml"/><worldbody>').replace('axis="0 1 0" range="-90 90"', 'class="turn"'),
        "top/parts/joints.xml": '<mujocoinclude><default><default class="turn"><joint axis="0 1 0" range="-90 90"/></default></default></mujocoinclude>',
    },
    "mjcf of two models": {
        "top/arm.xml": MODELS["arm.xml"].replace("<worldbody>", '<include file="joints.xml"/><worldbody>').replace('axis="0 1 0" range="-90 90"', 'class="turn"'),
        "top/joints.xml": '<mujoco><default><default class="turn"><joint axis="0 1 0" range="-90 90"/></default></default></mujoco>',
    },
    "sdf": {
        "top/cell/model.sdf": '<sdf version="1.9"><model name="cell"><include><uri>model://arm</uri></include></model></sdf>',
        "top/arm/arm.sdf": MODELS["arm.sdf"],
        "top/arm/model.config": '<model><name>arm</name><sdf version="1.9">arm.sdf</sdf></model>',
    },
}  # fmt: skip


@pytest.mark.parametrize("model", INCLUDING)
def test_models_that_include_others_are_dragged_with_them(model, explorer, tmp_path):
    page = explorer()
    drag(page, write(tmp_path, INCLUDING[model]) / "top")
    expect(page.locator("#dh tbody tr").first).to_be_visible()
    # Later requests do not include the files beside.
    for tab in page.get_by_role("tab").all():
        tab.click()
        expect(page.locator(".said.wrong")).to_have_count(0)
    page.get_by_role("tab").first.click()
    expect(page.locator("#dh tbody tr").first).to_be_visible()


@pytest.mark.parametrize("size", [DESKTOP], ids=["desktop"])
def test_something_else_that_is_dragged_gets_one_sentence(size, explorer, tmp_path):
    page = explorer(size=size)
    (tmp_path / "photo.jpg").write_bytes(b"\xff\xd8\xff")
    drag(page, tmp_path / "photo.jpg")
    expect(page.locator(".said.wrong")).to_contain_text('no robot among "photo.jpg"')
