"""How long the tasks of docs/quick-start.md take a newcomer: minutes.py [FOLDER].

Clones this repository into FOLDER (an empty one; a temporary folder by default), runs every command of the first three tasks
there, in an empty target folder, and prints when each was done. Crates should be downloaded before: `cargo fetch`.
The program must not be on the path before; the machine should have nothing else to do.
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

TOP = Path(__file__).resolve().parents[2]
TASKS = ["A D-H document from a vendor's URDF", "CI for a description repository", "Calibrate an arm"]


def commands(text, task):
    """The task's commands: its indented lines, and those that its prose tells to run first."""
    section = re.search(rf"^## {re.escape(task)}$(.*?)(?=^## |\Z)", text, re.M | re.S).group(1)
    return re.findall(r"^    (\S.*)$|`(cargo install [^`]*)`", section, re.M)


def main():
    """Run the tasks and print a line for each command."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(sys.argv[1] if len(sys.argv) > 1 else temporary).resolve()
        clone, programs = folder / "denavit", folder / "programs"
        subprocess.run(["git", "clone", "--quiet", TOP, clone], check=True)
        environment = os.environ | {
            "CARGO_TARGET_DIR": str(folder / "target"),
            "CARGO_INSTALL_ROOT": str(programs),
            "PATH": f"{programs / 'bin'}{os.pathsep}{os.environ['PATH']}",
        }
        text = (clone / "docs/quick-start.md").read_text(encoding="utf-8")
        begin = time.monotonic()
        print("| done at | seconds | command |\n|---|---|---|")
        for task in TASKS:
            print(f"| | | **{task}** |")
            for command in map("".join, commands(text, task)):
                start = time.monotonic()
                done = subprocess.run(
                    command, shell=True, cwd=clone, env=environment, capture_output=True, text=True, check=False
                )
                # `check` and `diff` say with 1 that there is something to read.
                if done.returncode not in (0, 1):
                    sys.exit(f"{command}: exit code {done.returncode}\n{done.stderr}")
                now = time.monotonic()
                print(f"| {int(now - begin) // 60}:{int(now - begin) % 60:02} | {now - start:.1f} | `{command}` |", flush=True)


if __name__ == "__main__":
    main()
