"""Robots for the packages beside this one."""

from __future__ import annotations

import io
from importlib import import_module
from typing import TYPE_CHECKING, Any

from denavit.errors import ArgumentError

if TYPE_CHECKING:
    from denavit.robot import Robot
    from denavit.table import Table


def _urdf(robot: Robot) -> str:
    if robot.urdf is None:
        raise ArgumentError(f"{robot.file} is no URDF; robot.canonical() makes one")
    return robot.urdf


def to_yourdfpy(robot: Robot) -> Any:
    """A `yourdfpy.URDF`, without meshes."""
    yourdfpy = import_module("yourdfpy")
    text = io.BytesIO(_urdf(robot).encode())
    return yourdfpy.URDF.load(text, build_scene_graph=True, load_meshes=False)


def to_pinocchio(robot: Robot) -> Any:
    """A `pinocchio.Model` of the whole tree."""
    pinocchio = import_module("pinocchio")
    return pinocchio.buildModelFromXML(_urdf(robot))


def to_roboticstoolbox(table: Table) -> Any:
    """A `roboticstoolbox.DHRobot` of the table's rows; base and tool rows as its base and tool."""
    rtb = import_module("roboticstoolbox")
    spatialmath = import_module("spatialmath")
    if table.convention not in ("distal", "proximal"):
        raise ArgumentError(f"a DHRobot has no {table.convention} rows; take distal or proximal")
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
