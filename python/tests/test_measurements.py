"""Whatever `denavit calibrate` reads, `Measurements.read` reads too, under the same names, to the same JSON."""

from __future__ import annotations

import io
import json
import os
import pickle
import sqlite3
import struct
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import denavit as dn

TOP = Path(__file__).resolve().parents[2]
FILES = TOP / "tests/measured/files"
ROBOT = TOP / "robots/universal_robots/ur5e.urdf"


@pytest.fixture(scope="module")
def drawn() -> dn.Chain:
    return dn.load(ROBOT).chain()


@pytest.fixture(scope="module")
def poses(drawn: dn.Chain) -> dn.Measurements:
    """Forty full poses."""
    return drawn.simulate(40, seed=2, measure="poses").data


def fitted(chain: dn.Chain, data: dn.Measurements) -> dict[str, object]:
    """The calibration of the geometry, without what names the file and its columns."""
    found = dn.calibrate(chain, data, effects=None).to_dict()
    del found["columns"], found["origin"]
    for row in found.get("rows", ()):
        del row["line"]
    return found


def of_command(*words: str) -> dict[str, object]:
    command = os.environ.get("DENAVIT")
    if command is None or not Path(command).exists():
        pytest.skip("skipped, because DENAVIT names no command line to compare with")
    line = [command, "calibrate", os.fspath(ROBOT), "--effects", "none", "--json", *words]
    done = subprocess.run(line, capture_output=True, check=True)
    found: dict[str, object] = json.loads(done.stdout)
    return found


def test_a_workbook_is_read_as_the_command_reads_it(drawn: dn.Chain) -> None:
    book = dn.Measurements.read(FILES / "readings.xlsx", units="mm,deg")
    table = dn.Measurements.read(FILES / "readings.csv", units="mm,deg")
    assert isinstance(book.content, bytes)
    assert [name.partition(" ")[0].lower() for name in book.columns] == list(table.columns)
    assert len(book) == len(table) > 20
    assert fitted(drawn, book) == fitted(drawn, table)
    assert dn.calibrate(drawn, book, effects=None).to_dict() == of_command(
        "--data", str(FILES / "readings.xlsx"), "--units", "mm,deg"
    )
    assert pickle.loads(pickle.dumps(book)) == book != table


def test_other_encodings_and_separators(drawn: dn.Chain, poses: dn.Measurements, tmp_path: Path) -> None:
    text = poses.text
    own = fitted(drawn, poses)
    rows = text.replace(",", ";").replace(".", ",")
    for name, content in (("semicolons.csv", rows.encode()), ("wide.csv", text.replace(",", "\t").encode("utf-16"))):
        (tmp_path / name).write_bytes(content)
        read = dn.Measurements.read(tmp_path / name)
        assert read.columns == poses.columns
        assert len(read) == len(poses)
        assert fitted(drawn, read) == own, name
        read.save(tmp_path / "again.csv")
        assert (tmp_path / "again.csv").read_bytes() == content


def exported(poses: dn.Measurements, angles: list[str], values: np.ndarray, path: Path) -> str:
    """Poses with their orientation under other names; rotations as `values`."""
    frame = pytest.importorskip("pandas").read_csv(io.StringIO(poses.text), comment="#")
    frame = frame.drop(columns=["qx", "qy", "qz", "qw"]).rename(columns={"x": "PX", "y": "PY", "z": "PZ"})
    frame[angles] = values
    frame.to_csv(path, index=False)
    return os.fspath(path)


def turns(poses: dn.Measurements) -> Rotation:
    frame = pytest.importorskip("pandas").read_csv(io.StringIO(poses.text), comment="#")
    return Rotation.from_quat(frame[["qx", "qy", "qz", "qw"]].to_numpy())


