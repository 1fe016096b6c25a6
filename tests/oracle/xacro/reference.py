"""The Python tool `xacro` with packages found in given folders: `python reference.py FOLDER[:FOLDER…] FILE [name:=value…]`.

The tool asks `ament_index_python`, a part of ROS, for packages; this script replaces it.
"""

import os
import re
import sys
import types
from pathlib import Path

NAME = re.compile(r"<name>\s*([^<\s]+)\s*</name>")


def package_folder(name, folders):
    """The folder of a package: by its own name, else by the name in its package.xml."""
    for folder in folders:
        if (folder / name).is_dir():
            return str((folder / name).absolute())
    for folder in folders:
        for manifest in sorted(folder.rglob("package.xml")):
            found = NAME.search(manifest.read_text(encoding="utf-8"))
            if found and found[1] == name:
                return str(manifest.parent.absolute())
    raise LookupError(f"package {name} is not found")


def main():
    folders = [Path(folder) for folder in sys.argv[1].split(os.pathsep)]
    packages = types.ModuleType("ament_index_python.packages")
    packages.get_package_share_directory = lambda name: package_folder(name, folders)
    sys.modules["ament_index_python"] = types.ModuleType("ament_index_python")
    sys.modules["ament_index_python.packages"] = packages
    import xacro

    sys.argv = ["xacro", *sys.argv[2:]]
    xacro.main()


if __name__ == "__main__":
    main()
