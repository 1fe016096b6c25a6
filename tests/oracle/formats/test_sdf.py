"""SDF read and written by denavit, compared with Drake: asserts on a few files what `sdf.py` prints."""

import math
import re

import pytest
import sdf
from lxml import etree

pytest.importorskip("pydrake", reason="skipped, because drake is not installed (pip install drake)")

HERE = sdf.corpus.WORKSPACE


def need(path):
    if not path.exists():
        pytest.skip(f"skipped, because {path} is not there")
    return path


def built(name):
    return need(sdf.program(name))


@pytest.mark.parametrize("pitch", ["<screw_thread_pitch>0.012</screw_thread_pitch>", "<thread_pitch>3141.6</thread_pitch>", ""])
def test_pitch_of_screw_joints(tmp_path, pitch):
    """The pitch in m per rad is screw_thread_pitch/2π = -1/thread_pitch; 1 m per turn if neither is stated."""
    built("sdf_to_urdf")
    text = f"""<sdf version="1.11"><model name="m"><link name="a"/><link name="b"/><joint name="s" type="screw">
        <parent>a</parent><child>b</child>{pitch}<axis><xyz>0 0 1</xyz></axis></joint></model></sdf>"""
    path = tmp_path / "screw.sdf"
    path.write_text(text)
    count, worst, _, heavy, _, _ = sdf.of_sdf(path)
    assert count == 2 * (1 + sdf.VECTORS) and worst < 1e-12 and heavy < 1e-12
    drake = sdf.Drake(text).plant.GetJointByName("s").screw_pitch()
    tree = etree.fromstring(sdf.converted("sdf_to_urdf", path)[0].encode())
    ours = float(tree.find(f"{sdf.DRAKE}joint/{sdf.DRAKE}screw_thread_pitch").get("value"))
    assert math.isclose(drake, ours, rel_tol=1e-15)
    if number := re.search(r"<thread_pitch>(.*)</", pitch):
        assert math.isclose(ours / (2 * math.pi), -1 / float(number[1]), rel_tol=1e-15)


def test_models_of_each_construct():
    built("sdf_to_urdf")
    for name in ["old_frames", "new_frames"]:
        count, worst, _, heavy, _, _ = sdf.of_sdf(HERE / f"crates/sdf/tests/models/{name}.sdf")
        assert count and worst < sdf.NEAR and heavy < sdf.NEAR, name


def test_models_in_a_model_are_in_drake_where_they_were(tmp_path):
    built("sdf_to_urdf")
    built("urdf_to_sdf")
    path = HERE / "crates/sdf/tests/models/cell.sdf"
    again = tmp_path / "again.sdf"
    (tmp_path / "nested.urdf").write_text(sdf.converted("sdf_to_urdf", path)[0])
    again.write_text(sdf.converted("urdf_to_sdf", tmp_path / "nested.urdf")[0])
    assert '<model name="arm">' in again.read_text()
    frames = [sdf.Drake(text.read_text()) for text in (path, again)]
    for value in (0.0, 0.4):
        for drake in frames:
            drake.set({name: value for joint in drake.joints for name in drake.names(joint)})
        one, other = (drake.frames() for drake in frames)
        for name in ("arm::base", "arm::upper", "arm::tool::other", "arm::eye"):
            assert abs(one[name] - other[name]).max() < sdf.NEAR, name


def test_sdf_of_others_is_read_as_drake_reads_it():
    built("sdf_to_urdf")
    folder = need(sdf.corpus.SHARED / "vendor/sdf")
    files = [path for path in sorted(folder.rglob("*.sdf")) if path.parent.name != "turtlebot"]
    for path in files:
        _, worst, _, heavy, _, _ = sdf.of_sdf(path)
        assert worst < sdf.NEAR and heavy < sdf.NEAR, path
    print(f"{len(files)} files")


def test_drake_reads_what_is_written():
    built("urdf_to_sdf")
    files = sorted((HERE / "robots").rglob("*.urdf"))
    for path in files:
        _, worst, _, heavy, _, _ = sdf.of_urdf(path)
        assert worst < sdf.NEAR and heavy < sdf.NEAR, path
    print(f"{len(files)} files")
