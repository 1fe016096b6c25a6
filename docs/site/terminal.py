"""Pictures of the terminal for docs/quick-start.md, 80 columns wide: terminal.py [FOLDER].

Runs each command in a folder of its own, as the page has it, and writes what a terminal shows as SVG. DENAVIT names the program.
"""

from __future__ import annotations

import fcntl
import os
import pty
import re
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import termios
from pathlib import Path
from xml.sax.saxutils import escape

TOP = Path(__file__).resolve().parents[2]
COLUMNS = 80
UR5E = "robots/universal_robots/ur5e.urdf"
# A picture's command, those that come before it, and how many lines are shown.
PICTURES = {
    "table": (f"denavit table {UR5E}", [], 40),
    "diff": (f"denavit diff {UR5E} edited.urdf", ["edit"], 40),
    "calibrate": (
        f"denavit calibrate {UR5E} --data run.csv --hold-out 0.3",
        [f"denavit plan {UR5E} --count 40 -o poses.csv", f"denavit simulate {UR5E} --poses poses.csv -o run.csv"],
        24,
    ),
}
WIDTH, HEIGHT = 7.8, 18
COLOURS = {"1": "bold", "2": "dim", "31": "red", "32": "green", "33": "yellow", "36": "cyan"}
STYLE = """text{font:13px "DejaVu Sans Mono",Menlo,Consolas,monospace;fill:#d8dee9;white-space:pre}
.bold{font-weight:bold}.dim{fill:#8b95a5}.red{fill:#f28b82}.green{fill:#a3be8c}.yellow{fill:#ebcb8b}.cyan{fill:#88c0d0}"""


def shown(command: str, folder: Path) -> list[str]:
    """The lines that a terminal shows of a command, with their colours; progress that was wiped away is not among them."""
    program = os.environ.get("DENAVIT", shutil.which("denavit") or "denavit")
    ours, theirs = pty.openpty()
    fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 40, COLUMNS, 0, 0))
    words = [str(Path(program).resolve()), *shlex.split(command)[1:]]
    environment = os.environ | {"TERM": "xterm-256color"}
    running = subprocess.Popen(words, stdin=theirs, stdout=theirs, stderr=theirs, cwd=folder, env=environment)
    os.close(theirs)
    out = b""
    while True:
        try:
            part = os.read(ours, 65536)
        except OSError:
            break
        if not part:
            break
        out += part
    os.close(ours)
    if running.wait() > 1:
        sys.exit(f"{command}: exit code {running.returncode}\n{out.decode()}")
    text = re.sub(r"[^\n]*\x1b\[2K", "", out.decode().replace("\r\n", "\n"))
    return text.rstrip("\n").split("\n")


def rows_of(line: str) -> list[str]:
    """A line as a terminal breaks it: after 80 columns, wherever that is."""
    rows, width = [""], 0
    for part in re.findall(r"\x1b\[[0-9;]*m|.", line):
        if len(part) == 1:
            if width == COLUMNS:
                rows.append("")
                width = 0
            width += 1
        rows[-1] += part
    return rows


def line_of_svg(line: str, y: float) -> str:
    """A line with its colours as an element of text."""
    parts, classes = [], ""
    for part in re.split(r"(\x1b\[[0-9;]*m)", line):
        code = re.fullmatch(r"\x1b\[([0-9;]*)m", part)
        if code:
            classes = " ".join(COLOURS[c] for c in code[1].split(";") if c in COLOURS)
        elif part:
            parts.append(f'<tspan class="{classes}">{escape(part)}</tspan>' if classes else escape(part))
    return f'<text x="12" y="{y}">{"".join(parts)}</text>'


def picture(lines: list[str], label: str) -> str:
    """Lines in a terminal's window."""
    width, height = round(24 + COLUMNS * WIDTH), 20 + HEIGHT * len(lines)
    rows = "\n".join(line_of_svg(line, 22 + HEIGHT * k) for k, line in enumerate(lines))
    size = f'viewBox="0 0 {width} {height}" width="{width}"'
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} role="img" aria-label="{escape(label)}">\n'
        f"<style>{STYLE}</style>\n"
        f'<rect width="{width}" height="{height}" rx="6" fill="#242933"/>\n{rows}\n</svg>\n'
    )


def drawn(name: str) -> str:
    """One of the pictures."""
    command, before, most = PICTURES[name]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "robots").symlink_to(TOP / "robots")
        for first in before:
            if first == "edit":
                text = (TOP / UR5E).read_text(encoding="utf-8")
                assert text.count("-0.425 0 0") == 1
                (folder / "edited.urdf").write_text(text.replace("-0.425 0 0", "-0.4254 0 0"), encoding="utf-8")
            else:
                shown(first, folder)
        out = shown(command, folder)
    lines = [f"\x1b[36m$\x1b[0m {command}", *out[:most], *["\x1b[2m…\x1b[0m"][: len(out) > most]]
    return picture([row for line in lines for row in rows_of(line)], f"What a terminal shows of {command}")


def main() -> None:
    """Draw all of them."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else TOP / "docs/quick-start"
    folder.mkdir(parents=True, exist_ok=True)
    for name in PICTURES:
        (folder / f"{name}.svg").write_text(drawn(name), encoding="utf-8")


if __name__ == "__main__":
    main()
