#!/usr/bin/env python3
"""Vocabulary of MJCF and SDF for completion in an editor, from MuJoCo's schema and from sdformat's specification.

    python3 tests/oracle/vocabulary.py mjcf > crates/lsp/src/vocabulary/mjcf.txt
    python3 tests/oracle/vocabulary.py sdf  > crates/lsp/src/vocabulary/sdf.txt    (Debian's package sdformat-sdf, or its folder of 1.9)

A line is an element: indentation by its depth, its tag, then its attributes; `=a|b` after a name lists its allowed values, after
the tag those of the text. `@tag` is the element of that name at the left margin.
"""

import re
import sys
import xml.etree.ElementTree as ET
from pathlib import Path

SDF = Path("/usr/share/sdformat12/1.9")
BOOL = ["true", "false"]
AUTO = ["true", "false", "auto"]

# Values, which the schema does not list. MuJoCo accepts each: test_vocabulary.py.
KEYWORDS = {
    ("compiler", "angle"): ["degree", "radian"],
    ("compiler", "inertiafromgeom"): AUTO,
    ("compiler", "coordinate"): ["local"],
    ("option", "integrator"): ["Euler", "RK4", "implicit", "implicitfast"],
    ("option", "cone"): ["pyramidal", "elliptic"],
    ("option", "jacobian"): ["dense", "sparse", "auto"],
    ("option", "solver"): ["PGS", "CG", "Newton"],
    ("joint", "type"): ["hinge", "slide", "ball", "free"],
    ("geom", "type"): ["plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf"],
    ("geom", "fluidshape"): ["none", "ellipsoid"],
    ("site", "type"): ["sphere", "capsule", "ellipsoid", "cylinder", "box"],
    ("camera", "mode"): ["fixed", "track", "trackcom", "targetbody", "targetbodycom"],
    ("camera", "projection"): ["perspective", "orthographic"],
    ("light", "mode"): ["fixed", "track", "trackcom", "targetbody", "targetbodycom"],
    ("light", "type"): ["spot", "directional", "point", "image"],
    ("texture", "type"): ["2d", "cube", "skybox"],
    ("texture", "builtin"): ["none", "gradient", "checker", "flat"],
    ("texture", "mark"): ["none", "edge", "cross", "random"],
    ("mesh", "inertia"): ["convex", "exact", "legacy", "shell"],
    ("general", "dyntype"): ["none", "integrator", "filter", "filterexact", "muscle", "user"],
    ("general", "gaintype"): ["fixed", "affine", "muscle", "user"],
    ("general", "biastype"): ["none", "affine", "muscle", "user"],
}
LIMITED = ["limited", "ctrllimited", "forcelimited", "actlimited", "actuatorfrclimited"]
SWITCHES = {
    "compiler": "autolimits balanceinertia fitaabb discardvisual usethread fusestatic alignfree strippath saveinertial".split(),
    "body": ["mocap"],
    "joint": ["actuatorgravcomp"],
    "light": ["castshadow", "active"],
    "connect": ["active"],
    "weld": ["active"],
}
# Elements missing in the schema: MuJoCo handles them before it applies the schema.
FRAME = "name childclass pos quat axisangle euler xyaxes zaxis".split()
REPLICATE = "count offset euler sep".split()
SHARED = ["geom", "site", "camera", "light", "plugin", "attach", "flexcomp"]


def values(tag, attribute):
    if attribute in LIMITED:
        return AUTO
    if attribute in SWITCHES.get(tag, []):
        return BOOL
    return KEYWORDS.get((tag, attribute))


