"""The URDF files that the oracle covers: those in the pinned wheels, in robots/ and in ../shared/vendor if it exists.

`python corpus.py` prints the list with the source of each.
"""

import hashlib
import sysconfig
from pathlib import Path

WORKSPACE = Path(__file__).resolve().parents[2]
SITE_PACKAGES = Path(sysconfig.get_paths()["purelib"])
SHARED = WORKSPACE.parent / "shared"

SOURCES = {
    "robots": WORKSPACE / "robots",
    "example-robot-data": SITE_PACKAGES / "cmeel.prefix/share/example-robot-data/robots",
    "rtb-data": SITE_PACKAGES / "rtbdata",
    "compas_fab": SITE_PACKAGES / "compas_fab/data",
    "scikit-robot": SITE_PACKAGES / "skrobot/data",
    "vendor/robots": SHARED / "vendor/robots",
    "vendor/xacro": SHARED / "vendor/xacro",
}


def files():
    """[(source, path)], sorted, each content once."""
    seen, found = set(), []
    for source, folder in SOURCES.items():
        for path in sorted(folder.rglob("*.[uU][rR][dD][fF]")):
            content = hashlib.sha256(path.read_bytes()).digest()
            if content not in seen:
                seen.add(content)
                found.append((source, path))
    return found


if __name__ == "__main__":
    for source, path in files():
        print(f"{source:20} {path}")
