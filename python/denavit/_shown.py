"""What a notebook shows of robots, chains, diffs and fits."""

from __future__ import annotations

import html


class Shown:
    """Shows its text in a notebook, and the explorer below it where ``denavit.show_explorer`` is set."""

    __slots__ = ()

    def _repr_html_(self) -> str | None:
        # Imported when something is shown: the view knows the classes that show themselves by it.
        import denavit
        from denavit.view import explore

        if not denavit.show_explorer:
            return None
        return f"<pre>{html.escape(repr(self))}</pre>{explore(self)._repr_html_()}"
