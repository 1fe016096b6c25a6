"""Robots for other packages."""

from __future__ import annotations

import io
import json
from importlib import import_module
from typing import TYPE_CHECKING, Any
from xml.sax.saxutils import quoteattr

import numpy as np

from denavit.errors import ArgumentError, ExportError

if TYPE_CHECKING:
    from denavit.chain import Array
    from denavit.robot import Robot
    from denavit.table import Table

_SAME = 1e-9
"""Poses of the same robot in two packages differ by less: m, and entries of rotations."""

_UNLIMITED = 1e6
"""Limits beyond this mean no limit, rad or m."""


def _urdf(robot: Robot) -> str:
    if robot.urdf is None:
        raise ArgumentError(f"{robot.file} is not a URDF; robot.canonical() makes one")
    return robot.urdf


def to_yourdfpy(robot: Robot) -> Any:
    """A `yourdfpy.URDF`, without meshes."""
    yourdfpy = import_module("yourdfpy")
    text = io.BytesIO(_urdf(robot).encode())
    return yourdfpy.URDF.load(text, build_scene_graph=True, load_meshes=False)


def to_pinocchio(robot: Robot) -> Any:
    """A `pinocchio.Model` of the whole tree; a joint that mimics another follows it."""
    pinocchio = import_module("pinocchio")
    text = _urdf(robot)
    drivers, followers = robot._native.couplings()
    if not followers:
        return pinocchio.buildModelFromXML(text)
    try:
        model = pinocchio.buildModelFromXML(text, mimic=True)
    except Exception as error:
        raise ExportError(
            f"{robot.file}: joint {followers[0]!r} mimics another, and pinocchio {pinocchio.__version__} cannot couple the two "
            f"({error}); compute with the chain of denavit"
        ) from error
    free = [name for name in followers if model.existJointName(name) and model.joints[model.getJointId(name)].nv != 0]
    if free:
        raise ExportError(
            f"{robot.file}: joint {free[0]!r} mimics another, and would be free in pinocchio; compute with the chain of denavit"
        )
    for driver in drivers:
        _follows(pinocchio, model, robot, driver)
    return model


def _follows(pinocchio: Any, model: Any, robot: Robot, driver: str) -> None:
    """Refuses a model in which the links move differently from here when a driving joint moves."""
    if not model.existJointName(driver):
        return
    data, q = model.createData(), pinocchio.neutral(model)
    joint = model.joints[model.getJointId(driver)]
    value = 0.1
    if joint.nq == 1:
        q[joint.idx_q] = value
    elif joint.nq == 2:  # the cosine and sine of a joint without end
        q[joint.idx_q : joint.idx_q + 2] = [np.cos(value), np.sin(value)]
    pinocchio.framesForwardKinematics(model, data, q)
    for listing in robot.chains:
        chain = robot.chain(listing.base, listing.tip, exact=True)
        if driver not in chain.joints or not (model.existFrame(chain.base) and model.existFrame(chain.tip)):
            continue
        frames = [data.oMf[model.getFrameId(name)].homogeneous for name in (chain.base, chain.tip)]
        theirs = np.linalg.inv(frames[0]) @ frames[1]
        own = chain.fk([value if name == driver else 0.0 for name in chain.joints])
        if np.abs(theirs - own).max() > _SAME * max(1.0, chain.size):
            raise ExportError(
                f"{robot.file}: what follows joint {driver!r} moves differently in pinocchio; compute with the chain of denavit"
            )


