"""D-H tables from our expansion and from the Python tool's: the same to the last digit of the screw axes."""

import csv
import subprocess
from pathlib import Path

import pytest

import built

TOP = Path(__file__).resolve().parents[3]
VENDOR = TOP.parent / "shared" / "vendor" / "xacro"


def cases():
    for listing in [VENDOR / "cases.csv", *sorted(VENDOR.glob("more/*/cases.csv"))]:
        if not listing.is_file():
            continue
        for row in csv.reader(listing.open(encoding="utf-8")):
            if row[0] != "name":
                yield pytest.param(listing.parent, row[1], row[2].split(), row[0], id=row[0])


def table(*arguments):
    run = subprocess.run([built.denavit(), "table", *map(str, arguments), "--format", "csv"], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return [row for row in csv.reader(run.stdout.splitlines())]


@pytest.mark.parametrize(("folder", "file", "arguments", "name"), list(cases()))
def test_the_table_is_that_of_the_python_tools_expansion(folder, file, arguments, name):
    packages = folder / "packages"
    ours = table(packages / file, *arguments, "--package-path", packages)
    theirs = table(folder / "expected" / f"{name}.urdf")
    assert len(ours) == len(theirs)
    for mine, other in zip(ours, theirs):
        for a, b in zip(mine, other):
            assert a == b or abs(float(a) - float(b)) < 1e-12
