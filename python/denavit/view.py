"""The explorer in a notebook: the page of ``denavit explore`` with robots in it."""

from __future__ import annotations

import base64
import html
import json
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePath
from typing import TYPE_CHECKING, Any

from denavit._files import save
from denavit.chain import Chain
from denavit.compare import Diff
from denavit.errors import ExportError
from denavit.fit import Fit
from denavit.robot import Robot, load

if TYPE_CHECKING:
    from denavit.robot import Source

PAGE = Path(__file__).with_name("explorer.html")
"""The page that web/build makes; a build of the package without it has no page."""

ROBOTS = '<script type="application/json" id="robots">[]</script>'
"""Where the page has its robots."""


@dataclass(frozen=True, slots=True, repr=False)
class View:
    """Robots on the explorer's page; made by `explore`. Shows itself in a notebook, and does not use the network.

    The page is part of the output: a cell with a view adds three megabytes to its notebook, and works wherever the
    notebook is opened, even without a kernel.

    Attributes:
        robots: File and text of each; two are drawn over each other.
        height: Of the frame in a notebook, in pixels.
        meshes: For each robot the mesh files that it names, as it names them.
    """

    robots: tuple[tuple[str, str], ...]
    height: int = 640
    meshes: tuple[tuple[tuple[str, bytes], ...], ...] = ()

    @property
    def page(self) -> str:
        """The page, HTML.

        Raises:
            ExportError: This build of the package has no page.
        """
        if not PAGE.is_file():
            raise ExportError(
                "the explorer's page is not installed; run web/build in the clone, then pip install ./python",
                file=str(PAGE),
            )
        meshes = [{uri: base64.b64encode(content).decode() for uri, content in files} for files in self.meshes]
        robots = [(file, text, meshes[at] if meshes else {}) for at, (file, text) in enumerate(self.robots)]
        told = json.dumps([{"file": file, "text": text, "meshes": files} for file, text, files in robots], ensure_ascii=False)
        # No text of a robot can end the element that holds it.
        filled = ROBOTS.replace("[]", told.replace("<", "\\u003c"))
        return PAGE.read_text(encoding="utf-8").replace(ROBOTS, filled, 1)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the page, as a whole or not at all; ``denavit explore ROBOT… -o FILE``."""
        save(path, self.page)

    def _repr_html_(self) -> str:
        # A frame of its own, with an origin of its own: page and notebook cannot reach each other.
        page = html.escape(self.page, quote=True)
        style = f"width:100%;height:{int(self.height)}px;border:1px solid #8888"
        title = html.escape(" and ".join(file for file, _ in self.robots))
        return f'<iframe title="{title}" style="{style}" sandbox="allow-scripts allow-downloads" srcdoc="{page}"></iframe>'

    def __repr__(self) -> str:
        return f"<denavit.View of {' and '.join(file for file, _ in self.robots)}>"


def explore(
    *robots: Source | Chain | Diff | Fit,
    height: int = 640,
    meshes: int = 16 << 20,
    package_path: Sequence[str | os.PathLike[str]] = (),
) -> View:
    """Show robots on the explorer's page; ``denavit explore``.

    Args:
        robots: Anything that `load` takes; a chain; a diff, whose two robots are drawn over each other; a fit, which is the
            robot as drawn and the calibrated one.
        height: Of the frame in a notebook, in pixels.
        meshes: Bytes of mesh files (stl, dae, obj) that are put into the page, at most, all robots together; 0: none.
        package_path: Folders with ROS packages, or packages, to find meshes in.

    Examples:
        >>> import denavit as dn
        >>> dn.explore("robots/universal_robots/ur5e.urdf")
        <denavit.View of ur5e.urdf>
    """
    shown = [robot for given in robots for robot in _robots(given)]
    folders = [os.fspath(folder) for folder in package_path]
    found: list[tuple[tuple[str, bytes], ...]] = []
    for robot in shown:
        files = tuple(robot._native.meshes(folders, meshes))
        meshes -= sum(len(content) for _, content in files)
        found.append(files)
    return View(tuple(_document(robot) for robot in shown), height, tuple(found) if any(found) else ())


def _robots(given: Any) -> tuple[Robot, ...]:
    if isinstance(given, Diff):
        return given.robots
    if isinstance(given, Fit):
        return given.nominal.robot, given.chain.robot
    if isinstance(given, Chain):
        return (given.robot,)
    return (load(given),)


def _document(robot: Robot) -> tuple[str, str]:
    """File and text of a robot as the page takes it: URDF with xacro expanded, or a table unchanged."""
    return PurePath(robot.file).name, robot._self_contained
