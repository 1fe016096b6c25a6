"""Edits held against yourdfpy: frames of the edited file where the operation says, by a reader that is not ours.

Every robot of robots/ and one in eight of the other files; each operation is done by the program, and both files are read by
yourdfpy, at values that move every joint. What is refused has a reason; what is done is right.
"""

import subprocess
import warnings

import numpy as np
import pytest
import yourdfpy

import corpus
from built import denavit
from kinematics import distance

ACTUATED = ("revolute", "continuous", "prismatic")
EVERY = 8
METRES = 1e-9
FILES = [path for source, path in corpus.files() if source == "robots"]
FILES += [path for source, path in corpus.files() if source != "robots"][::EVERY]
MIRROR = np.diag([1.0, -1.0, 1.0, 1.0])
DOUBLE = np.diag([2.0, 2.0, 2.0, 1.0])


def load(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=True, load_collision_meshes=False)


def frames(robot, values, links, base):
    """base_from_link of each link; joints that are not in `values` stand at 0, mimic joints follow."""
    robot.update_cfg({joint.name: values.get(joint.name, 0.0) for joint in robot.actuated_joints})
    return {link: robot.get_transform(link, base) for link in links}


def edit(path, words, to):
    run = subprocess.run([denavit(), "edit", path, *words, "-o", to], capture_output=True, text=True)
    assert run.returncode in (0, 2), run.stderr
    if run.returncode == 2:
        assert run.stderr.startswith("error: ") and not to.exists(), run.stderr
        assert "the result would not be" not in run.stderr, run.stderr
        return run.stderr
    return None


def asked(robot):
    """[(words, base of the comparison, new value of a joint from its name and old one, space, names of links)]"""
    root = robot.base_link
    moving = [joint.name for joint in robot.actuated_joints if joint.type in ACTUATED]
    children = {joint.parent for joint in robot.robot.joints}
    leaves = [link.name for link in robot.robot.links if link.name not in children]
    result = [(["prefix", "p_"], root, lambda name, value: (f"p_{name}", value), np.eye(4), lambda link: f"p_{link}")]
    keep = lambda link: link
    if moving:
        joint = moving[len(moving) // 2]
        flipped = lambda name, value: (name, -value if name == joint else value)
        zeroed = lambda name, value: (name, value - 0.25 if name == joint else value)
        result.append((["flip", joint], root, flipped, np.eye(4), keep))
        result.append((["zero", f"{joint}=0.25"], root, zeroed, np.eye(4), keep))
    named = lambda name, value: (name, value)
    if leaves:
        result.append((["reroot", leaves[-1]], leaves[-1], named, np.eye(4), keep))
    slides = {joint.name for joint in robot.actuated_joints if joint.type == "prismatic"}
    doubled = lambda name, value: (name, 2 * value if name in slides else value)
    result.append((["scale", "2"], root, doubled, DOUBLE, keep))
    result.append((["mirror", "xz"], root, named, MIRROR, keep))
    result.append((["merge"], root, named, np.eye(4), keep))
    return result


def moved_frames(before, path, values, folder):
    """Edits that move link frames: every link's motion, seen from the root's old frame, stays. Counts of done and refused."""
    root, counts = before.base_link, [0, 0]
    links = [link.name for link in before.robot.links]
    zero = frames(before, {}, links, root)
    moved = frames(before, values, links, root)
    for words in (["canonical"], ["recentre"]):
        to = folder / f"{words[0]}.urdf"
        if edit(path, words, to):
            counts[1] += 1
            continue
        after = load(to)
        # The root's new frame in its old one: at its centre of mass, where it has one.
        shift = np.eye(4)
        inertial = before.link_map[root].inertial
        if words == ["recentre"] and inertial is not None and inertial.mass and inertial.origin is not None:
            shift[:3, 3] = inertial.origin[:3, 3]
        back = np.linalg.inv(shift)
        new_zero, new_moved = frames(after, {}, links, root), frames(after, values, links, root)
        size = max(1.0, max(np.linalg.norm(frame[:3, 3]) for frame in moved.values()))
        for link in links:
            expected = moved[link] @ np.linalg.inv(zero[link])
            found = shift @ new_moved[link] @ np.linalg.inv(new_zero[link]) @ back
            metres, radians = distance(expected, found)
            assert metres < METRES * size and radians < METRES, (words, link, metres, radians)
        counts[0] += 1
    return counts


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_frames_are_where_the_operation_says(path, tmp_path):
    try:
        before = load(path)
    except Exception as error:
        pytest.skip(f"skipped, because yourdfpy does not read it: {error}")
    if any(joint.type not in (*ACTUATED, "fixed") for joint in before.robot.joints):
        pytest.skip("skipped, because yourdfpy places no floating, planar or unknown joints")
    if not all(joint.name for joint in before.robot.joints):
        pytest.skip("skipped, because joints have no names")
    spread = np.random.default_rng(1)
    values = {joint.name: spread.uniform(-1, 1) for joint in before.actuated_joints}
    done, refused = moved_frames(before, path, values, tmp_path)
    for index, (words, base, joint_map, space, name) in enumerate(asked(before)):
        to = tmp_path / f"{index}.urdf"
        if edit(path, words, to):
            refused += 1
            continue
        after = load(to)
        links = [link.name for link in before.robot.links if name(link.name) in after.link_map]
        assert links
        new = dict(joint_map(joint, value) for joint, value in values.items())
        old_frames = frames(before, values, links, base)
        new_frames = frames(after, new, [name(link) for link in links], name(base))
        size = max(1.0, max(np.linalg.norm(frame[:3, 3]) for frame in old_frames.values()))
        for link in links:
            expected = space @ old_frames[link] @ np.linalg.inv(space)
            metres, radians = distance(expected, new_frames[name(link)])
            assert metres < METRES * size and radians < METRES, (words, link, metres, radians)
        done += 1
    assert done or refused
    print(f"{path.name}: {done} done, {refused} refused")
