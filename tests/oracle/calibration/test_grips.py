"""Grips of a tool by two hands compared with scipy's least squares on the same rows: grips_scipy.py."""

import numpy as np

import built
from grips_scipy import compared


def test_grips_are_fitted_as_well_as_by_least_squares_and_the_robot_keeps_its_size() -> None:
    found = compared(built.denavit(), 25, [3])
    ours, expected, plain = (found[name][0] for name in ("denavit", "scipy, with tolerances", "scipy, plain"))
    assert (ours[:2] <= 1.03 * expected[:2]).all(), (ours, expected)
    assert abs(ours[2] - 1) < 0.03
    # Without tolerances the scatter is smallest for a small robot.
    assert plain[2] < 0.95 and np.isfinite(plain).all()
