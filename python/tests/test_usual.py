"""The package as users of numpy and pandas try it: every attempt works, or a `DenavitError` says what to give."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import denavit as dn

UR5E = "robots/universal_robots/ur5e.urdf"
TRACKER = "robots/universal_robots/ur5e_tracker.csv"
pandas = pytest.importorskip("pandas", reason="skipped, because pandas is not installed")


@pytest.fixture(scope="module")
def chain() -> dn.Chain:
    return dn.load(UR5E).chain("base", "tool0")


@pytest.fixture(scope="module")
def fit(chain: dn.Chain) -> dn.Fit:
    run = chain.simulate(40, seed=1, effect=["joint_compliance@elbow_joint=0.5mm"])
    return dn.calibrate(chain, run.data, hold_out=0.3, effects=["joint_compliance"])


def test_measurements_in_every_form_give_the_same_fit(chain: dn.Chain) -> None:
    data = dn.Measurements.read(TRACKER)
    frame = data.to_pandas()
    expected = dn.calibrate(chain, data, effects=None)
    q, x = frame[list(chain.joints)].to_numpy(), frame[["x", "y", "z"]].to_numpy()
    for given in (frame, TRACKER, frame.to_dict("list"), (q, x), (frame[list(chain.joints)[::-1]], x), [data], [frame]):
        found = dn.calibrate(chain, given, effects=None)
        np.testing.assert_allclose(found.chain.fk(q[0]), expected.chain.fk(q[0]), atol=1e-9)
    assert dn.calibrate(UR5E, frame, effects=None).chain.n == 6
    later = dn.Measurements.read("robots/universal_robots/ur5e_tracker_later.csv").to_pandas()
    assert dn.calibrate(chain.robot, frame, test=later, effects=None).chain.n == 6


def test_units_travel_with_a_frame() -> None:
    data = dn.Measurements.from_columns({"joint_1": [0.1, 0.2], "x": [100, 200.0], "y": 0.0, "z": 0.0}, "mm,deg")
    assert dn.Measurements.from_pandas(data.to_pandas()).units == "mm,deg"
    assert dn.Measurements.from_pandas(data.to_pandas(), "m,rad").units == "m,rad"
    indexed = data.to_pandas().set_index("joint_1")
    assert dn.Measurements.from_pandas(indexed).columns == ("joint_1", "x", "y", "z")


def test_poses_as_arrays(chain: dn.Chain) -> None:
    q = chain.sample(4)
    poses = dn.Measurements.from_arrays(chain, q, chain.fk(q))
    assert poses.columns[-7:] == ("x", "y", "z", "qx", "qy", "qz", "qw")
    assert dn.Measurements.from_arrays(chain, q, np.ones(4)).columns[-1] == "distance"


@pytest.mark.parametrize(
    "attempt",
    [
        lambda chain: dn.calibrate(chain, 3),
        lambda chain: dn.calibrate(chain, np.zeros((3, 9))),
        lambda chain: dn.calibrate(chain, "no_such_file.csv"),
        lambda chain: dn.calibrate(chain, (np.zeros((3, 6)), np.zeros((4, 3)))),
        lambda chain: dn.calibrate(chain, (np.zeros((3, 5)), np.zeros((3, 3)))),
        lambda chain: dn.calibrate(chain, TRACKER, seed=-1),
        lambda chain: dn.calibrate(chain, TRACKER, max_effects=-1),
        lambda chain: dn.calibrate(chain, TRACKER, hold_out="a third"),
        lambda chain: dn.calibrate(chain, TRACKER, gear_ratio={"elbow_joint": "many"}),
        lambda chain: dn.calibrate(chain, TRACKER, test=7),
        lambda chain: dn.calibrate(5, TRACKER),
        lambda chain: chain.sample(-1),
        lambda chain: chain.sample(10**20),
        lambda chain: chain.sample(2.5),
        lambda chain: chain.sample(3, seed=-1),
        lambda chain: chain.sample("three"),
        lambda chain: chain.fk(np.zeros(6), threads=-1),
        lambda chain: chain.fk(np.zeros(6), threads=10**30),
        lambda chain: chain.fk("home"),
        lambda chain: chain.fk({"a": 1}),
        lambda chain: chain.fk(None),
        lambda chain: chain.fk([10**400] * 6),
        lambda chain: chain.jacobian(np.zeros(6), order="vw"),
        lambda chain: chain.jacobian(np.zeros(6), "base"),
        lambda chain: chain.plan(-1),
        lambda chain: chain.plan(10, spread=-5),
        lambda chain: chain.plan(10, target=(1, 2)),
        lambda chain: chain.plan(10, candidates=pandas.DataFrame({"q1": [1, 2]})),
        lambda chain: chain.plan(10, candidates="all"),
        lambda chain: chain.simulate(-3),
        lambda chain: chain.simulate(10, seed=-1),
        lambda chain: chain.simulate(10, targets=-1),
        lambda chain: chain.simulate(10, repeatability="good"),
        lambda chain: chain.table("khalil-kleinfinger"),
        dn.load,
        lambda chain: dn.load(None),
        lambda chain: dn.load(np.zeros((6, 4))),
        lambda chain: dn.diff(chain, UR5E),
        lambda chain: dn.diff(UR5E, UR5E, samples=-1),
        lambda chain: dn.diff(UR5E, UR5E, seed=2**70),
        dn.fingerprint,
        dn.check,
        lambda chain: dn.check(dn.load("robots/universal_robots/ur5e_dh.csv")),
        lambda chain: dn.Measurements.from_columns({"x": [object()]}),
        lambda chain: dn.Measurements.from_columns({"x": [1j]}),
        lambda chain: dn.Measurements.from_pandas(pandas.DataFrame([[1, 2]], columns=["x", "x"])),
        lambda chain: dn.Measurements.from_pandas([1, 2]),
        lambda chain: np.asarray(dn.Measurements.from_columns({"tip": ["left"], "x": 1})),
    ],
)  # fmt: skip
def test_what_cannot_be_is_a_denavit_error(attempt: Callable[[dn.Chain], Any], chain: dn.Chain) -> None:
    with pytest.raises(dn.DenavitError) as raised:
        attempt(chain)
    assert len(str(raised.value)) > 20


@pytest.mark.parametrize(
    "attempt",
    [
        lambda fit: fit.predict(5),
        lambda fit: fit.fk(np.zeros(5)),
        lambda fit: fit.fk("home"),
        lambda fit: fit.compensate("no_such.csv"),
        lambda fit: fit.compensate(object()),
        lambda fit: fit.compensate(np.zeros((2, 6)), given={"payload": "heavy"}),
        lambda fit: fit.curves["elbow_joint"]("here"),
        dn.load,
    ],
)  # fmt: skip
def test_what_a_fit_cannot_answer_is_a_denavit_error(attempt: Callable[[dn.Fit], Any], fit: dn.Fit) -> None:
    with pytest.raises(dn.DenavitError):
        attempt(fit)


def test_a_fit_says_where_the_arm_will_be(fit: dn.Fit, chain: dn.Chain) -> None:
    q = chain.sample(6, seed=5)
    T = fit.fk(q)
    assert T.shape == (6, 4, 4)
    np.testing.assert_array_equal(fit.fk(q[0]), T[0])
    np.testing.assert_array_equal(fit.fk(q.reshape(2, 3, 6)), T.reshape(2, 3, 4, 4))
    np.testing.assert_array_equal(fit.fk(pandas.DataFrame(q, columns=chain.joints)), T)
    # The effects add to what the calibrated geometry says; without any they are the same.
    apart = np.linalg.norm(T[:, :3, 3] - fit.chain.tips(q), axis=1)
    assert (apart.max() > 1e-5) == bool(fit.effects)
    assert apart.max() < 5e-3


def test_rows_are_counted_walked_through_and_made_arrays_and_frames(chain: dn.Chain, fit: dn.Fit) -> None:
    table = chain.table("distal")
    assert len(table) == len(list(table)) == len(np.asarray(table)) == 8
    assert np.asarray(table)[3, 3] == table[3].a == -0.3922
    plan = chain.plan(8, spread=50)
    assert len(plan) == len(list(plan)) == len(plan.to_pandas()) == 8
    np.testing.assert_array_equal(np.asarray(plan), plan.q)
    assert tuple(plan.to_pandas().columns) == chain.joints
    np.testing.assert_array_equal(chain.fk(plan.to_pandas()), chain.fk(plan))
    data = dn.Measurements.read(TRACKER)
    assert len(data) == len(list(data)) == len(np.asarray(data)) == 120
    np.testing.assert_array_equal(np.asarray(data), data.to_pandas().to_numpy())
    residuals = fit.residuals
    assert len(residuals) == len(list(residuals)) == len(residuals.to_pandas())
    assert np.asarray(residuals).shape == (len(residuals), 6)
    np.testing.assert_allclose(residuals.to_pandas()["distance"], residuals.distance)
    found = dn.check(UR5E)
    assert len(found) == len(list(found)) == len(found.to_pandas()) > 0
    prediction = fit.predict(chain.simulate(15, seed=1).data)
    assert len(prediction) == len(prediction.to_pandas()) == len(np.asarray(prediction)) == 15
    commands = fit.compensate(chain.sample(3))
    assert len(commands) == len(list(commands)) == len(commands.to_pandas()) == len(np.asarray(commands)) == 3


def test_what_notebooks_show_is_in_mm_with_few_digits(fit: dn.Fit, chain: dn.Chain) -> None:
    errors = fit.errors._repr_html_()
    assert "position_rms_mm" in errors
    assert "rms_m<" not in errors
    parameters = fit.parameters._repr_html_()
    assert "<td>mm</td>" in parameters
    assert "<td>mrad</td>" in parameters
    assert "<td>m</td>" not in parameters
    assert "mm" in fit.residuals._repr_html_()
    assert "position_rms_mm" in fit.predict(chain.simulate(15, seed=1).data)._repr_html_()
    assert "-425" in chain.table()._repr_html_()
    # Numbers for programs stay in m.
    assert "train_position_rms_m" in fit.errors.to_pandas().columns
    many = [cell for cell in errors.replace("</td>", "<td>").split("<td>") if len(cell.split(".")[-1]) > 7 and cell[:1].isdigit()]
    assert many == []


def test_dir_shows_what_there_is_to_use() -> None:
    shown = {name for name in dir(dn) if not name.startswith("_")}
    assert shown == set(dn.__all__)
    inside = {name for name in dir(dn.fleet) if not name.startswith("_")}
    assert not inside & {"json", "os", "time", "Path", "Any", "annotations", "import_module", "islice"}


def test_limits_and_count(chain: dn.Chain) -> None:
    assert chain.n == len(chain) == 6
    np.testing.assert_allclose(chain.limits, [[-2 * np.pi, 2 * np.pi]] * 6)
    free = dn.load({"theta": 0, "d": 0, "alpha": 0, "a": [1, 1]}).chain()
    np.testing.assert_array_equal(free.limits, [[-np.inf, np.inf]] * 2)


def test_frames_and_order_of_jacobians_are_pinocchios(chain: dn.Chain) -> None:
    q = chain.sample(4)
    for mine, theirs in (("space", "world"), ("body", "local"), ("tip", "local_world_aligned")):
        np.testing.assert_array_equal(chain.jacobian(q, mine), chain.jacobian(q, theirs))  # type: ignore[arg-type]
    linear = chain.jacobian(q, "local", order="linear_first")
    np.testing.assert_array_equal(linear, chain.jacobian(q, "local")[:, [3, 4, 5, 0, 1, 2]])
    out = np.empty((4, 6, 6))
    np.testing.assert_array_equal(chain.jacobian(q, "local", out, order="linear_first"), linear)
    np.testing.assert_array_equal(out, linear)
    pinocchio = pytest.importorskip("pinocchio", reason="skipped, because pinocchio is not installed")
    model = chain.to_pinocchio()
    data, tip = model.createData(), model.getFrameId("tool0")
    for frame in ("WORLD", "LOCAL", "LOCAL_WORLD_ALIGNED"):
        expected = pinocchio.computeFrameJacobian(model, data, q[0], tip, getattr(pinocchio.ReferenceFrame, frame))
        np.testing.assert_allclose(chain.jacobian(q[0], frame.lower(), order="linear_first"), expected, atol=1e-12)  # type: ignore[arg-type]


@pytest.mark.parametrize("convention", ["distal", "proximal"])
def test_robots_of_roboticstoolbox_are_sources(convention: Any, chain: dn.Chain) -> None:
    pytest.importorskip("roboticstoolbox", reason="skipped, because roboticstoolbox is not installed")
    spatialmath = pytest.importorskip("spatialmath", reason="skipped, because spatialmath is not installed")
    import roboticstoolbox as rtb

    own = chain.to_roboticstoolbox(convention)
    moved = rtb.DHRobot(
        [rtb.RevoluteDH(a=0.3, alpha=0.4, flip=True, qlim=[-1, 2]), rtb.PrismaticMDH(a=0.1, qlim=[0, 0.5])]
        if convention == "mixed"
        else [rtb.RevoluteDH(a=0.3, alpha=0.4, flip=True, qlim=[-1, 2]), rtb.PrismaticDH(a=0.1, theta=0.2, qlim=[0, 0.5])],
        name="moved", base=spatialmath.SE3.RPY(0.1, 0.2, 0.3) * spatialmath.SE3(1, 2, 3), tool=spatialmath.SE3.Rx(0.3),
    )  # fmt: skip
    for theirs in (own, moved, rtb.models.DH.Puma560(), rtb.models.DH.Stanford()):
        again = dn.load(theirs).chain(exact=True)
        for q in again.sample(5):
            np.testing.assert_allclose(again.fk(q), theirs.fkine(q).A, atol=1e-9)
    np.testing.assert_allclose(dn.load(moved).chain().limits, [[-1, 2], [0, 0.5]])


@pytest.mark.parametrize("robot", [UR5E, "robots/kuka/kr16_2_on_rail.urdf", "robots/rethink/baxter.urdf"])
def test_models_of_pinocchio_are_sources(robot: str) -> None:
    pinocchio = pytest.importorskip("pinocchio", reason="skipped, because pinocchio is not installed")
    model = pinocchio.buildModelFromUrdf(robot)
    again = dn.load(model)
    for listing in dn.load(robot).chains:
        mine, theirs = (source.chain(listing.base, listing.tip) for source in (dn.load(robot), again))
        assert mine.joints == theirs.joints
        np.testing.assert_allclose(mine.fk(mine.sample(5)), theirs.fk(mine.sample(5)), atol=1e-9)
        np.testing.assert_allclose(mine.limits, theirs.limits)


@pytest.mark.parametrize("robot", [UR5E, "robots/denso/hsr065_screw_spline.urdf", "robots/robotiq/2f_85.urdf"])
def test_jax_has_the_same_poses_and_our_jacobian_as_derivative(robot: str) -> None:
    jax = pytest.importorskip("jax", reason="skipped, because jax is not installed")
    jax.config.update("jax_enable_x64", True)
    chain = dn.load(robot).chain()
    fk = chain.to_jax()
    Q = chain.sample(4)
    np.testing.assert_allclose(jax.jit(jax.vmap(fk))(Q), chain.fk(Q), atol=1e-12)
    for q in Q:
        expected = chain.jacobian(q, "tip")[3:]
        for derivative in (jax.jacfwd, jax.jacrev):
            np.testing.assert_allclose(derivative(lambda values: fk(values)[:3, 3])(q), expected, atol=1e-12)
        hessian = jax.hessian(lambda values: fk(values)[0, 3])(q)
        np.testing.assert_allclose(hessian, hessian.T, atol=1e-12)
    with pytest.raises(dn.ArgumentError, match="vmap"):
        fk(Q)
