"""What is decimated from few samples is what all of them give."""

import numpy as np
import pytest

from bench.signals.decimation import decimate, decimate_sparse, decimated_indices, fit_band
from bench.signals.filtering import low_pass

LENGTH = 5003


def smooth(factor: int) -> np.ndarray:
    """Columns without anything far above the band: noise, a slope, and a constant."""
    random = np.random.default_rng(7)
    noise = low_pass(random.standard_normal((LENGTH, 2)), 1.0, 1.5 * fit_band(1.0, factor))
    return np.column_stack((noise, np.linspace(-1.0, 2.0, LENGTH), np.full(LENGTH, 3.0)))


@pytest.mark.parametrize(("factor", "every"), [(11, 3), (20, 6), (42, 13), (60, 18)])
def test_columns_that_are_smooth_between_few_samples_are_decimated_as_from_all(factor, every):
    columns = smooth(factor)
    wanted = decimate(columns, factor)
    found = decimate_sparse(columns[::every], every, LENGTH, factor)
    assert found.shape == wanted.shape == (len(decimated_indices(LENGTH, factor)), columns.shape[1])
    scale = np.sqrt((wanted**2).mean(axis=0))
    off = found - wanted
    assert np.all(np.sqrt((off[15:-15] ** 2).mean(axis=0)) < 1e-3 * scale)
    assert np.all(np.sqrt((off**2).mean(axis=0)) < 0.1 * scale)
    np.testing.assert_allclose(found[:, -1], wanted[:, -1], rtol=1e-9)


def test_what_the_filter_stops_is_stopped():
    factor, every = 20, 6
    time = np.arange(LENGTH)
    fast = np.cos(2.0 * np.pi * 3.0 * fit_band(1.0, factor) * time)[:, None]
    found = decimate_sparse(fast[::every], every, LENGTH, factor)
    assert np.abs(found[30:-30]).max() < 1e-3
