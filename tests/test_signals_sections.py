"""Second-order sections beside those of scipy.signal."""

import numpy as np
import pytest
from scipy import signal

from bench.signals.bounds import BLOCKS
from bench.signals.filtering import at_rest, butterworth, chebyshev, filtered, response

ROUNDING = 1e-11  # a pole at 0.997 makes ten thousand of one
CUTOFFS = (0.002, 0.05, 0.3, 0.8, 0.97)


def designs():
    for cutoff in CUTOFFS:
        for order in (1, 2, 3, 4, 5, 8):
            yield butterworth(order, cutoff), signal.butter(order, cutoff, output="sos")
            yield chebyshev(order, 0.05, cutoff), signal.cheby1(order, 0.05, cutoff, output="sos")


def test_gains_are_those_of_scipy():
    angle = np.pi * np.linspace(0.0, 1.0, 400)[:-1]
    for own, theirs in designs():
        expected = signal.freqz_sos(theirs, worN=angle)[1]
        np.testing.assert_allclose(response(own, angle), expected, rtol=1e-9, atol=1e-12)
        np.testing.assert_allclose(response(theirs, angle), expected, rtol=1e-9, atol=1e-15)


def test_ones_for_ever_leave_the_resting_states():
    for own, _ in designs():
        resting = at_rest(own)
        np.testing.assert_allclose(resting, signal.sosfilt_zi(own), rtol=1e-9)
        outputs, after = filtered(own, np.ones(3 * BLOCKS.section), resting)
        np.testing.assert_allclose(outputs, response(own, np.zeros(1)).real[0], rtol=1e-9)
        np.testing.assert_allclose(after, resting, rtol=1e-9)


@pytest.mark.parametrize(
    "samples", [1, 2, BLOCKS.section - 1, BLOCKS.section, BLOCKS.section + 1, 10 * BLOCKS.section + 7]
)
@pytest.mark.parametrize("shape", [(), (1,), (3,), (2, 3)])
def test_outputs_and_states_are_those_of_scipy(samples, shape):
    random = np.random.default_rng(samples)
    for own, _ in designs():
        x = random.normal(size=(samples, *shape)) + 5.0
        states = random.normal(size=(len(own), 2, *shape))
        outputs, after = filtered(own, x, states)
        expected, last = signal.sosfilt(own, x, axis=0, zi=states)
        rounding = ROUNDING * (np.abs(expected).max() + np.abs(last).max())
        assert np.abs(outputs - expected).max() < rounding
        assert np.abs(after - last).max() < rounding


def test_nothing_gives_nothing():
    states = np.ones((2, 2, 3))
    outputs, after = filtered(butterworth(4, 0.1), np.empty((0, 3)), states)
    assert outputs.shape == (0, 3)
    np.testing.assert_array_equal(after, states)