def of_roboticstoolbox(robot: Any) -> str:
    """Screw axes of a robot of roboticstoolbox that is one chain, as JSON."""
    if not hasattr(robot, "ets") or not hasattr(robot, "fkine"):
        raise ArgumentError(f"a {type(robot).__name__} of roboticstoolbox is not a robot; give a DHRobot or ERobot of one chain")
    try:
        steps = list(robot.ets())
    except Exception as error:
        raise ArgumentError(f"{robot.name}: it is not a single chain ({error}); give its original URDF") from error
    pose = np.eye(4)
    joints: list[dict[str, Any]] = []
    coordinates: list[dict[str, Any]] = []
    limits = getattr(robot, "qlim", None)
    for step in steps:
        if not step.isjoint:
            pose = pose @ np.asarray(step.A())
            continue
        kind, name = str(getattr(step, "kind", None) or step.axis), f"joint_{len(joints) + 1}"
        direction = pose[:3, "xyz".index(kind[-1])] * (-1.0 if step.isflip else 1.0)
        turns = kind.startswith("R")
        twist = [*direction, *np.cross(pose[:3, 3], direction)] if turns else [0.0, 0.0, 0.0, *direction]
        joints.append(
            {"name": name, "coordinate": name, "kind": "revolute" if turns else "prismatic", "twist": [*map(float, twist)]}
        )
        coordinates.append({"name": name, "quantity": "angle" if turns else "length", "limits": _ends(limits, len(joints) - 1)})
    found = {
        "schema": "denavit.poe/1", "robot": str(robot.name or ""), "base": "base", "tip": "tool",
        "units": {"length": "m", "angle": "rad"}, "coordinates": coordinates, "joints": joints, "home": pose.tolist(),
    }  # fmt: skip
    text = json.dumps(found)
    _agree(text, robot, len(joints))
    return text


def _ends(limits: Any, joint: int) -> dict[str, float] | None:
    if limits is None:
        return None
    lower, upper = (float(end) for end in np.asarray(limits, dtype=np.float64)[:, joint])
    return {"lower": lower, "upper": upper} if np.isfinite([lower, upper]).all() and lower < upper else None


def _agree(text: str, robot: Any, count: int) -> None:
    from denavit.robot import load

    chain = load(text).chain(exact=True)
    for q in (np.zeros(count), np.linspace(0.1, 0.5, count)):
        if np.abs(chain.fk(q) - np.asarray(robot.fkine(q).A)).max() > _SAME * max(1.0, chain.size):
            raise ArgumentError(f"{robot.name}: its forward kinematics do not match its links; give its original URDF or table")


def of_pinocchio(model: Any) -> str:
    """A URDF with the kinematics of a `pinocchio.Model`: its joints, limits and frames, no masses and no shapes."""
    pinocchio = import_module("pinocchio")
    lines = [f"<robot name={quoteattr(str(model.name) or 'robot')}>"]
    frames = [frame for frame in model.frames if frame.name != "universe"]
    names = [str(name) for name in model.names]
    moving = range(1, model.njoints)
    # A body at its joint's own place is the joint's link.
    own = {0: "universe"}
    for frame in frames:
        if frame.type == pinocchio.FrameType.BODY and frame.placement.isIdentity(0.0) and frame.parentJoint not in own:
            own[frame.parentJoint] = str(frame.name)
    root = next(
        (f for f in frames if f.type == pinocchio.FrameType.BODY and f.parentJoint == 0 and f.placement.isIdentity(0.0)), None
    )
    if root is not None:
        own[0] = str(root.name)
    for joint in moving:
        own.setdefault(joint, f"{names[joint]}_link")
    links = list(own.values())
    for joint in moving:
        kind, axis = _pinocchio_joint(pinocchio, model, joint)
        at = model.joints[joint].idx_q
        lower, upper = float(model.lowerPositionLimit[at]), float(model.upperPositionLimit[at])
        limit = f'<limit lower="{lower!r}" upper="{upper!r}" effort="0" velocity="0"/>'
        if kind == "continuous" or not np.isfinite([lower, upper]).all() or max(abs(lower), abs(upper)) > _UNLIMITED:
            kind, limit = ("continuous" if kind == "revolute" else kind), ""
        lines.append(
            f"<joint name={quoteattr(names[joint])} type={quoteattr(kind)}><parent link={quoteattr(own[model.parents[joint]])}/>"
            f"<child link={quoteattr(own[joint])}/>{_origin(model.jointPlacements[joint])}"
            f'<axis xyz="{" ".join(repr(float(value)) for value in axis)}"/>{limit}</joint>'
        )
    for frame in frames:
        if frame.type in (pinocchio.FrameType.BODY, pinocchio.FrameType.OP_FRAME) and str(frame.name) not in links:
            links.append(str(frame.name))
            lines.append(
                f'<joint name={quoteattr(f"{frame.name}_fixed")} type="fixed"><parent link={quoteattr(own[frame.parentJoint])}/>'
                f"<child link={quoteattr(str(frame.name))}/>{_origin(frame.placement)}</joint>"
            )
    lines[1:1] = [f"<link name={quoteattr(name)}/>" for name in links]
    return "\n".join([*lines, "</robot>"])


