"""A small change of the observation matrix is kept without its zeros, and is the same at any of its samples."""

import numpy as np

from bench.identification.perturbed_observation import KEPT, small_change

SAMPLES, MOTORS, COLUMNS = 30, 3, 8


def test_rows_are_the_same_and_zeros_take_nothing():
    rows = np.random.default_rng(3).normal(size=(SAMPLES, MOTORS, COLUMNS))
    rows[:, 0, [1, 4]] = 0.0
    rows[:, 1] = 0.0
    rows[:20, 2, 5] = 0.0
    change = small_change(rows)
    assert change.values.nbytes == (2 * COLUMNS - 2) * SAMPLES * np.dtype(KEPT).itemsize
    part = slice(10, 25)
    np.testing.assert_array_equal(change.rows(part), rows[part].astype(KEPT))
