"""Finds the build in any developer's environment: no other test looks below `target`.

`tests/run` sets DENAVIT_TARGET (the folder) and DENAVIT (the program); if they are not set, cargo says where the folder is.
"""

import functools
import json
import os
import subprocess
from pathlib import Path

WORKSPACE = Path(__file__).resolve().parents[2]


@functools.cache
def target():
    """Cargo's target folder."""
    if given := os.environ.get("DENAVIT_TARGET"):
        return Path(given)
    command = ["cargo", "metadata", "--no-deps", "--format-version", "1", "--offline"]
    told = subprocess.run(command, cwd=WORKSPACE, capture_output=True, text=True, check=True).stdout
    return Path(json.loads(told)["target_directory"])


def denavit():
    """The program: the one in DENAVIT, else the newest existing build."""
    if given := os.environ.get("DENAVIT"):
        programs = [Path(given)]
    else:
        programs = [target() / profile / "denavit" for profile in ("debug", "release")]
    built = [program for program in programs if program.is_file()]
    if not built:
        raise FileNotFoundError(f"there is no {programs[0]}; cargo build -p denavit makes it, or name one in DENAVIT")
    return max(built, key=lambda program: program.stat().st_mtime)
