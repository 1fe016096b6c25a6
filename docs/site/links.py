"""Follows every link of the built site: links.py FOLDER. Fails where one leads to no page, or to no place of its page."""

from __future__ import annotations

import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit


class Page(HTMLParser):
    """What a page links to, and the places in it that links may name."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.places: set[str] = {""}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Take what is a link or a place."""
        for name, value in attrs:
            if name in ("href", "src") and value is not None:
                self.links.append(value)
            if name == "id" or (name == "name" and tag == "a"):
                self.places.add(value or "")


def broken(folder: Path) -> list[str]:
    """Every link that leads nowhere, with its page."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in folder.rglob("*.html")}
    found = []
    for path, page in pages.items():
        for link in page.links:
            parts = urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            # The page of errors is served from anywhere: its links begin at the top.
            start = folder if parts.path.startswith("/") else path.parent
            target = (start / unquote(parts.path).lstrip("/")).resolve() if parts.path else path
            if target.is_dir():
                target /= "index.html"
            known = pages.get(target)
            lost = known is not None and unquote(parts.fragment) not in known.places and not parts.fragment.startswith("__")
            if not target.exists() or lost:
                found.append(f"{path.relative_to(folder)}: {link}")
    return sorted(set(found))


def main() -> None:
    """Check a folder."""
    folder = Path(sys.argv[1]).resolve()
    wrong = broken(folder)
    if wrong:
        sys.exit("links that lead nowhere:\n" + "\n".join(wrong))
    print(f"site: {sys.argv[1]}, {sum(1 for _ in folder.rglob('*.html'))} pages")


if __name__ == "__main__":
    main()
