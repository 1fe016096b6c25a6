"""A chain as a jax function."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from denavit.errors import ArgumentError

if TYPE_CHECKING:
    from denavit.chain import Chain


def to_jax(chain: Chain) -> Callable[[Any], Any]:
    r"""base_from_tip of joint values, as a jax function with the space Jacobian as its derivative.

    T(q) = e^[S₁]θ₁ … e^[Sₙ]θₙ M with θᵢ = scale · q + offset, and dT = [J(q) dq] T, where column i of J is Ad(e^[S₁]θ₁ …) Sᵢ
    times the scale (Lynch, Park 2017, ch. 4 and 5).
    """
    jax = import_module("jax")
    jnp = jax.numpy
    found = chain.poe()
    joints, names = found["joints"], list(chain.joints)
    twists = np.array([joint["twist"] for joint in joints], dtype=np.float64).reshape(-1, 6)
    # Rows are joints, columns coordinates: a follower has its driver's column.
    scales = np.zeros((len(joints), len(names)))
    for row, joint in enumerate(joints):
        scales[row, names.index(joint["coordinate"])] = joint.get("scale", 1.0)
    offsets = np.array([joint.get("offset", 0.0) for joint in joints])
    home = np.array(found["home"], dtype=np.float64)
    n = len(names)

    def skew(w: Any) -> Any:
        zero = jnp.zeros_like(w[0])
        return jnp.array([[zero, -w[2], w[1]], [w[2], zero, -w[0]], [-w[1], w[0], zero]])

    def exponential(twist: Any, theta: Any) -> Any:
        # The axis has unit length or is a slide: no division by a small angle.
        turn, slide = twist[:3], twist[3:]
        hat = np.array([[0, -turn[2], turn[1]], [turn[2], 0, -turn[0]], [-turn[1], turn[0], 0]])
        sine, versine = jnp.sin(theta), 2 * jnp.sin(theta / 2) ** 2
        rotation = jnp.eye(3) + sine * hat + versine * (hat @ hat)
        place = (jnp.eye(3) * theta + versine * hat + (theta - sine) * (hat @ hat)) @ slide
        return jnp.vstack([jnp.hstack([rotation, place[:, None]]), jnp.array([[0.0, 0.0, 0.0, 1.0]])])

    def walked(q: Any) -> tuple[Any, Any]:
        q = jnp.asarray(q)
        if q.shape != (n,):
            raise ArgumentError(f"q has shape {q.shape}; the chain takes ({n},). Map over rows with jax.vmap")
        thetas = scales @ q + offsets
        pose, columns = jnp.eye(4), []
        for index, twist in enumerate(twists):
            rotation, place = pose[:3, :3], pose[:3, 3]
            turn = rotation @ twist[:3]
            columns.append(jnp.concatenate([turn, skew(place) @ turn + rotation @ twist[3:]]))
            pose = pose @ exponential(twist, thetas[index])
        jacobian = jnp.stack(columns, axis=1) @ scales if columns else jnp.zeros((6, n))
        return pose @ home, jacobian

    def pose_of(q: Any) -> Any:
        return walked(q)[0]

    def derivative(primals: Any, tangents: Any) -> Any:
        (q,), (dq,) = primals, tangents
        pose, jacobian = walked(q)
        twist = jacobian @ dq
        motion = jnp.zeros((4, 4)).at[:3, :3].set(skew(twist[:3])).at[:3, 3].set(twist[3:])
        return pose, motion @ pose

    fk: Callable[[Any], Any] = jax.custom_jvp(pose_of)
    fk.defjvp(derivative)  # type: ignore[attr-defined]
    return fk
