"""Completion offers MuJoCo's words for MJCF and sdformat's for SDF."""

import os
import sys
from pathlib import Path

import pytest
import vocabulary

LISTS = Path(__file__).resolve().parents[2] / "crates/lsp/src/vocabulary"
mujoco = pytest.importorskip("mujoco")


def listed(name):
    return (LISTS / f"{name}.txt").read_text().splitlines()[1:]


def test_the_list_of_mjcf_is_mujoco_s_schema():
    assert listed("mjcf") == vocabulary.mjcf()


def test_the_list_of_sdf_is_that_of_sdformat():
    folder = Path(os.environ.get("SDFORMAT", vocabulary.SDF))
    if not folder.is_dir():
        pytest.skip("because Debian's package sdformat-sdf is not installed")
    vocabulary.SDF = folder
    assert listed("sdf") == vocabulary.sdf()


# Where an element may stand.
PLACES = {
    "compiler": "{}",
    "option": "{}",
    "joint": "<worldbody><body><geom size='1'/>{}</body></worldbody>",
    "body": "<worldbody>{}</worldbody>",
    "geom": "<worldbody>{}</worldbody>",
    "site": "<worldbody>{}</worldbody>",
    "camera": "<worldbody>{}</worldbody>",
    "light": "<worldbody>{}</worldbody>",
    "texture": "<asset>{}</asset>",
    "mesh": "<asset>{}</asset>",
    "general": "<actuator>{}</actuator>",
    "connect": "<worldbody><body name='b'><geom size='1'/></body></worldbody><equality>{}</equality>",
    "weld": "<worldbody><body name='b'><geom size='1'/></body></worldbody><equality>{}</equality>",
}


def complaint(tag, attribute, value):
    ends = {"connect": "body1='b' anchor='0 0 0'", "weld": "body1='b'"}.get(tag, "")
    element = f'<{tag} {ends} {attribute}="{value}"/>'
    try:
        mujoco.MjSpec.from_string(f"<mujoco>{PLACES[tag].format(element)}</mujoco>")
    except ValueError as problem:
        return str(problem)
    return ""


def switches():
    for tag, names in vocabulary.SWITCHES.items():
        yield from (((tag, name), vocabulary.BOOL) for name in names)


@pytest.mark.parametrize(("where", "values"), [*vocabulary.KEYWORDS.items(), *switches(), (("joint", "limited"), vocabulary.AUTO)])
def test_mujoco_knows_every_value(where, values):
    tag, attribute = where
    assert "invalid keyword" in complaint(tag, attribute, "no such word")
    for value in values:
        assert "invalid keyword" not in complaint(tag, attribute, value), value


@pytest.mark.parametrize(("tag", "attributes"), [("frame", vocabulary.FRAME), ("replicate", vocabulary.REPLICATE)])
def test_mujoco_reads_the_elements_that_its_schema_leaves_out(tag, attributes):
    for attribute in attributes:
        # Any text is a name or a separator.
        if attribute in ("name", "sep"):
            continue
        count = 'count="2"' if tag == "replicate" and attribute != "count" else ""
        with pytest.raises(ValueError):
            mujoco.MjSpec.from_string(f"<mujoco><worldbody><{tag} {count} {attribute}='no such value'/></worldbody></mujoco>")


if __name__ == "__main__":
    sys.exit(pytest.main([__file__]))
