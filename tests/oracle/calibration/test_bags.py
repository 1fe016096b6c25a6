"""Bags that `rosbags` writes, against the same data as CSV."""

import csv
import json
import subprocess

import numpy as np
import pytest
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import built

UR5E = built.WORKSPACE / "robots/universal_robots/ur5e.urdf"
STORE = get_typestore(Stores.ROS2_HUMBLE)
TYPES = STORE.types
STAND, MOVE = 1.2, 1.0
# Instrument's clock less robot's, s: they were started on different days.
AHEAD = 86_412.5371
START = 1_700_000_000.0


def run(*arguments, code=0):
    found = subprocess.run([built.denavit(), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert found.returncode == code, found.stderr
    return found


@pytest.fixture(scope="module")
def measured(tmp_path_factory):
    """Rows of a simulated run: names of the joints, joint values, full poses."""
    file = tmp_path_factory.mktemp("rows") / "rows.csv"
    run("simulate", UR5E, "--rows", 45, "--measure", "poses", "-o", file)
    with open(file) as opened:
        rows = list(csv.reader(line for line in opened if not line.startswith("#")))
    numbers = np.array([[float(cell) for cell in row] for row in rows[1:]])
    return rows[0][:6], numbers[:, :6], numbers[:, 6:13]


def seconds(stamp):
    return TYPES["builtin_interfaces/msg/Time"](sec=int(stamp), nanosec=round((stamp - int(stamp)) * 1e9))


def header(stamp, frame):
    return TYPES["std_msgs/msg/Header"](stamp=seconds(stamp), frame_id=frame)


def between(rows, at, rate, tremble, rng):
    """Values at times since the start: standing at each row, moving smoothly in between."""
    whole = STAND + MOVE
    times = np.arange(0, whole * len(rows) - MOVE, 1 / rate) + at
    index = np.minimum((times // whole).astype(int), len(rows) - 1)
    share = np.clip((times - index * whole - STAND) / MOVE, 0, 1)
    share = share * share * (3 - 2 * share)
    following = np.minimum(index + 1, len(rows) - 1)
    values = rows[index] + (rows[following] - rows[index]) * share[:, None]
    return times, values + rng.normal(0, 1, values.shape) * tremble


def message(kind, stamp, values):
    point = dict(zip("xyz", values[:3], strict=True))
    if kind == "geometry_msgs/msg/PointStamped":
        return TYPES[kind](header=header(stamp, "tracker"), point=TYPES["geometry_msgs/msg/Point"](**point))
    turn = values[3:] / np.linalg.norm(values[3:])
    turn = TYPES["geometry_msgs/msg/Quaternion"](**dict(zip("xyzw", turn, strict=True)))
    if kind == "geometry_msgs/msg/PoseStamped":
        pose = TYPES["geometry_msgs/msg/Pose"](position=TYPES["geometry_msgs/msg/Point"](**point), orientation=turn)
        return TYPES[kind](header=header(stamp, "tracker"), pose=pose)
    transform = TYPES["geometry_msgs/msg/Transform"](translation=TYPES["geometry_msgs/msg/Vector3"](**point), rotation=turn)
    stamped = TYPES["geometry_msgs/msg/TransformStamped"]
    whole = stamped(header=header(stamp, "tracker"), child_frame_id="ball", transform=transform)
    if kind == "geometry_msgs/msg/TransformStamped":
        return whole
    other = stamped(header=header(stamp, "map"), child_frame_id="tracker", transform=transform)
    return TYPES[kind](transforms=[other, whole])


def write(folder, measured, kind, plugin, mode=CompressionMode.NONE, tremble=0.0, topics=("/tracker/ball",), stale=False):
    """A bag; the target's messages come 30 ms late, and in another clock than the joints'."""
    names, joints, poses = measured
    rng = np.random.default_rng(3)
    joint_times, joint_values = between(joints, 0.0, 100, 1e-5 if tremble else 0.0, rng)
    times, values = between(poses, 0.0031, 60, np.r_[np.full(3, tremble), np.zeros(4)], rng)
    if stale:
        values = np.repeat(values[:1], len(values), axis=0) + rng.normal(0, 1e-5, values.shape)
    all_messages = []
    for time, value in zip(joint_times, joint_values, strict=True):
        # The joints in another order than the robot has them, with a gripper's among them.
        state = TYPES["sensor_msgs/msg/JointState"](
            header=header(START + time, ""), name=[*reversed(names), "finger"],
            position=np.r_[value[::-1], 0.01], velocity=np.zeros(0), effort=np.zeros(0),
        )
        all_messages.append((time + 0.002, "/joint_states", state))
    for time, value in zip(times, values, strict=True):
        all_messages += [(time + 0.032, topic, message(kind, START + AHEAD + time, value)) for topic in topics]
    all_messages.sort(key=lambda one: one[0])
    writer = Writer(folder, version=9, storage_plugin=plugin)
    if mode != CompressionMode.NONE:
        writer.set_compression(mode, CompressionFormat.ZSTD)
    with writer:
        connections = {}
        for time, topic, one in all_messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, one.__msgtype__, typestore=STORE)
            logged = round((START + time) * 1e9)
            writer.write(connections[topic], logged, STORE.serialize_cdr(one, one.__msgtype__))
    return folder


def stages(*arguments):
    found = run("calibrate", UR5E, *arguments, "--effects", "none", "--json")
    return json.loads(found.stdout), found.stderr


def is_the_same(one, other):
    """Whether two parts of reports say the same, as close as a last digit in which what they were made of differs lets them."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(is_the_same(one[key], other[key]) for key in one)
    if isinstance(one, list):
        return len(one) == len(other) and all(map(is_the_same, one, other))
    return one == (pytest.approx(other, rel=1e-9) if isinstance(other, float) else other)


KINDS = ["PoseStamped", "TransformStamped", "PointStamped", "TFMessage"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("plugin", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_a_bag_is_the_same_as_its_rows(tmp_path, measured, kind, plugin):
    package = "tf2_msgs" if kind == "TFMessage" else "geometry_msgs"
    bag = write(tmp_path / "bag", measured, f"{package}/msg/{kind}", plugin)
    chosen = ["--target-topic", "/tracker/ball:tracker/ball"] if kind == "TFMessage" else []
    report, told = stages("--data", bag, *chosen)
    names, joints, poses = measured
    columns = 3 if kind == "PointStamped" else 7
    # What a quaternion of a message is, is of length 1 to the last digit, which is rounded as the processor has it.
    poses = poses.copy()
    poses[:, 3:] /= np.linalg.norm(poses[:, 3:], axis=1)[:, None]
    file = tmp_path / "rows.csv"
    with open(file, "w", newline="") as opened:
        writer = csv.writer(opened)
        writer.writerow(["time", *names, *["x", "y", "z", "qx", "qy", "qz", "qw"][:columns]])
        whole = STAND + MOVE
        for index, row in enumerate(np.c_[joints, poses[:, :columns]].tolist()):
            writer.writerow([index * whole, *map(repr, row)])
    expected, _ = stages("--data", file)
    assert report["samples"]["train"] == len(joints) and "45 standstills" in told
    assert is_the_same(report["stages"], expected["stages"])
    assert is_the_same(report["parameters"], expected["parameters"])
    ahead = float(told.split("is ")[1].split(" s ahead")[0])
    print(f"the clock is found {1e3 * (ahead - AHEAD):.2f} ms off")
    assert abs(ahead - AHEAD) < 5e-3


def test_noise_comes_as_a_spread(tmp_path, measured):
    bag = write(tmp_path / "bag", measured, "geometry_msgs/msg/PointStamped", StoragePlugin.MCAP, tremble=5e-5)
    report, told = stages("--data", bag)
    spreads = [column for column in report["columns"] if column["column"].endswith(".std")]
    assert len(spreads) == 3
    ahead = float(told.split("is ")[1].split(" s ahead")[0])
    print(f"the clock is found {1e3 * (ahead - AHEAD):.2f} ms off")
    assert abs(ahead - AHEAD) < 10e-3


def test_chunks_may_be_compressed(tmp_path, measured):
    kind = "geometry_msgs/msg/PoseStamped"
    plain = write(tmp_path / "plain", measured, kind, StoragePlugin.MCAP)
    small = write(tmp_path / "small", measured, kind, StoragePlugin.MCAP, CompressionMode.STORAGE)
    sizes = [next(folder.glob("*.mcap")).stat().st_size for folder in (plain, small)]
    assert sizes[1] < 0.8 * sizes[0]
    reports = [stages("--data", next(folder.glob("*.mcap")))[0] for folder in (plain, small)]
    assert reports[0]["stages"] == reports[1]["stages"]


def test_what_a_bag_cannot_say_is_refused(tmp_path, measured):
    names, joints, poses = measured
    few = (names, joints[:8], poses[:8])
    kind, plugin = "geometry_msgs/msg/PointStamped", StoragePlugin.MCAP

    def said(bag, *arguments):
        found = run("calibrate", UR5E, "--data", bag, *arguments, code=2)
        assert "panicked" not in found.stderr
        return found.stderr

    two = write(tmp_path / "two", few, kind, plugin, topics=("/a", "/b"))
    assert "several topics may be the target: /a, /b; choose one with --target-topic" in said(two)
    assert "--target-topic /c: there is no such topic of the target; there are /a, /b" in said(two, "--target-topic", "/c")
    other = write(tmp_path / "other", ([f"j{k}" for k in range(6)], *few[1:]), kind, plugin)
    assert "no sensor_msgs/JointState names all of the joints shoulder_pan_joint" in said(other)
    still = write(tmp_path / "still", few, kind, plugin, stale=True)
    assert "/tracker/ball does not move when the joints of /joint_states do" in said(still)
    (tmp_path / "empty").mkdir()
    (tmp_path / "broken.mcap").write_bytes(next(two.glob("*.mcap")).read_bytes()[:3000])
    (tmp_path / "broken.db3").write_bytes(b"no database" * 100)
    for name in ("broken.mcap", "broken.db3"):
        assert "this bag cannot be read" in said(tmp_path / name)
    whole = write(tmp_path / "whole", few, kind, StoragePlugin.SQLITE3, CompressionMode.FILE)
    (packed,) = [file for file in whole.iterdir() if file.suffix == ".zstd"]
    assert "the whole file is compressed; decompress it first: zstd -d" in said(packed) and said(whole) == said(packed)
    each = write(tmp_path / "each", few, kind, StoragePlugin.SQLITE3, CompressionMode.MESSAGE)
    assert "its messages are compressed; rewrite the bag without compression" in said(each)
