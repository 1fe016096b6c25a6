"""The two programs that expand xacro: `denavit expand` (or the example of the crate) and the Python tool."""

import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
# Scripts in this folder can also run alone.
sys.path.insert(0, str(HERE.parent))

import built  # noqa: E402

WORKSPACE = built.WORKSPACE

# Missing packages are reported; the packages of the machine are not searched.
ENVIRONMENT = {key: value for key, value in os.environ.items() if key not in ("AMENT_PREFIX_PATH", "ROS_PACKAGE_PATH")}


def ours():
    """The command, or None if nothing is built: DENAVIT, then the release build, then the crate's example."""
    candidates = [[os.environ["DENAVIT"], "expand"]] if "DENAVIT" in os.environ else []
    for build in ("release", "debug"):
        folder = built.target() / build
        candidates += [[str(folder / "denavit"), "expand"], [str(folder / "examples/expand")]]
    for command in candidates:
        if Path(command[0]).is_file() and (len(command) == 1 or knows_expand(command[0])):
            return command
    return None


def knows_expand(program):
    help_text = subprocess.run([program, "expand", "--help"], capture_output=True, text=True)
    return help_text.returncode == 0 and "--package-path" in help_text.stdout


def expand(command, file, folders, arguments=()):
    paths = [word for folder in folders for word in ("--package-path", str(folder))]
    return run([*command, str(file), *paths, *arguments])


def reference_command(file, folders, arguments=()):
    return [sys.executable, str(HERE / "reference.py"), os.pathsep.join(map(str, folders)), str(file), *arguments]


def reference(file, folders, arguments=()):
    return run(reference_command(file, folders, arguments))


def run(command):
    return subprocess.run(command, capture_output=True, text=True, env=ENVIRONMENT)