@pytest.mark.parametrize("form", ["euler", "fixed", "rotation_vector", "quaternion"])
def test_the_columns_of_an_orientation(form: str, drawn: dn.Chain, poses: dn.Measurements, tmp_path: Path) -> None:
    """The turns are written by scipy, and read back as the quaternions that they were."""
    turn = turns(poses)
    names, values, told = {
        "euler": (["A", "B", "C"], turn.as_euler("ZYX"), {"euler": "ZYX"}),
        "fixed": (["roll", "pitch", "yaw"], turn.as_euler("xyz"), {"euler": "xyz"}),
        "rotation_vector": (["rx", "ry", "rz"], turn.as_rotvec(), {"rotation_vector": True}),
        "quaternion": (["q1", "q2", "q3", "q4"], turn.as_quat()[:, [3, 0, 1, 2]], {"quaternion": "wxyz"}),
    }[form]
    path = exported(poses, names, values, tmp_path / "run.csv")
    want = fitted(drawn, poses)["stages"][-1]["train"]  # type: ignore[index]
    for columns in ("x=PX,y=PY,z=PZ", {"x": "PX", "y": "PY", "z": "PZ"}):
        if isinstance(columns, dict):
            key, value = next(iter(told.items()))
            columns = columns | {key: names if value is True else {"order": value, "columns": names}}  # noqa: PLW2901
            columns |= {"joints": list(drawn.joints), "units": "m,rad"}
            data = dn.Measurements.read(path, columns=columns)
        else:
            data = dn.Measurements.read(path, columns=columns, **told)  # type: ignore[arg-type]
        got = fitted(drawn, data)["stages"][-1]["train"]  # type: ignore[index]
        assert got == pytest.approx(want, rel=1e-6)
    words = ["--rotation-vector"] if form == "rotation_vector" else [f"--{next(iter(told))}", str(next(iter(told.values())))]
    theirs = of_command("--data", path, "--columns", "x=PX,y=PY,z=PZ", *words)
    read = dn.Measurements.read(path, columns="x=PX,y=PY,z=PZ", **told)  # type: ignore[arg-type]
    assert dn.calibrate(drawn, read, effects=None).to_dict() == theirs


def test_a_map_in_a_file_and_a_draft_of_one(drawn: dn.Chain, poses: dn.Measurements, tmp_path: Path) -> None:
    path = tmp_path / "map.toml"
    draft = poses.columns_draft(drawn)
    assert 'units = "m,rad"' in draft
    turn = 'quaternion = { order = "xyzw", columns = ["qx", "qy", "qz", "qw"] }\n'
    path.write_text(draft + turn)
    (tmp_path / "run.csv").write_text(poses.text)
    read = dn.Measurements.read(tmp_path / "run.csv", columns=path)
    assert fitted(drawn, read)["stages"] == fitted(drawn, poses)["stages"]
    path.write_text("x = 3")
    with pytest.raises(dn.ArgumentError, match=r"map\.toml: \"x\" must be a column"):
        dn.calibrate(drawn, dn.Measurements.read(tmp_path / "run.csv", columns=path))


def test_joints_from_a_robot_program(drawn: dn.Chain, poses: dn.Measurements, tmp_path: Path) -> None:
    frame = pytest.importorskip("pandas").read_csv(io.StringIO(poses.text), comment="#")
    moves = (f"movej([{', '.join(repr(float(q)) for q in row)}])" for row in frame[list(drawn.joints)].to_numpy())
    (tmp_path / "run.script").write_text("def run():\n" + "\n".join(moves) + "\nend\n")
    frame.drop(columns=list(drawn.joints)).to_csv(tmp_path / "seen.csv", index=False)
    read = dn.Measurements.read(tmp_path / "seen.csv", joints=tmp_path / "run.script")
    assert fitted(drawn, read)["stages"] == fitted(drawn, poses)["stages"]


def test_readings_in_a_socket(drawn: dn.Chain, tmp_path: Path) -> None:
    q = drawn.sample(20, seed=3)
    np.savetxt(tmp_path / "front.csv", q, delimiter=",")
    read = dn.Measurements.read(tmp_path / "front.csv", socket="front/0")
    assert (len(read), read.columns, read.socket) == (20, (), "front/0")
    bare = dn.Measurements.read(tmp_path / "front.csv")
    with pytest.raises(dn.DenavitError) as one:
        dn.calibrate(drawn, [read], effects=None)
    with pytest.raises(dn.DenavitError) as other:
        dn.calibrate(drawn, socket={"front/0": bare}, effects=None)
    assert str(one.value) == str(other.value)


def test_the_corners_that_a_camera_sees(drawn: dn.Chain, tmp_path: Path) -> None:
    camera, corners, board = tmp_path / "webcam.yaml", tmp_path / "corners.csv", "7x5:30mm"
    camera.write_text("camera_matrix: [600, 0, 320, 0, 600, 240, 0, 0, 1]\nimage_width: 640\nimage_height: 480\n")
    for on_hand in (False, True):
        run = drawn.simulate(30, seed=4, test=10, camera=camera, board=board, on_hand=on_hand)
        run.data.save(corners)
        read = dn.Measurements.read(corners, camera=camera, board=board, on_hand=on_hand)
        assert len(read) == len(run.data) == 30
        found = dn.calibrate(drawn, read, effects=None).to_dict()
        words = ["--camera", os.fspath(camera), "--board", board, *(["--on-hand"] if on_hand else [])]
        assert found == of_command("--data", os.fspath(corners), *words)
        # Two components of 0.2 px, less what the parameters take up.
        assert 0.24 < found["stages"][-1]["train"]["reprojection_rms_px"] < 0.29
        own = dn.calibrate(drawn, run.data, test=run.test, effects=None)
        assert own.to_dict()["stages"][-1]["test"]["reprojection_rms_px"] < 0.36
    with pytest.raises(dn.ArgumentError, match="needs a board"):
        drawn.simulate(5, camera=camera)


