"""Our expansion compared with the Python tool's: fixtures, the vendors' files, and every xacro file of rtb-data."""

import csv
import os
import sysconfig
from pathlib import Path

import pytest

from canonical import difference
from programs import WORKSPACE, expand, ours, reference

FEATURES = WORKSPACE / "crates/xacro/tests/fixtures/features"
VENDOR = WORKSPACE.parent / "shared/vendor/xacro"
RTB_DATA = Path(sysconfig.get_paths()["purelib"]) / "rtbdata"

# Upstream names of packages in the files of rtb-data, and their folders there.
RENAMED = {
    "abb_irb140": "xacro/abb_irb140_description",
    "kuka_resources": "xacro/kuka_description/kuka_resources",
    **{
        f"kuka_{robot}_support": f"xacro/kuka_description/kuka_{robot}"
        for robot in ("kr10", "kr120", "kr150", "kr16", "kr210", "kr3", "kr5", "kr6", "lbr_iiwa")
    },
}
# Files that no program can expand: two need a package (lms1xx) that rtb-data does not have, one needs a property
# (`deg`) that nothing defines.
INCOMPLETE = {"sick_lms1xx_mount.urdf.xacro", "sick_s300_mount.urdf.xacro", "kr210l150.xacro"}


@pytest.fixture(scope="module")
def command():
    command = ours()
    if command is None:
        pytest.skip("skipped, because neither denavit nor the example `expand` is built")
    return command


def check(command, file, folders, arguments=()):
    theirs = reference(file, folders, arguments)
    mine = expand(command, file, folders, arguments)
    assert theirs.returncode == 0, f"the Python tool: {theirs.stderr}"
    assert mine.returncode == 0, mine.stderr
    found = difference(mine.stdout, theirs.stdout)
    assert found is None, found


@pytest.mark.parametrize("file", sorted(FEATURES.glob("*.xacro")), ids=lambda file: file.stem)
def test_each_feature_expands_as_the_python_tool_does(command, file):
    check(command, file, [FEATURES / "packages"])


def vendor_cases():
    for table in sorted([*VENDOR.glob("cases.csv"), *VENDOR.glob("more/*/cases.csv")]):
        packages = table.parent / "packages"
        with open(table, newline="") as lines:
            for name, file, arguments in list(csv.reader(lines))[1:]:
                yield pytest.param(packages / file, packages, arguments.split(), id=name)


@pytest.mark.skipif(not VENDOR.is_dir(), reason="skipped, because ../shared/vendor/xacro is not there")
@pytest.mark.parametrize("file, packages, arguments", list(vendor_cases()))
def test_vendors_files_expand_as_the_python_tool_does(command, file, packages, arguments):
    check(command, file, [packages], arguments)


@pytest.fixture(scope="module")
def rtb_packages(tmp_path_factory):
    folder = tmp_path_factory.mktemp("packages")
    for name, place in RENAMED.items():
        os.symlink(RTB_DATA / place, folder / name)
    return [folder, RTB_DATA / "xacro", RTB_DATA]


@pytest.mark.skipif(not RTB_DATA.is_dir(), reason="skipped, because rtb-data is not installed")
def test_rtb_data_is_all_there_and_what_is_incomplete_is_refused_by_both(command, rtb_packages):
    files = list(RTB_DATA.rglob("*.xacro"))
    assert len(files) == 60
    incomplete = [file for file in files if file.name in INCOMPLETE]
    assert len(incomplete) == 3
    for file in incomplete:
        assert reference(file, rtb_packages).returncode != 0, file
        assert expand(command, file, rtb_packages).returncode == 2, file


@pytest.mark.skipif(not RTB_DATA.is_dir(), reason="skipped, because rtb-data is not installed")
@pytest.mark.parametrize(
    "file",
    [file for file in sorted(RTB_DATA.rglob("*.xacro")) if file.name not in INCOMPLETE],
    ids=lambda file: str(file.relative_to(RTB_DATA)),
)
def test_rtb_data_expands_as_the_python_tool_does(command, rtb_packages, file):
    check(command, file, rtb_packages)


@pytest.mark.parametrize(
    "body",
    [
        "<a b='${undefined}'/>",
        "<a b='${1 +}'/>",
        "<a b='${1 / 0}'/>",
        "<a b='${[1][3]}'/>",
        "<a b='$(arg missing)'/>",
        "<a b='$(command ls)'/>",
        "<a b='$(find no_such_package)'/>",
        "<a b='${x'/>",
        "<a b='$$5'/>",
        "<xacro:nothing/>",
        "<xacro:if value='maybe'/>",
        "<xacro:property name='class' value='1'/>",
        "<xacro:insert_block name='nothing'/>",
        "<xacro:macro name='m' params='p'/><xacro:m/>",
        "<xacro:macro name='m'/><xacro:m p='1'/>",
        "<xacro:macro name='m'/><xacro:m><a/></xacro:m>",
        "<xacro:property name='p' value='${q}'/><xacro:property name='q' value='${p}'/><a b='${p}'/>",
        "<xacro:include filename='missing.xacro'/>",
        "<a b='${().__class__}'/>",
    ],
)
def test_what_the_python_tool_refuses_is_refused(command, tmp_path, body):
    file = tmp_path / "robot.xacro"
    file.write_text(f"<robot xmlns:xacro='http://www.ros.org/wiki/xacro'>{body}</robot>")
    assert reference(file, [tmp_path]).returncode != 0
    mine = expand(command, file, [tmp_path])
    assert mine.returncode == 2 and mine.stdout == "" and "robot.xacro:1:" in mine.stderr
