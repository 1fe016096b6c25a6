"""From measurements to a calibrated model: the contract of the command, robots that come back, interrupts."""

from __future__ import annotations

import json
import os
import pickle
import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import denavit as dn

TOP = Path(__file__).resolve().parents[2]
TRACKER = "robots/universal_robots/ur5e_tracker.csv"
LATER = "robots/universal_robots/ur5e_tracker_later.csv"


@pytest.fixture(scope="module")
def drawn() -> dn.Chain:
    return dn.load(TOP / "robots/universal_robots/ur5e.urdf").chain()


def tracker() -> dn.Measurements:
    return dn.Measurements.read(TOP / TRACKER)


def later() -> dn.Measurements:
    return dn.Measurements.read(TOP / LATER)


@pytest.fixture(scope="module")
def geometric(drawn: dn.Chain) -> dn.Fit:
    return dn.calibrate(drawn, tracker(), test=later(), effects=None)


@pytest.fixture(scope="module")
def traced(drawn: dn.Chain) -> dn.Fit:
    return dn.calibrate(drawn, tracker(), test=later())


def test_a_mass_is_for_a_description_without_masses(drawn: dn.Chain) -> None:
    drawing = (TOP / "robots/universal_robots/ur5e.urdf").read_text(encoding="utf-8")
    bare = dn.load(re.sub("<inertial>.*?</inertial>", "", drawing, flags=re.DOTALL)).chain("base", "tool0")

    def compliance(mass: float | None) -> float:
        (effect,) = dn.calibrate(bare, tracker(), effects=["joint_compliance"], mass=mass).effects
        return effect.value

    # The heavier the links are, the stiffer a joint is that gives as much.
    assert 0.4 < compliance(40.0) / compliance(20.0) < 0.7
    assert compliance(None) > 0
    with pytest.raises(dn.DenavitError, match="has masses"):
        dn.calibrate(drawn, tracker(), effects=["joint_compliance"], mass=20.6)
    for wrong in (0.0, -1.0, float("nan"), "heavy"):
        with pytest.raises(dn.ArgumentError, match="mass"):
            dn.calibrate(bare, tracker(), mass=wrong)


def test_a_fit_says_what_the_command_says(geometric: dn.Fit) -> None:
    found = geometric.to_dict()
    assert found["schema"].startswith("denavit.calibration/")
    assert [stage["name"] for stage in found["stages"]] == [errors.stage for errors in geometric.errors]
    nominal, fitted = geometric.errors
    assert (nominal.stage, fitted.stage, fitted.adopted) == ("nominal", "geometric", True)
    assert fitted.test["position_rms_m"] < 0.1 * nominal.test["position_rms_m"]
    assert geometric.effects == ()
    assert [parameter.name for parameter in geometric.parameters] == [entry["parameter"] for entry in found["parameters"]]
    assert "noise floor" in repr(geometric)


def test_an_earlier_fit_is_continued(drawn: dn.Chain, geometric: dn.Fit, tmp_path: Path) -> None:
    run = drawn.simulate(8, seed=4, test=30)
    assert run.test is not None
    before = dn.calibrate(drawn, drawn.simulate(60, seed=4).data, effects=None)
    alone = dn.calibrate(drawn, run.data, test=run.test, effects=None)
    after = dn.calibrate(drawn, run.data, test=run.test, effects=None, prior=before)
    assert [errors.stage for errors in after.errors] == ["nominal", "earlier", "geometric"]
    last = [fit.errors[-1].test["position_rms_m"] for fit in (alone, after)]
    assert last[1] < 0.7 * last[0], last
    file = tmp_path / "earlier.json"
    file.write_text(before.to_json())
    again = dn.calibrate(drawn, run.data, test=run.test, effects=None, prior=file)
    assert again.parameters == after.parameters
    assert again.to_dict()["origin"]["files"][-1]["used"] == "prior"
    assert pickle.loads(pickle.dumps(after)) == after
    assert not np.array_equal(drawn.plan(5, prior=before).q, drawn.plan(5).q)
    with pytest.raises(dn.ArgumentError, match="not its calibrated URDF"):
        dn.calibrate(before.chain, run.data, effects=None, prior=before)


