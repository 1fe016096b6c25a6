"""The explorer in a notebook: the page of ``denavit explore`` with robots in it."""

from __future__ import annotations

import html
import json
import os
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
"""The page as web/build makes it; a build of the package without that has none."""

ROBOTS = '<script type="application/json" id="robots">[]</script>'
"""Where the page has its robots."""


@dataclass(frozen=True, slots=True, repr=False)
class View:
    """Robots on the explorer's page; made by `explore`. Shows itself in a notebook, and asks the network for nothing.

    The page is part of what is shown: a cell with a view adds three megabytes to its notebook, and works wherever the
    notebook is opened, without a kernel too.

    Attributes:
        robots: File and text of each; two are drawn over each other.
        height: Of the frame in a notebook, in pixels.
    """

    robots: tuple[tuple[str, str], ...]
    height: int = 640

    @property
    def page(self) -> str:
        """The page, HTML.

        Raises:
            ExportError: This build of the package has no page.
        """
        if not PAGE.is_file():
            raise ExportError(
                "this build of the package has no page of the explorer; run web/build, copy web/dist/explorer.html to "
                "python/denavit and install the package again",
                file=str(PAGE),
            )
        told = json.dumps([{"file": file, "text": text} for file, text in self.robots], ensure_ascii=False)
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


def explore(*robots: Source | Chain | Diff | Fit, height: int = 640) -> View:
    """Show robots on the explorer's page; ``denavit explore``.

    Args:
        robots: Anything that `load` takes; a chain; a diff, whose two robots are drawn over each other; a fit, which is the
            robot as drawn and the calibrated one.
        height: Of the frame in a notebook, in pixels.

    Examples:
        >>> import denavit as dn
        >>> dn.explore("robots/universal_robots/ur5e.urdf")
        <denavit.View of ur5e.urdf>
    """
    return View(tuple(_told(robot) for given in robots for robot in _robots(given)), height)


def _robots(given: Any) -> tuple[Robot, ...]:
    if isinstance(given, Diff):
        return given.robots
    if isinstance(given, Fit):
        return given.nominal.robot, given.chain.robot
    if isinstance(given, Chain):
        return (given.robot,)
    return (load(given),)


def _told(robot: Robot) -> tuple[str, str]:
    """File and text of a robot as the page takes it: URDF with xacro expanded, or a table as it stands."""
    return PurePath(robot.file).name, robot.text
