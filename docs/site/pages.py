"""Gathers the pages of the documentation site: pages.py FOLDER.

Links that lead out of the site become text, where what they lead to is a file of the repository; others are left for mkdocs to
complain about.
"""

from __future__ import annotations

import ast
import os
import re
import shutil
import sys
from pathlib import Path

from nbconvert import MarkdownExporter

TOP = Path(__file__).resolve().parents[2]
# A link, or code, in which there is none; code may be the words of a link.
TOKEN = re.compile(r"```.*?```|\[([^\]]*)\]\(([^)\s]+)\)|`[^`\n]*`", re.DOTALL)
PICTURES = {".png", ".svg"}
MOVED = {"README.md": "index.md", "ARCHITECTURE.md": "architecture.md", "robots/README.md": "gallery.md"}


def place(file: Path) -> str | None:
    """Where a file of the repository is in the site."""
    name = file.relative_to(TOP).as_posix() if file.is_relative_to(TOP) else ""
    if name in MOVED:
        return MOVED[name]
    if file.parent == TOP / "docs" and file.suffix == ".md":
        return file.name
    if file.parent == TOP / "examples/notebooks" and file.suffix == ".ipynb":
        return f"notebooks/{file.stem}.md"
    if file.suffix in PICTURES and file.is_relative_to(TOP / "docs"):
        return file.relative_to(TOP / "docs").as_posix()
    return None


def linked(text: str, source: Path, page: str) -> str:
    """The text of a page with its links as they are in the site."""

    def link(found: re.Match[str]) -> str:
        words, target = found[1], found[2]
        if target is None:
            return found[0]
        path, mark, anchor = target.partition("#")
        if "://" in target or not path:
            return found[0]
        file = (source.parent / path).resolve()
        if file == TOP / "examples/notebooks":
            file = file / "1_read_a_robot.ipynb"
        inside = place(file)
        if inside is not None:
            return f"[{words}]({os.path.relpath(inside, Path(page).parent)}{mark}{anchor})"
        return words if file.exists() else found[0]

    return TOKEN.sub(link, text)


def reference() -> str:
    """A page that names every public object of the package; mkdocstrings fills in what they say."""
    tree = ast.parse((TOP / "python/denavit/__init__.py").read_text(encoding="utf-8"))
    homes = {
        name.name: node.module
        for node in tree.body
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("denavit.")
        for name in node.names
    }
    functions = [name for name in homes if name[0].islower()]
    errors = [name for name, home in homes.items() if home == "denavit.errors"]
    main = ["Robot", "Chain", "Table", "Diff", "Measurements", "Fit", "View"]
    others = [name for name in homes if name not in {*functions, *errors, *main}]
    parts = [("Functions", functions), ("Main classes", main), ("Results", others), ("Errors", errors)]
    lines = ["# Reference", "", "Lengths are m, angles rad. `import denavit as dn`."]
    for title, names in parts:
        lines += ["", f"## {title}"]
        for name in names:
            lines += ["", f"::: {homes[name]}.{name}"]
    return "\n".join(lines) + "\n"


def main() -> None:
    """Write every page."""
    folder = Path(sys.argv[1])
    sources = [*(TOP / "docs").glob("*.md"), *(TOP / name for name in MOVED)]
    for source in sources:
        page = place(source)
        assert page is not None
        text = linked(source.read_text(encoding="utf-8"), source, page)
        if page == "gallery.md":
            what = "A page for each, with figures, tables, workspace and a view that moves"
            text += f'\n## Pages\n\n{what}: <a href="robots/index.html">all of them</a>.\n'
        path = folder / page
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    shutil.copy(TOP / "docs/site/site.css", folder)
    for picture in (file for file in (TOP / "docs").glob("*/*") if file.suffix in PICTURES):
        path = folder / picture.relative_to(TOP / "docs")
        path.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(picture, path)
    for notebook in sorted((TOP / "examples/notebooks").glob("*.ipynb")):
        page = f"notebooks/{notebook.stem}.md"
        text, resources = MarkdownExporter().from_filename(str(notebook))
        (folder / "notebooks").mkdir(exist_ok=True)
        for name, content in resources["outputs"].items():
            own = f"{notebook.stem}_{name}"
            text = text.replace(f"({name})", f"({own})")
            (folder / "notebooks" / own).write_bytes(content)
        (folder / page).write_text(linked(text, notebook, page), encoding="utf-8")
    (folder / "reference.md").write_text(reference(), encoding="utf-8")


if __name__ == "__main__":
    main()