def test_the_curves_of_an_earlier_fit_are_continued(drawn: dn.Chain, tmp_path: Path) -> None:
    effect = ["transmission_error@elbow_joint:order=3=0.4mm"]
    first = drawn.simulate(q=drawn.sample(300, seed=11), seed=5, effect=effect, geometry_error=(0.0, 0.0))
    before = dn.calibrate(drawn, first.data, effects="curves")
    later = drawn.simulate(q=drawn.sample(10, seed=12), seed=6, effect=effect, geometry_error=(0.0, 0.0))
    after = dn.calibrate(drawn, later.data, effects="curves", prior=before)
    assert [errors.stage for errors in after.errors][:4] == ["nominal", "geometric", "earlier", "updated"]
    parts = after.to_dict()["earlier"]["effects"]
    assert [(part["kind"], part["where"], part["state"]) for part in parts] == [("error_curve", "elbow_joint", "kept")]
    q = np.linspace(-1.0, 1.0, 20)
    assert np.abs(after.curves["elbow_joint"](q) - before.curves["elbow_joint"](q)).max() < 2e-4
    file = tmp_path / "earlier.json"
    file.write_text(before.to_json())
    assert dn.calibrate(drawn, later.data, effects="curves", prior=file).parameters == after.parameters
    assert "effects" not in dn.calibrate(drawn, later.data, effects=None, prior=file).to_dict()["earlier"]


def test_the_json_is_that_of_the_command(traced: dn.Fit) -> None:
    given = os.environ.get("DENAVIT")
    places = [Path(given)] if given else [TOP / "target" / profile / "denavit" for profile in ("debug", "release")]
    # The newest: an old build of the other profile says what the program said then.
    command = max((path for path in places if path.exists()), key=lambda path: path.stat().st_mtime, default=None)
    if command is None:
        pytest.skip("skipped, because the command line is not built")
    words = ["robots/universal_robots/ur5e.urdf", "--data", str(TOP / TRACKER), "--test", str(TOP / LATER), "--json"]
    done = subprocess.run([command, "calibrate", *words], cwd=TOP, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == traced.to_dict()


def test_effects_say_what_where_and_how_sure(traced: dn.Fit) -> None:
    (effect,) = traced.effects
    assert (effect.kind, effect.at, effect.unit) == ("joint_compliance", "shoulder_lift_joint", "rad/(N m)")
    assert effect.sd is not None
    # What the file was made with: `denavit simulate --effect joint_compliance@shoulder_lift_joint`, see robots/README.md.
    assert abs(effect.value - 9.7e-6) < 5 * effect.sd
    assert effect.probability is None or effect.probability > 0.9
    assert all(isinstance(rival, dn.Rival) for rival in effect.rivals)
    assert traced.residuals_of("geometric").distance.mean() > traced.residuals.distance.mean()
    assert not traced.unexplained.structured


def test_residuals_are_those_of_the_errors(geometric: dn.Fit) -> None:
    for stage in (0, 1):
        for test, errors in ((False, geometric.errors[stage].train), (True, geometric.errors[stage].test)):
            residuals = geometric.residuals_of(stage, test=test)
            assert residuals.place.shape == residuals.turn.shape == (len(residuals), 3)
            rms = np.sqrt(np.mean(residuals.distance**2))
            np.testing.assert_allclose(rms, errors["position_rms_m"], rtol=1e-9)
    with pytest.raises(dn.ArgumentError, match="there is no stage"):
        geometric.residuals_of("nothing")


@pytest.mark.parametrize("which", ["geometric", "traced"])
def test_prediction_of_the_test_rows_is_the_test(which: str, request: pytest.FixtureRequest) -> None:
    fit: dn.Fit = request.getfixturevalue(which)
    prediction = fit.predict(later())
    np.testing.assert_allclose(prediction.residuals.place, fit.residuals_of(test=True).place, atol=1e-12)
    assert prediction.errors == pytest.approx(fit.errors[-1].test)


def test_the_calibrated_robot_is_a_urdf(geometric: dn.Fit, tmp_path: Path) -> None:
    path = tmp_path / "calibrated.urdf"
    geometric.robot.save(path)
    assert not dn.diff(geometric.nominal.robot, path).same
    q = geometric.nominal.sample(30)
    tip = geometric.chain.tip
    np.testing.assert_allclose(dn.load(path).chain("base", tip, exact=True).fk(q), geometric.chain.fk(q), atol=1e-12)
    geometric.report(tmp_path / "fit.html")
    assert "<svg" in (tmp_path / "fit.html").read_text()
    geometric.save_effects(tmp_path / "effects.json")
    assert json.loads((tmp_path / "effects.json").read_text())["schema"] == "denavit.effects/1"


def test_what_a_urdf_cannot_hold_is_refused_when_it_is_asked_for(drawn: dn.Chain) -> None:
    run = drawn.simulate(60, seed=9)
    fit = dn.calibrate(drawn, run.data, effects=None, scales="all")
    assert fit.chain.fk(np.zeros(6)).shape == (4, 4)
    with pytest.raises(dn.ExportError):
        _ = fit.robot


def test_a_fit_is_a_value(geometric: dn.Fit) -> None:
    again: dn.Fit = pickle.loads(pickle.dumps(geometric))
    assert again == geometric
    assert hash(again) == hash(geometric)
    assert again.residuals == geometric.residuals
    assert again.predict(later()).errors == geometric.predict(later()).errors
    with pytest.raises(AttributeError):
        again.seed = 1  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match=r"denavit\.calibrate"):
        dn.Fit()
    values = (tracker(), geometric.errors, geometric.parameters, geometric.unexplained, geometric.residuals, geometric.curves)
    for value in values:
        assert pickle.loads(pickle.dumps(value)) == value