def mjcf():
    import mujoco

    rows = []
    for line in mujoco.mj_printSchema(False, False).splitlines():
        found = re.match(r"^( *)(\S+) \((.)\)(.*)$", line)
        if found:
            rows.append((len(found[1]) // 3, found[2], found[4].split()))
        elif line.strip():
            rows[-1][2].extend(line.split())

    def children(at):
        below, depth = [], rows[at][0]
        for k in range(at + 1, len(rows)):
            if rows[k][0] <= depth:
                break
            if rows[k][0] == depth + 1:
                below.append(k)
        return below

    out = []

    def emit(depth, tag, attributes):
        words = [name + ("=" + "|".join(values(tag, name)) if values(tag, name) else "") for name in attributes]
        out.append(" ".join([" " * depth + tag, *words]))

    def write(at, depth):
        _, tag, attributes = rows[at]
        emit(depth, tag, attributes)
        for k in children(at):
            if rows[k][1] == "default":
                out.append(" " * (depth + 1) + "@default")
            elif rows[k][1] == "(world)body":
                out.append(" " * (depth + 1) + "@worldbody")
            else:
                write(k, depth + 1)
        if tag == "mujoco":
            out.append(" include file")

    named = {tag: k for k, (_, tag, _) in enumerate(rows) if rows[k][0] == 1}
    write(0, 0)
    emit(0, "default", rows[named["default"]][2])
    for k in children(named["default"]):
        write(k, 1)
    out.append(" @default")
    body = named["(world)body"]
    of_body = {rows[k][1]: k for k in children(body)}
    more = ["body", "frame", "replicate"]
    refer = lambda tags: out.extend(f" @{tag}" for tag in tags)  # noqa: E731
    emit(0, "body", rows[body][2])
    refer([*of_body, *more])
    for tag, attributes in (("worldbody", []), ("frame", FRAME), ("replicate", REPLICATE)):
        emit(0, tag, attributes)
        own = [one for one in of_body if one in SHARED or (tag == "frame" and one in ("joint", "freejoint"))]
        refer([*own, *more])
    for k in of_body.values():
        write(k, 0)
    return out


SDF_VALUES = {
    ("joint", "type"): ["revolute", "prismatic", "fixed", "continuous", "ball", "universal", "screw", "gearbox", "revolute2"],
    ("pose", "rotation_format"): ["euler_rpy", "quat_xyzw"],
    ("light", "type"): ["point", "directional", "spot"],
    # Those that are not deprecated.
    ("sensor", "type"): """air_pressure altimeter boundingbox_camera camera contact custom depth_camera force_torque gpu_lidar imu lidar
        logical_camera magnetometer multicamera navsat rfid rfidtag rgbd_camera segmentation_camera sonar thermal_camera
        wireless_receiver wireless_transmitter""".split(),
}
# Of SDF 1.11, which this project reads.
LATER = {
    "axis": [" mimic joint axis", "  multiplier", "  offset", "  reference"],
    "axis2": [" mimic joint axis", "  multiplier", "  offset", "  reference"],
    "joint": [" screw_thread_pitch"],
}
# Recorded states, and elements that a description of a robot does not have.
WITHOUT = {"state.sdf", "model_state.sdf", "link_state.sdf", "light_state.sdf", "gui.sdf", "actor.sdf", "population.sdf", "road.sdf"}


def sdf():
    def row(element, depth):
        tag = element.get("name")
        attributes = []
        for attribute in element.findall("attribute"):
            name = attribute.get("name")
            known = BOOL if attribute.get("type") == "bool" else SDF_VALUES.get((tag, name))
            if not name.startswith("xmlns"):
                attributes.append(name + ("=" + "|".join(known) if known else ""))
        text = "=" + "|".join(BOOL) if element.get("type") == "bool" else ""
        out.append(" ".join([" " * depth + tag + text, *attributes]))
        seen = set()
        for child in element:
            name = child.get("filename") if child.tag == "include" else child.get("name")
            if child.tag not in ("include", "element") or name is None or name in WITHOUT or child.get("copy_data") == "true":
                continue
            if child.tag == "include":
                # Debian's package lacks a file that the specification includes.
                if not (SDF / name).is_file():
                    out.append(" " * (depth + 1) + name.removesuffix(".sdf"))
                    continue
                own = ET.parse(SDF / name).getroot().get("name")
                if own not in done:
                    done.add(own)
                    waiting.append(name)
                name = own
                line = " " * (depth + 1) + "@" + own
                if own not in seen:
                    out.append(line)
            elif child.get("ref"):
                out.append(" " * (depth + 1) + "@" + child.get("ref"))
            elif name not in seen:
                row(child, depth + 1)
            seen.add(name)
        out.extend(" " * depth + line for line in LATER.get(tag, []))
        if tag in ("model", "world") and "model" not in seen:
            out.append(" " * (depth + 1) + "@model")

    out, done, waiting = [], {"sdf"}, ["root.sdf"]
    while waiting:
        row(ET.parse(SDF / waiting.pop(0)).getroot(), 0)
    return out


if __name__ == "__main__":
    if len(sys.argv) > 2:
        SDF = Path(sys.argv[2])
    source = {"mjcf": "# MuJoCo 4.0.0, mj_printSchema.", "sdf": "# SDF 1.9, of sdformat 12.3.0."}[sys.argv[1]]
    print(f"{source} Made by tests/oracle/vocabulary.py.")
    print("\n".join({"mjcf": mjcf, "sdf": sdf}[sys.argv[1]]()))
