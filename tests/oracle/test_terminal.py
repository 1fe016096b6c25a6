"""The terminal pictures in docs/quick-start.md show the program's current output, in at most 80 columns."""

import os
import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

from built import denavit

WORKSPACE = Path(__file__).resolve().parents[2]
SCRIPT = WORKSPACE / "docs/site/terminal.py"


def rows(picture):
    texts = ElementTree.parse(picture).getroot().iter("{http://www.w3.org/2000/svg}text")
    return ["".join(text.itertext()) for text in texts]


def test_pictures_show_what_a_terminal_shows(tmp_path):
    subprocess.run([sys.executable, SCRIPT, tmp_path], env=os.environ | {"DENAVIT": str(denavit())}, check=True)
    drawn = {picture.name: rows(picture) for picture in tmp_path.glob("*.svg")}
    kept = {picture.name: rows(picture) for picture in (WORKSPACE / "docs/quick-start").glob("*.svg")}
    assert drawn.keys() == kept.keys() and len(kept) >= 3
    for name, shown in drawn.items():
        assert all(len(row) <= 80 for row in shown), name
        # The last digits of a fit depend on the processor.
        without_digits = [[re.sub(r"[0-9]", "9", row) for row in picture] for picture in (kept[name], shown)]
        assert without_digits[0] == without_digits[1], f"{name}: draw them anew: DENAVIT=... docs/site/terminal.py"