def test_simulated_robots_come_back(drawn: dn.Chain) -> None:
    run = drawn.simulate(60, seed=4, test=20, noise=(0.0, 0.0))
    assert run == drawn.simulate(60, seed=4, test=20, noise=(0.0, 0.0))
    assert run.test is not None
    assert run.truth["schema"] == "denavit.simulation/1"
    fit = dn.calibrate(drawn, run.data, test=run.test, effects=None)
    assert fit.errors[0].test["position_rms_m"] > 1e-3
    assert fit.errors[-1].test["position_rms_m"] < 1e-9
    truth = run.truth["axes"]
    for parameter in fit.parameters:
        assert parameter.change == pytest.approx(truth[parameter.name], abs=1e-3)


def test_columns_and_frames_are_measurements(drawn: dn.Chain, geometric: dn.Fit) -> None:
    pytest.importorskip("pandas", reason="skipped, because pandas is not installed")
    frame = tracker().to_pandas()
    assert len(frame) == len(tracker()) == 120
    assert tuple(frame.columns) == tracker().columns
    arrays = {name: frame[name].to_numpy() for name in frame.columns}
    one = dn.Measurements.from_pandas(frame)
    other = dn.Measurements.from_columns(arrays)
    assert one.text == other.text
    fit = dn.calibrate(drawn, other, effects=None)
    np.testing.assert_array_equal(fit.residuals.place, geometric.residuals.place)
    assert geometric.errors.to_pandas().loc[1, "stage"] == "geometric"
    assert list(geometric.parameters.to_pandas()["joint"][:4]) == ["shoulder_pan_joint"] * 4
    with pytest.raises(dn.ArgumentError, match="one length"):
        dn.Measurements.from_columns({"x": [1.0, 2.0], "y": [1.0]})
    missing = dn.Measurements.from_columns({"x": [1.0, None, np.nan], "label": "a"})
    assert missing.text == "x,label\n1.0,a\n,a\n,a\n"


def test_units_are_those_of_the_measurements(drawn: dn.Chain, geometric: dn.Fit) -> None:
    frame = tracker().to_pandas()
    frame[list(drawn.joints)] *= 180 / np.pi
    frame[["x", "y", "z"]] *= 1e3
    fit = dn.calibrate(drawn, dn.Measurements.from_pandas(frame, units="mm,deg"), effects=None)
    np.testing.assert_allclose(fit.residuals.place, geometric.residuals.place, atol=1e-9)
    with pytest.raises(dn.ArgumentError, match="units"):
        dn.calibrate(drawn, dn.Measurements.from_pandas(frame, units="miles"))


