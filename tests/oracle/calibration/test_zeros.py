"""Zeros of joints beside scipy's least squares on the same rows: zeros_scipy.py."""

import numpy as np

import built
from zeros_scipy import compared


def test_zeros_come_out_as_by_least_squares() -> None:
    ours, scipys = np.sqrt(np.square(compared(built.denavit(), 15, [4, 5])).mean(axis=(0, 2)))
    assert ours <= 1.03 * scipys, (ours, scipys)
    assert scipys < 1e-4
