"""Batches of forward kinematics and Jacobians beside the packages that are installed; prints a Markdown table.

target/python/venv/bin/python python/benches/speed.py robots/universal_robots/ur5e.urdf
"""

from __future__ import annotations

import platform
import sys
import time
from collections.abc import Callable, Iterator
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

import denavit as dn

COUNT = 100_000
"""Configurations of a batch; packages without batches are timed on `FEW` of them."""
FEW = 2_000
REPEATS = 7


def best(work: Callable[[], object]) -> float:
    """Shortest of some runs, s."""
    times = []
    for _ in range(REPEATS):
        started = time.perf_counter()
        work()
        times.append(time.perf_counter() - started)
    return min(times)


def own(path: str) -> Iterator[tuple[str, str, float]]:
    """Time this package."""
    chain = dn.load(path).chain()
    q = chain.sample(COUNT)
    poses, tips, jacobians = np.empty((COUNT, 4, 4)), np.empty((COUNT, 3)), np.empty((COUNT, 6, q.shape[1]))
    name = f"denavit {dn.__version__}"
    yield name, "fk, batch into out", best(lambda: chain.fk(q, out=poses)) / COUNT
    yield name, "fk, batch, all cores", best(lambda: chain.fk(q, out=poses, threads=0)) / COUNT
    yield name, "tips, batch into out", best(lambda: chain.tips(q, out=tips)) / COUNT
    yield name, "jacobian, batch into out", best(lambda: chain.jacobian(q, out=jacobians)) / COUNT
    one, pose = q[0].copy(), np.empty((4, 4))
    yield name, "fk, one call each", best(lambda: [chain.fk(one, out=pose) for _ in range(FEW)]) / FEW


def pinocchio(path: str) -> Iterator[tuple[str, str, float]]:
    """Pinocchio, one configuration after the other."""
    pin: Any = import_module("pinocchio")
    model = pin.buildModelFromUrdf(path)
    data, tip = model.createData(), model.nframes - 1
    q = dn.load(path).chain().sample(FEW)

    def poses() -> None:
        for row in q:
            pin.framesForwardKinematics(model, data, row)

    def jacobians() -> None:
        for row in q:
            pin.computeFrameJacobian(model, data, row, tip)

    name = f"pinocchio {version('pin')}"
    yield name, "fk, loop in Python", best(poses) / FEW
    yield name, "jacobian, loop in Python", best(jacobians) / FEW


def roboticstoolbox(path: str) -> Iterator[tuple[str, str, float]]:
    """The Robotics Toolbox."""
    import_module("roboticstoolbox")
    chain = dn.load(path).chain()
    robot = chain.to_roboticstoolbox()
    ets = robot.ets()
    q = chain.sample(FEW)
    name = f"roboticstoolbox {version('roboticstoolbox-python')}"
    yield name, "fk, batch (ets.eval)", best(lambda: ets.eval(q)) / FEW
    yield name, "jacobian, loop in Python", best(lambda: [ets.jacob0(row) for row in q]) / FEW


def pytorch_kinematics(path: str) -> Iterator[tuple[str, str, float]]:
    """A batch on the CPU, float64."""
    pk, torch = import_module("pytorch_kinematics"), import_module("torch")
    chain = dn.load(path).chain()
    serial = pk.build_serial_chain_from_urdf(Path(path).read_bytes(), chain.tip).to(dtype=torch.float64)
    q = torch.from_numpy(chain.sample(COUNT))
    name = f"pytorch_kinematics {version('pytorch_kinematics')}, CPU"
    yield name, "fk, batch", best(lambda: serial.forward_kinematics(q)) / COUNT
    yield name, "jacobian, batch", best(lambda: serial.jacobian(q)) / COUNT


def main() -> None:
    """Print the table."""
    path = sys.argv[1]
    print(f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}, numpy {np.__version__}; {path}\n")
    print("| package | what | µs per configuration |\n|---|---|---:|")
    for measure in (own, pinocchio, roboticstoolbox, pytorch_kinematics):
        try:
            for name, what, seconds in measure(path):
                print(f"| {name} | {what} | {1e6 * seconds:.3f} |", flush=True)
        except ImportError as missing:
            print(f"| {measure.__name__} | not installed ({missing.name}) | |")


if __name__ == "__main__":
    main()
