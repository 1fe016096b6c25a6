"""MJCF compared with MuJoCo: round trips of our own robots, and models from other sources, if available."""

import numpy as np
import pytest

pytest.importorskip("mujoco", reason="skipped, because mujoco is not installed")

import corpus  # noqa: E402
import mjcf  # noqa: E402

OWN = sorted((corpus.WORKSPACE / "robots").rglob("*.urdf"))
MODELS = mjcf.models()


@pytest.mark.parametrize("path", OWN, ids=lambda path: path.stem)
def test_what_is_written_is_the_robot_in_mujoco_and_the_same_by_diff(path, tmp_path):
    (frames, apart, _, heavy), lost, same, said = mjcf.written(path, tmp_path, np.random.default_rng(0))
    assert frames > 0 and apart <= mjcf.NEAR and heavy <= mjcf.NEAR
    changed = any(kind.startswith("its inertia: MuJoCo refuses") for kind in lost)
    assert same or changed, said


@pytest.mark.skipif(not MODELS, reason="skipped, because ../shared/vendor/mjcf is not there")
def test_models_of_others_are_read_as_mujoco_reads_them():
    exact = 0
    for path in MODELS:
        if "<body" not in path.read_text() and "<include" not in path.read_text():
            continue
        if path.name == "filtered_cartesian_actuators.xml":
            # A file without bodies of its own.
            continue
        frames, apart, _, heavy = mjcf.read(path, np.random.default_rng(0))
        assert frames > 0 and apart <= mjcf.NEAR and heavy <= mjcf.NEAR, path
        exact += 1
    assert exact >= 50