def _origin(placement: Any) -> str:
    from denavit._denavit import rpy

    words = [
        " ".join(repr(float(value)) for value in values) for values in (placement.translation, rpy(np.array(placement.rotation)))
    ]
    return f'<origin xyz="{words[0]}" rpy="{words[1]}"/>'


def _pinocchio_joint(pinocchio: Any, model: Any, joint: int) -> tuple[str, Array]:
    """URDF type and axis."""
    found = model.joints[joint]
    kind = str(found.shortname())
    if "Mimic" in kind:
        raise ArgumentError(f"{model.name}: joint {model.names[joint]!r} follows another; give the model's original URDF")
    if found.nv != 1 or "Helical" in kind or "Composite" in kind:
        raise ArgumentError(
            f"{model.name}: joint {model.names[joint]!r} is a {kind}, which is neither revolute nor prismatic; give its URDF"
        )
    # The motion of the joint at its first unit: angular part of a turn, linear part of a slide.
    data = model.createData()
    pinocchio.computeJointJacobians(model, data, pinocchio.neutral(model))
    column = pinocchio.getJointJacobian(model, data, joint, pinocchio.ReferenceFrame.LOCAL)[:, found.idx_v]
    slides = bool(np.abs(column[:3]).max() > 0.5 * np.abs(column).max())
    axis = np.asarray(column[:3] if slides else column[3:], dtype=np.float64)
    return "prismatic" if slides else "continuous" if found.nq == 2 else "revolute", axis


def to_roboticstoolbox(table: Table) -> Any:
    """A `roboticstoolbox.DHRobot` of the table's rows; base and tool rows as its base and tool."""
    rtb = import_module("roboticstoolbox")
    spatialmath = import_module("spatialmath")
    if table.convention not in ("distal", "proximal"):
        raise ArgumentError(f"a DHRobot has no {table.convention} rows; use distal or proximal")
    modified = table.convention == "proximal"
    first, *rows, last = table.rows
    entries = table.to_dict()
    coordinates = {entry["name"]: entry for entry in entries["coordinates"]}
    links = []
    for row, joint in zip(rows, entries["joints"], strict=True):
        if joint["kind"] == "helical" or abs(joint["scale"]) != 1.0 or joint["name"] != joint["coordinate"]:
            raise ArgumentError(f"a DHRobot has no helical, scaled or following joints; {joint['name']} is one")
        kind = ("Prismatic" if joint["kind"] == "prismatic" else "Revolute") + ("MDH" if modified else "DH")
        fixed = {"alpha": row.alpha, "a": row.a}
        fixed |= {"theta": row.theta} if joint["kind"] == "prismatic" else {"d": row.d}
        offset = row.d if joint["kind"] == "prismatic" else row.theta
        limits = coordinates[joint["coordinate"]].get("limits")
        qlim = [limits["lower"], limits["upper"]] if limits else None
        flip = joint["scale"] < 0
        links.append(getattr(rtb, kind)(**fixed, offset=offset, qlim=qlim, flip=flip))

    def pose(row: Any) -> Any:
        turned = spatialmath.SE3.Rz(row.theta or 0.0) * spatialmath.SE3.Tz(row.d or 0.0)
        crossed = spatialmath.SE3.Rx(row.alpha or 0.0) * spatialmath.SE3.Tx(row.a or 0.0)
        return crossed * turned if modified else turned * crossed

    return rtb.DHRobot(links, name=table.robot, base=pose(first), tool=pose(last))