def sockets(chain: dn.Chain, labels: tuple[str, ...], seed: int) -> dict[str, dn.Measurements]:
    """Bare readings with the tip's ball in sockets, found by pinocchio-free means: Newton on this chain's own kinematics."""
    generator, ball = np.random.default_rng(seed), np.array([0.05, 0.0, 0.1, 1.0])
    found = {}
    for index, label in enumerate(labels):
        goal, rows = np.array([0.4, 0.2, 0.25]) + np.array([0.05 * (index % 2), -0.15 * (index // 2), 0.1 * (index // 2)]), []
        while len(rows) < 20:
            q = generator.uniform(-2.0, 2.0, 6)
            for _ in range(40):
                place = (chain.fk(q) @ ball)[:3]
                jacobian = chain.jacobian(q, "space")
                moves = jacobian[3:] + np.cross(jacobian[:3].T, place).T
                q -= np.linalg.lstsq(moves, place - goal, rcond=None)[0]
            if np.linalg.norm((chain.fk(q) @ ball)[:3] - goal) < 1e-9 and np.abs(q).max() < np.pi:
                rows.append(q)
        text = "\n".join(",".join(map(repr, map(float, row))) for row in rows)
        found[label] = dn.Measurements(text, f"{label}.csv")
    return found


def test_readings_in_sockets_calibrate(drawn: dn.Chain) -> None:
    true = dn.calibrate(drawn, drawn.simulate(80, seed=21, noise=(0.0, 0.0)).data, effects=None).chain
    labels = ("a/0", "a/1", "b/0", "b/1", "c/0", "c/1")
    given = sockets(true, labels, seed=2)
    options = {"distance": "*/0,*/1=50mm+-0.001mm", "effects": None}
    fit = dn.calibrate(drawn, socket=given, hold_out_setups=["c"], **options)  # type: ignore[arg-type]
    nominal, fitted = fit.errors[0].test, fit.errors[-1].test
    assert nominal["spread_rms_m"] > 1e-4
    assert fitted["spread_rms_m"] < 0.2 * nominal["spread_rms_m"]
    with pytest.raises(dn.ArgumentError, match="distance="):
        dn.calibrate(drawn, socket=given, distance="x,y=50mm")
    with pytest.raises(dn.ArgumentError, match="nothing to fit"):
        dn.calibrate(drawn)


def test_several_measurements_are_several_setups(drawn: dn.Chain) -> None:
    one, other = (drawn.simulate(60, seed=seed, geometry_error=(0.0, 0.0)).data for seed in (1, 2))
    assert one.file == other.file
    fit = dn.calibrate(drawn, [one, other], effects=None)
    # In one instrument frame the two would be centimetres apart.
    assert fit.errors[0].train["position_rms_m"] < 2e-4


def test_compensated_commands_reach_their_poses(traced: dn.Fit) -> None:
    rng = np.random.default_rng(3)
    q = np.array([0.3, -1.2, 1.4, -1.0, -1.3, 0.2]) + rng.uniform(-0.3, 0.3, (8, 6))
    poses = traced.nominal.fk(q)
    commands = traced.compensate(poses)
    assert commands.reached
    assert commands.q.shape == (8, 6)
    assert (commands.position_errors < 1e-6).all()
    assert commands.uncompensated.max() > 1e-4
    by_joints = traced.compensate(q)
    np.testing.assert_allclose(traced.nominal.fk(by_joints.nominal), poses, atol=1e-9)
    again: dn.Commands = pickle.loads(pickle.dumps(commands))
    assert again == commands
    far = poses.copy()
    far[:, :3, 3] *= 9
    assert not traced.compensate(far).reached
    for wrong, why in ((poses * 2, r"poses\[0\] is not a homogeneous"), (q[:, :5], "6 joint values"), (q[0], "shape")):
        with pytest.raises(dn.ArgumentError, match=why):
            traced.compensate(wrong)


def test_commands_without_effects_are_inverse_kinematics_of_the_calibrated_chain(geometric: dn.Fit) -> None:
    q = np.array([[0.3, -1.2, 1.4, -1.0, -1.3, 0.2]])
    commands = geometric.compensate(q)
    np.testing.assert_allclose(geometric.chain.fk(commands.q), geometric.nominal.fk(q), atol=1e-6)


def test_noise_is_made_of_what_is_asked_for(drawn: dn.Chain) -> None:
    def off(**words: Any) -> float:
        run = drawn.simulate(150, seed=3, noise=(1e-6, 1e-6), **words)
        left = dn.calibrate(drawn, run.data, effects=None).residuals
        return float(np.sqrt(np.mean(np.square(left.place))))

    alone = off()
    assert alone == off(range_noise=0.0, angle_noise=0.0, repeatability=0.0)
    assert alone < 2e-6
    sources: list[dict[str, Any]] = [
        {"range_noise": 1e-4},
        {"angle_noise": 1e-4},
        {"repeatability": 1e-4},
        {"repeatability": {"elbow_joint": 1e-4}},
    ]
    for words in sources:
        assert 1e-5 < off(**words) < 1e-3, words
    assert off(repeatability={"elbow_joint": 1e-4}) < off(repeatability=1e-4)
    with pytest.raises(dn.ArgumentError, match='there is no joint "elbow"; there are shoulder_pan_joint, '):
        off(repeatability={"elbow": 1e-4})
    with pytest.raises(dn.ArgumentError, match="repeatability is -1; write numbers of 0 or more"):
        off(repeatability=-1.0)
    with pytest.raises(dn.ArgumentError, match="write two numbers of 0 or more, m and rad"):
        off(range_noise=-1.0)


def test_error_curves_are_functions(drawn: dn.Chain) -> None:
    q = drawn.sample(300, seed=11)
    specification = "transmission_error@elbow_joint:order=3=0.4mm"
    run = drawn.simulate(q=q, seed=5, effect=[specification], geometry_error=(0.0, 0.0))
    fit = dn.calibrate(drawn, run.data, effects="curves")
    curve, other = fit.curves["elbow_joint"], dn.calibrate(drawn, run.data, effects=None).curves["elbow_joint"]
    assert curve.fitted
    assert not other.fitted
    assert not other(q).any()
    assert curve.range is not None
    at = np.linspace(*curve.range, 50)
    entry = next(entry for entry in fit.to_dict()["curves"] if entry["joint"] == "elbow_joint")
    table = entry["table"]
    np.testing.assert_allclose(curve([point["at"] for point in table]), [point["value"] for point in table], atol=1e-15)
    effect = run.truth["effects"]["effects"][0]
    assert effect["kind"] == "transmission_error"
    sine, cosine = effect["coefficients"]
    truth = sine * np.sin(3 * at) + cosine * np.cos(3 * at)
    # A curve says nothing of a constant, nor of what the axes take over: the wave must be there all the same.
    assert np.corrcoef(curve(at), truth)[0, 1] > 0.9
    assert curve(q.reshape(10, 30, 6)).shape == (10, 30, 6)
    assert pickle.loads(pickle.dumps(curve)) == curve


def test_plots_are_drawn(traced: dn.Fit) -> None:
    matplotlib = pytest.importorskip("matplotlib", reason="skipped, because matplotlib is not installed")
    matplotlib.use("Agg")
    residuals, effects = traced.plot.residuals(), traced.plot.effects()
    assert residuals.get_xlabel() == "error, mm"
    assert len(effects.patches) == 1
    ratio = traced.effects[0].value / (traced.effects[0].sd or np.nan)
    assert effects.patches[0].get_width() == pytest.approx(ratio)


def test_errors_name_file_line_and_hint(drawn: dn.Chain) -> None:
    lines = tracker().text.splitlines()
    header = next(index for index, line in enumerate(lines) if not line.startswith("#"))
    wrong = [*lines]
    wrong[header + 3] = "x," + wrong[header + 3].partition(",")[2]
    with pytest.raises(dn.DataError) as raised:
        dn.calibrate(drawn, dn.Measurements("\n".join(wrong), "run.csv"))
    assert (raised.value.file, raised.value.line) == ("run.csv", header + 4)
    with pytest.raises(dn.CalibrationError) as few:
        dn.calibrate(drawn, dn.Measurements("\n".join(lines[: header + 2]), "run.csv"))
    assert few.value.file == "run.csv"
    for options, why in (
        ({"scales": ["nothing"]}, "scales=: the chain has no joint"),
        ({"effects": ["magic"]}, "not a kind of effect"),
        ({"gear_ratio": {"elbow": 100}}, "names no joint"),
        ({"hold_out": 0.3, "test": tracker()}, "exclude each other"),
    ):
        with pytest.raises(dn.ArgumentError, match=why):
            dn.calibrate(drawn, tracker(), **options)  # type: ignore[arg-type]
    with pytest.raises(dn.CalibrationError, match="hold_out="):
        dn.calibrate(drawn, tracker(), hold_out=7.0)
    with pytest.raises(dn.CalibrationError, match="these are the rows"):
        dn.calibrate(drawn, tracker(), test=tracker())


def test_poses_distinguish_what_a_fit_could_not(drawn: dn.Chain) -> None:
    run = drawn.simulate(60, seed=5, effect=["joint_compliance@elbow_joint=0.05mm"])
    fit = dn.calibrate(drawn, run.data)
    chosen = drawn.plan(6, tell_apart=fit, spread=100)
    assert chosen.q.shape == (6, 6)
    assert chosen.json["schema"] == "denavit.tell_apart/1"
    unsure = chosen.json["prospect"]["unsure"]
    assert 0 < unsure["expected"] < unsure["now"] < 1e-3
    assert chosen == drawn.plan(6, tell_apart=fit, spread=100)
    with pytest.raises(dn.ArgumentError, match="leave out measure"):
        drawn.plan(6, tell_apart=fit, measure="poses")


def test_plans_are_poses_to_simulate_at(drawn: dn.Chain) -> None:
    plan = drawn.plan(12, spread=200)
    assert plan.q.shape == (12, 6)
    assert plan == drawn.plan(12, spread=200)
    assert len(drawn.simulate(q=plan).data) == 12
    chosen = drawn.plan(4, candidates=plan.q)
    assert all(any(np.array_equal(row, candidate) for candidate in plan.q) for row in chosen.q)
    for wrong, why in (
        ({"count": 12, "candidates": plan.q[:5]}, "12 poses are wanted"),
        ({"count": 0}, "count is 0"),
        ({"count": 5, "box": [1, 0, 0, 1, 0, 1]}, "box=: X0 = 1 is not below"),
        ({"count": 5, "measure": "angles"}, "write one of"),
    ):
        with pytest.raises(dn.ArgumentError, match=why):
            drawn.plan(**wrong)  # type: ignore[arg-type]
    for wrong, why in (
        ({"effect": ["magic@x=1"]}, "not a kind of effect"),
        ({"columns": ["weather"]}, "cannot be simulated"),
        ({"noise": (-1.0, 0.0)}, "noise is"),
        ({"targets": 2, "measure": "poses"}, "several targets"),
        ({"q": plan.q[:, :5]}, "6 joint values"),
    ):
        with pytest.raises(dn.ArgumentError, match=why):
            drawn.simulate(**wrong)  # type: ignore[arg-type]


def test_progress_is_reported_and_what_it_raises_ends_the_fit(drawn: dn.Chain) -> None:
    told: list[str] = []
    dn.calibrate(drawn, tracker(), progress=told.append)
    assert told == ["geometry", "effects", "judgement"]

    def stop(stage: str) -> None:
        raise RuntimeError(stage)

    with pytest.raises(RuntimeError, match="geometry"):
        dn.calibrate(drawn, tracker(), progress=stop)


def running() -> int:
    """Threads of this process."""
    return sum(1 for _ in Path("/proc/self/task").iterdir()) if sys.platform.startswith("linux") else 0


def at_rest() -> int:
    """Threads once those of earlier tests have ended: the number that stays for half a second."""
    counts = [running()]
    while len(counts) < 50 or len(set(counts[-50:])) > 1:
        time.sleep(0.01)
        counts.append(running())
    return counts[-1]


def comes_back_to(threads: int) -> bool:
    """Whether only so many are left at last: the system counts a thread for a moment after it was joined."""
    for _ in range(500):
        if running() == threads:
            return True
        time.sleep(0.01)
    return False


def test_an_interrupt_ends_a_fit_at_once_and_leaves_nothing_running(drawn: dn.Chain, ctrl_c: None) -> None:
    run = drawn.simulate(600, seed=1, effect=["joint_compliance@elbow_joint=0.1mm"]).data
    main = threading.main_thread().ident
    assert main is not None
    threads = at_rest()
    waits = []
    for after in (0.05, 0.3, 0.8, 1.5):
        asked: list[float] = []

        def interrupt(asked: list[float] = asked) -> None:
            asked.append(time.monotonic())
            signal.pthread_kill(main, signal.SIGINT)

        timer = threading.Timer(after, interrupt)
        timer.start()
        with pytest.raises(KeyboardInterrupt):
            while True:
                dn.calibrate(drawn, run)
        waits.append(time.monotonic() - asked[0])
        timer.join()
        assert comes_back_to(threads), running()
    # On a machine that is busy with other work one of them may wait for its turn.
    assert np.median(waits) < 0.2, waits
    assert max(waits) < 1.0, waits


def test_other_threads_of_python_run_while_a_fit_lasts(drawn: dn.Chain) -> None:
    run, ticks = drawn.simulate(300, seed=1).data, []
    done = threading.Event()

    def tick() -> None:
        while not done.wait(0.001):
            ticks.append(time.monotonic())

    watcher = threading.Thread(target=tick)
    watcher.start()
    started = time.monotonic()
    dn.calibrate(drawn, run)
    lasted = time.monotonic() - started
    done.set()
    watcher.join()
    within = [tick for tick in ticks if tick > started]
    # The longest silence of the other thread is a small part of the fit.
    assert max(np.diff([started, *within])) < max(0.25, 0.5 * lasted)


@pytest.mark.parametrize("terminal", [True, False])
def test_progress_on_a_terminal_is_taken_away(terminal: bool, monkeypatch: pytest.MonkeyPatch, drawn: dn.Chain) -> None:
    class Terminal:
        text = ""

        def isatty(self) -> bool:
            return terminal

        def write(self, text: str) -> None:
            self.text += text

        def flush(self) -> None:
            pass

    shown = Terminal()
    monkeypatch.setattr(sys, "stderr", shown)
    dn.calibrate(drawn, tracker(), effects=None)
    assert ("fitting the geometry" in shown.text) == terminal
    assert shown.text.endswith("\r\033[K") == terminal


def test_both_hands_of_a_robot_are_one_fit(tmp_path: Path) -> None:
    robot = dn.load(TOP / "robots/rethink/baxter.urdf")
    hands = ("left_hand", "right_hand")
    chains = {hand: robot.chain("torso", hand) for hand in hands}
    alone = {hand: chain.simulate(60, measure="poses", seed=3) for hand, chain in chains.items()}
    joints = [coordinate.name for hand in hands for coordinate in chains[hand].coordinates]
    lines = [",".join([*joints, "x,y,z,qx,qy,qz,qw", "tip", "setup"])]
    for hand, run in alone.items():
        own = [line for line in run.data.text.splitlines() if not line.startswith("#")][1:]
        for line in own:
            cells = line.split(",")
            values, rest = cells[:7], cells[7:]
            readings = [*values, *[""] * 7] if hand == "left_hand" else [*[""] * 7, *values]
            lines.append(",".join([*readings, *rest, hand, hand]))
    file = tmp_path / "both.csv"
    file.write_text("\n".join(lines) + "\n")
    data = dn.Measurements.read(file)
    fit = dn.calibrate(chains["left_hand"], data, tips=hands)
    assert [tip["tip"] for tip in fit.to_dict()["tips"]] == list(hands) and not fit.effects
    assert fit.chain.tip == "left_hand" and pickle.loads(pickle.dumps(fit)).robot == fit.robot
    assert len(fit.predict(data).residuals.rows) == 120
    for hand, chain in chains.items():
        # An instrument for each arm: what was fitted together is what is fitted alone.
        single = dn.calibrate(chain, alone[hand].data, effects=None)
        q = np.linspace(-0.5, 0.5, 7)
        together = fit.robot.chain("torso", hand, exact=True).fk(q)
        assert np.allclose(together, single.chain.fk(q), atol=2e-5)
    with pytest.raises(dn.ArgumentError, match='the chain ends at "left_hand"'):
        dn.calibrate(chains["left_hand"], data, tips=["right_hand"])
    # Effects are looked for in both arms, and those of the chain's tip go with the chain.
    traced = dn.calibrate(chains["left_hand"], data, tips=hands, effects=["backlash"])
    assert not traced.effects
    assert json.loads(traced.effects_json)["joints"] == joints[:7]
