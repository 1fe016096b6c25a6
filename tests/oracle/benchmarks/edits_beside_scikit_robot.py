"""Edits of the same files by denavit and by scikit-robot: right, wrong, refused, seconds. Prints a Markdown table.

    python tests/oracle/benchmarks/edits_beside_scikit_robot.py [EVERY]

yourdfpy, which belongs to neither, decides what is right: seen from the link that stays the base, each link's frame may differ from
its old pose only by a constant step, and its first visual and its centre of mass keep their positions, at four sets of joint
values. Seconds are those of a whole run on one core: the program for denavit, only the function for scikit-robot.
"""

import contextlib
import io
import logging
import subprocess
import sys
import tempfile
import time
import warnings
from importlib import import_module
from pathlib import Path

import numpy as np
import yourdfpy

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
import corpus  # noqa: E402
from built import denavit  # noqa: E402
from kinematics import distance  # noqa: E402

ACTUATED = ("revolute", "continuous", "prismatic")
SAME = 1e-6


def load(path):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return yourdfpy.URDF.load(str(path), load_meshes=False, build_scene_graph=True, load_collision_meshes=False)


def parts(robot, link):
    """link_from_part of the first visual and of the centre of mass, if there are any."""
    found = {}
    of = robot.link_map[link]
    if of.visuals:
        found["visual"] = np.eye(4) if of.visuals[0].origin is None else of.visuals[0].origin
    if of.inertial is not None and of.inertial.mass:
        origin = np.eye(4) if of.inertial.origin is None else of.inertial.origin
        found["centre"] = origin[:, 3]
    return found


def right(before, after, base, new_value, merged):
    """Whether the second file moves like the first, up to constant steps of the frames."""
    spread = np.random.default_rng(1)
    links = [link.name for link in before.robot.links if link.name in after.link_map]
    steps = {}
    for _ in range(4):
        values = {joint.name: spread.uniform(-1, 1) for joint in before.actuated_joints}
        missing = set(values) - {joint.name for joint in after.actuated_joints}
        if missing:
            return False
        before.update_cfg(values)
        after.update_cfg({joint.name: new_value(joint.name, values.get(joint.name, 0.0)) for joint in after.actuated_joints})
        old_base = before.get_transform(base, before.base_link)
        new_base = after.get_transform(base, after.base_link)
        first = steps.setdefault("base", np.eye(4))
        for link in links:
            old = np.linalg.inv(old_base) @ before.get_transform(link, before.base_link)
            new = np.linalg.inv(new_base @ first) @ after.get_transform(link, after.base_link)
            step = np.linalg.inv(old) @ new
            if max(distance(steps.setdefault(link, step), step)) > SAME:
                return False
            if merged:
                continue
            here, there = parts(before, link), parts(after, link)
            for name in here.keys() & there.keys():
                a, b = old @ here[name], new @ there[name]
                if np.abs(a - b).max() > SAME:
                    return False
            if here.keys() != there.keys():
                return False
    return True


def ours(words, path, to):
    run = subprocess.run([denavit(), "edit", path, *words, "-o", to], capture_output=True, text=True)
    if run.returncode:
        raise RuntimeError(run.stderr)


def theirs(name, word, path, to):
    # The package gives functions the names of their modules.
    modules = ("flip_axis", "merge_fixed_links", "xml_root_link_changer")
    flip_axis, merge_fixed_links, xml_root_link_changer = (import_module(f"skrobot.urdf.{module}") for module in modules)

    if name == "flip":
        if not flip_axis.flip_joint_axis_file(str(path), word, str(to)):
            raise RuntimeError("not flipped")
    elif name == "reroot":
        xml_root_link_changer.change_urdf_root_link(str(path), word, str(to))
    else:
        merge_fixed_links.merge_fixed_links_file(str(path), str(to), keep_frames=False)


def asked(robot):
    moving = [joint.name for joint in robot.actuated_joints if joint.type in ACTUATED]
    carried = {joint.parent for joint in robot.robot.joints}
    leaves = [link.name for link in robot.robot.links if link.name not in carried]
    if moving:
        yield "flip", moving[len(moving) // 2]
    if leaves:
        yield "reroot", leaves[-1]
    yield "merge", None


def main():
    every = int(sys.argv[1]) if len(sys.argv) > 1 else 1
    logging.disable(logging.CRITICAL)
    counts = {}
    wrong = []
    files = 0
    for _, path in corpus.files()[::every]:
        try:
            before = load(path)
        except Exception:
            continue
        if any(joint.type not in (*ACTUATED, "fixed") for joint in before.robot.joints):
            continue
        files += 1
        for name, word in asked(before):
            for tool in ("denavit", "scikit-robot"):
                count = counts.setdefault((name, tool), {"right": 0, "wrong": 0, "refused": 0, "seconds": 0.0})
                with tempfile.TemporaryDirectory() as folder:
                    to = Path(folder) / "edited.urdf"
                    start = time.perf_counter()
                    try:
                        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
                            warnings.simplefilter("ignore")
                            if tool == "denavit":
                                ours([name] if word is None else [name, word], path, to)
                            else:
                                theirs(name, word, path, to)
                    except Exception as error:
                        count["refused"] += 1
                        wrong.append(f"{tool} {name} {path.name}: refused: {str(error).strip().splitlines()[:1]}")
                        continue
                    finally:
                        count["seconds"] += time.perf_counter() - start
                    try:
                        base = word if name == "reroot" else before.base_link
                        value = lambda joint, value: -value if (name, joint) == ("flip", word) else value
                        is_right = right(before, load(to), base, value, name == "merge")
                    except Exception as error:
                        is_right = False
                        wrong.append(f"{tool} {name} {path.name}: cannot be read again: {error}")
                    count["right" if is_right else "wrong"] += 1
                    if not is_right:
                        wrong.append(f"{tool} {name} {path.name}: wrong")
    print(f"{files} files\n\n| operation | program | right | wrong | refused | seconds |\n|---|---|---|---|---|---|")
    for (name, tool), count in sorted(counts.items()):
        print(f"| {name} | {tool} | {count['right']} | {count['wrong']} | {count['refused']} | {count['seconds']:.1f} |")
    print("\n".join(wrong), file=sys.stderr)


if __name__ == "__main__":
    main()
