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

COUNT = 10_000
"""Configurations of a batch; packages without batches are timed on `FEW` of them."""
FEW = 200
SECONDS = 2.0
"""For so long each is run again and again."""


def best(work: Callable[[], object]) -> float:
    """Shortest of many runs, s: on a busy machine most are interrupted, and the shortest is the one that was not."""
    work()
    times, until = [], time.perf_counter() + SECONDS
    while time.perf_counter() < until or len(times) < 5:
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
    yield name, "jacobian, batch, all cores", best(lambda: chain.jacobian(q, out=jacobians, threads=0)) / COUNT


def call(path: str) -> Iterator[tuple[str, str, float]]:
    """Time one call for one configuration, from Python and of the native method that it calls."""
    chain = dn.load(path).chain()
    one, pose = chain.sample(1)[0], np.empty((4, 4))
    native, name = chain._native.fk, f"denavit {dn.__version__}"
    yield name, "fk, one call each, into out", best(lambda: [chain.fk(one, out=pose) for _ in range(FEW)]) / FEW
    yield name, "the same without the method in Python", best(lambda: [native(one, pose, 1) for _ in range(FEW)]) / FEW
    few = chain.sample(32)
    poses = np.empty((32, 4, 4))
    yield name, "fk, 32 configurations a call, into out", best(lambda: [chain.fk(few, out=poses) for _ in range(FEW)]) / FEW


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


def ikpy(path: str) -> Iterator[tuple[str, str, float]]:
    """Chains of ikpy, one configuration after the other."""
    ikpy_chain: Any = import_module("ikpy.chain")
    mine = dn.load(path).chain()
    theirs = ikpy_chain.Chain.from_urdf_file(path, base_elements=[mine.base])
    rows = np.zeros((FEW, len(theirs.links)))
    moving = [index for index, link in enumerate(theirs.links) if link.joint_type == "revolute"]
    rows[:, moving] = mine.sample(FEW)[:, : len(moving)]
    yield f"ikpy {version('ikpy')}", "fk, loop in Python", best(lambda: [theirs.forward_kinematics(row) for row in rows]) / FEW


def jax(path: str) -> Iterator[tuple[str, str, float]]:
    """Product of exponentials in jax, compiled, float64, CPU, over a batch; axes are this package's, arithmetic is jax's."""
    library, numeric = import_module("jax"), import_module("jax.numpy")
    library.config.update("jax_enable_x64", True)
    chain = dn.load(path).chain()
    home, screws = numeric.asarray(chain.home()), numeric.asarray(chain.screws())

    def exponential(screw: Any, angle: Any) -> Any:
        w, v = screw[:3], screw[3:]
        zero = numeric.zeros(())
        skew = numeric.stack([zero, -w[2], w[1], w[2], zero, -w[0], -w[1], w[0], zero]).reshape(3, 3)
        s, c = numeric.sin(angle), numeric.cos(angle)
        turn = numeric.eye(3) + s * skew + (1 - c) * skew @ skew
        slide = (angle * numeric.eye(3) + (1 - c) * skew + (angle - s) * skew @ skew) @ v
        return numeric.eye(4).at[:3, :3].set(turn).at[:3, 3].set(slide)

    def pose(q: Any) -> Any:
        found = numeric.eye(4)
        for index in range(screws.shape[0]):
            found = found @ exponential(screws[index], q[index])
        return found @ home

    batch = library.jit(library.vmap(pose))
    q = numeric.asarray(chain.sample(COUNT))
    assert np.allclose(batch(q), chain.fk(np.asarray(q)), atol=1e-12)
    name = f"jax {version('jax')}, CPU"
    yield name, "fk, batch (product of exponentials)", best(lambda: batch(q).block_until_ready()) / COUNT


def main() -> None:
    """Print the table."""
    path = sys.argv[1]
    print(f"{platform.machine()}, {platform.system()}, Python {platform.python_version()}, numpy {np.__version__}; {path}\n")
    print("| package | what | µs per configuration |\n|---|---|---:|")
    for measure in (own, call, pinocchio, roboticstoolbox, ikpy, jax, pytorch_kinematics):
        try:
            for name, what, seconds in measure(path):
                print(f"| {name} | {what} | {1e6 * seconds:.3f} |", flush=True)
        except (ImportError, OSError, ValueError) as missing:
            print(f"| {measure.__name__} | cannot be imported or run here: {str(missing).splitlines()[0][:80]} | |")


if __name__ == "__main__":
    main()
