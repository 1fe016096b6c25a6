"""Robots, chains, tables, comparisons: sources, values that do not change, errors that say where."""

from __future__ import annotations

import json
import pickle
import subprocess
from pathlib import Path

import numpy as np
import pytest

import denavit as dn

UR5E = "robots/universal_robots/ur5e.urdf"
DH = "robots/universal_robots/ur5e_dh.csv"


def test_every_source_gives_the_same_robot(ur5e: dn.Robot, tmp_path: Path) -> None:
    text = Path(UR5E).read_text()
    xacro = tmp_path / "arm.xacro"
    xacro.write_text(text.replace("<robot ", '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" ', 1))
    for source in (UR5E, Path(UR5E), text, text.encode(), xacro, ur5e, DH):
        found = dn.diff(ur5e, source)
        assert found.same, source
        assert not found
    made, q = dn.load(DH).canonical(), ur5e.chain().sample(20)
    np.testing.assert_allclose(made.chain().fk(q), ur5e.chain().fk(q), atol=1e-12)


def test_xacro_takes_arguments() -> None:
    text = """<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="reach" default="1"/>
      <link name="a"/><link name="b"/><joint name="j" type="continuous"><parent link="a"/><child link="b"/>
      <origin xyz="$(arg reach) 0 0"/><axis xyz="0 0 1"/></joint></robot>"""
    assert dn.load(text, arguments={"reach": 2.5}).chain().tips([0.0])[0] == 2.5