@pytest.mark.parametrize(
    ("keywords", "why"),
    [
        ({"board": "7x5:30mm"}, "board needs a camera"),
        ({"camera": os.fspath(FILES / "readings.csv")}, "camera_matrix|intrinsics"),
        ({"euler": "XYZ", "quaternion": "wxyz"}, "euler and quaternion exclude each other"),
        ({"socket": "a", "euler": "XYZ"}, "leave out descriptions of columns"),
        ({"euler": "XXZ"}, "euler: "),
        ({"quaternion": "wwxy"}, "quaternion"),
        ({"columns": "x"}, "No such file"),
        ({"columns": "x=nothing"}, 'there is no column "nothing"'),
        ({"units": "furlong"}, "units: "),
    ],
)
def test_what_cannot_be_is_refused(keywords: dict[str, str], why: str, drawn: dn.Chain) -> None:
    with pytest.raises(dn.DenavitError, match=why):
        dn.calibrate(drawn, dn.Measurements.read(FILES / "readings.csv", **keywords), effects=None)  # type: ignore[arg-type]


def test_a_broken_workbook_is_named(drawn: dn.Chain, tmp_path: Path) -> None:
    (tmp_path / "run.xlsx").write_bytes((FILES / "readings.xlsx").read_bytes()[:400])
    broken = dn.Measurements.read(tmp_path / "run.xlsx")
    for use in (lambda: broken.columns, lambda: dn.calibrate(drawn, broken)):
        with pytest.raises(dn.DataError, match=r"run\.xlsx.*this Excel workbook cannot be read"):
            use()


def message(*parts: float | str | list[float] | list[str]) -> bytes:
    """Little-endian CDR: whole numbers of 4 bytes, floats of 8, texts and lists after their length."""
    out = b""

    def put(form: str, value: float) -> None:
        nonlocal out
        size = struct.calcsize(form)
        out += b"\0" * (-len(out) % size) + struct.pack("<" + form, value)

    def add(part: float | str | list[float] | list[str]) -> None:
        nonlocal out
        if isinstance(part, (str, list)):
            put("I", len(part) + isinstance(part, str))
            if isinstance(part, str):
                out += part.encode() + b"\0"
            else:
                for entry in part:
                    add(entry)
        else:
            put("i" if isinstance(part, int) else "d", part)

    for part in parts:
        add(part)
    return b"\0\1\0\0" + out


def test_a_bag_is_read_as_the_command_reads_it(drawn: dn.Chain, poses: dn.Measurements, tmp_path: Path) -> None:
    bag = tmp_path / "run.db3"
    stand, move, start = 1.0, 0.5, 1_700_000_000
    names = list(drawn.joints)
    rows = poses.to_pandas()
    with sqlite3.connect(bag) as opened:
        opened.execute("CREATE TABLE topics(id INTEGER, name TEXT, type TEXT)")
        opened.execute("CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB)")
        kinds = [(1, "/joint_states", "sensor_msgs/msg/JointState"), (2, "/tracker", "geometry_msgs/msg/PointStamped")]
        opened.executemany("INSERT INTO topics VALUES (?, ?, ?)", kinds)
        for step in range(round(len(rows) * (stand + move) * 50)):
            time = step / 50
            row, within = divmod(time, stand + move)
            share = max(0.0, within - stand) / move
            after = min(int(row) + 1, len(rows) - 1)
            now = (1 - share) * rows.iloc[int(row)] + share * rows.iloc[after]
            stamp = [int(start + time), round((time % 1) * 1e9)]
            log = stamp[0] * 10**9 + stamp[1]
            said = message(*stamp, "", names, [float(now[name]) for name in names], [], [])
            seen = message(*stamp, "tracker", *(float(now[axis]) for axis in "xyz"))
            opened.executemany(
                "INSERT INTO messages(topic_id, timestamp, data) VALUES (?, ?, ?)", [(1, log, said), (2, log, seen)]
            )
    data = dn.Measurements.from_bag(bag, drawn)
    assert len(data) == len(rows) and data.text.startswith("# 40 standstills")
    found = data.to_pandas()
    assert np.allclose(found[names], rows[names], atol=1e-9) and np.allclose(found[["x", "y", "z"]], rows[["x", "y", "z"]])
    mine, theirs = dn.calibrate(drawn, data, effects=None).to_dict(), of_command("--data", os.fspath(bag))
    assert mine["stages"] == theirs["stages"] and mine["parameters"] == theirs["parameters"]
    with pytest.raises(dn.DataError, match="no_such_topic"):
        dn.Measurements.from_bag(bag, drawn, target_topic="/no_such_topic")