def test_a_revision_in_git_is_a_source(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = Path(UR5E).read_text()
    monkeypatch.chdir(tmp_path)
    Path("arm.urdf").write_text(text)
    for words in ("init -q", "add arm.urdf", "-c user.name=n -c user.email=e commit -qm first"):
        subprocess.run(["git", *words.split()], check=True)
    Path("arm.urdf").write_text(text.replace("0.1625", "0.1645"))
    d = dn.diff("git:HEAD:arm.urdf", "arm.urdf")
    assert not d.same
    assert d
    assert d.tip is not None
    assert d.tip.tip == "tool0"
    assert d.tip.sampled == pytest.approx(0.002, abs=1e-9)
    assert d.tip.bound >= d.tip.sampled
    assert d.joints
    assert "2 mm" in repr(d)


def test_a_table_is_a_source_as_columns_rows_or_frame() -> None:
    pandas = pytest.importorskip("pandas", reason="skipped, because pandas is not installed")
    a = [0.0, -0.425, -0.3922, 0, 0, 0]
    alpha = [np.pi / 2, 0, 0, np.pi / 2, -np.pi / 2, 0]
    d = [0.1625, 0, 0, 0.1333, 0.0997, 0.0996]
    columns = {"theta": 0, "d": d, "alpha": alpha, "a": a}
    rows = [{"theta": 0.0, "d": d[i], "alpha": alpha[i], "a": a[i]} for i in range(6)]
    frame = pandas.DataFrame(rows)
    vendor = dn.load(DH).chain()
    q = vendor.sample(20)
    for source in (columns, rows, frame):
        np.testing.assert_allclose(dn.load(source).chain().fk(q), vendor.fk(q), atol=1e-15)
    assert dn.load(columns, convention="proximal").chain().table().convention == "proximal"


def test_values_are_equal_hashable_picklable_and_do_not_change(ur5e: dn.Robot, chain: dn.Chain) -> None:
    table = chain.table("proximal")
    found = dn.diff(ur5e, DH)
    values = [ur5e, chain, table, dn.load(DH), found, dn.fingerprint(ur5e), dn.check(UR5E), table.match(DH)]
    for value in values:
        again = pickle.loads(pickle.dumps(value))
        assert again == value
        assert hash(again) == hash(value)
        assert repr(again) == repr(value)
        assert value != 1
        with pytest.raises((AttributeError, TypeError)):
            value.name = "other"  # type: ignore[union-attr, misc]
    assert chain != ur5e.chain("base", "wrist_3_link")
    assert table != chain.table("distal")
    for made in (dn.Robot, dn.Chain, dn.Table):
        with pytest.raises(TypeError):
            made()


def test_chains_are_listed(ur5e: dn.Robot) -> None:
    (default,) = [listing for listing in ur5e.chains if listing.default]
    assert (default.tip, len(default.coordinates)) == ("tool0", 6)
    shoulder = ur5e.chain().coordinates[0]
    assert (shoulder.name, shoulder.quantity, shoulder.effort) == ("shoulder_pan_joint", "angle", 150.0)


def test_the_table_says_what_the_command_says(chain: dn.Chain) -> None:
    table = chain.table("distal")
    assert table.to_dict()["schema"] == "denavit.table/1"
    assert table.to_dict() == json.loads(table.format("json"))
    assert [row.row for row in table.rows] == ["base", "1", "2", "3", "4", "5", "6", "tool"]
    assert table.rows[2].a == -0.425
    assert "<td style='text-align:right'>-425</td>" in table._repr_html_()
    assert r"\begin{tabular}" in table._repr_latex_()
    assert table.match(DH).exact
    assert not table.match({"theta": 0, "d": 0, "alpha": 0, "a": [1, 2, 3, 4, 5, 6]})
    assert chain.table("standard") == table


def test_a_table_as_data_frame(chain: dn.Chain) -> None:
    pytest.importorskip("pandas", reason="skipped, because pandas is not installed")
    frame = chain.table().to_pandas()
    assert list(frame.columns) == ["joint", "kind", "theta", "d", "alpha", "a"]
    assert frame.loc["3", "a"] == -0.3922


def test_notes_tell_what_was_read_otherwise() -> None:
    text = Path(UR5E).read_text()
    cut = dn.load(text.replace("1.5707963267948966", "1.5708"), file="cut.urdf")
    notes = cut.chain().table().notes
    assert notes
    assert {(note.written, note.read_as) for note in notes} <= {("1.5708", "π/2"), ("-1.5708", "-π/2")}
    assert all(note.file == "cut.urdf" and note.line for note in notes)
    assert cut.chain().tip_moves_at_most > 0
    assert cut.chain(exact=True).notes == ()


def test_files_are_written_as_a_whole_or_not_at_all(ur5e: dn.Robot, tmp_path: Path) -> None:
    path = tmp_path / "c.urdf"
    ur5e.canonical().save(path)
    assert dn.diff(ur5e, path).same
    ur5e.chain().table().save(tmp_path / "t.csv")
    assert dn.diff(ur5e, tmp_path / "t.csv").same
    with pytest.raises(dn.ArgumentError, match="no folder") as refused:
        ur5e.save(tmp_path / "none" / "c.urdf")
    assert refused.value.file == str(tmp_path / "none" / "c.urdf")
    with pytest.raises(dn.ArgumentError, match="not a URDF"):
        dn.load(DH).save(tmp_path / "d.urdf")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["c.urdf", "t.csv"]


@pytest.mark.parametrize(
    ("source", "kind", "file", "line", "hint"),
    [
        ("nothing.urdf", dn.ReadError, "nothing.urdf", None, None),
        ("<robot>\n  <link/>\n</robot>", dn.RobotError, "<text>", 2, "give it one"),
        ({"theta": 0, "d": 0, "alpha": 0, "a": ["x"]}, dn.RobotError, "table.csv", 2, "write a finite number"),
        (b"\xff\xfe", dn.ArgumentError, "<bytes>", None, "decode it first"),
        (3, dn.ArgumentError, None, None, None),
    ],
)
def test_errors_say_where_and_what_to_do(
    source: object, kind: type[dn.DenavitError], file: str | None, line: int | None, hint: str | None
) -> None:
    with pytest.raises(kind) as raised:
        dn.load(source)
    error = raised.value
    assert (error.file, error.line) == (file, line)
    assert hint is None or (error.hint or "").startswith(hint)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.file, again.line) == (str(error), error.file, error.line)


def test_errors_of_xacro_have_a_column_and_options_are_keywords(ur5e: dn.Robot) -> None:
    with pytest.raises(dn.RobotError) as raised:
        dn.load(
            '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<link name="${nix}"/></robot>',
            file="a.xacro",
        )
    assert (raised.value.line, raised.value.column is not None) == (2, True)
    with pytest.raises(dn.ChainError, match='did you mean "base"'):
        ur5e.chain("bas")
    with pytest.raises(dn.ChainError, match="tip= chooses a link"):
        dn.load(DH).chain(tip="x")


def test_fingerprints_and_rules(ur5e: dn.Robot) -> None:
    found = dn.fingerprint(ur5e)
    assert found.matches(str(found))
    assert found.matches(str(ur5e.canonical().fingerprint()), only_motion=True)
    assert not found.matches(str(dn.fingerprint(DH)))
    rules = dn.check(UR5E)
    assert {(finding.rule, finding.level) for finding in rules.findings} == {("D035", "warning")}
    assert rules.ok
    assert not dn.check(UR5E, deny=["D035"]).ok
    assert len(dn.check(UR5E, allow=["D035"])) == 0
    with pytest.raises(dn.ArgumentError, match="no rule"):
        dn.check(UR5E, deny=["nothing"])
