"""What is left when the ladder ends: noise, something that varies with the motion, blows, or encoders' noise."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnose.unexplained import unexplained
from bench.robot import load_robot
from tests.shown import dataset_of, identification_of


@pytest.fixture(scope="module")
def gentle():
    dataset = dataset_of(load_robot("five_bar"), duration=30.0)
    return dataset, identification_of(dataset)


def _left(gentle, error):
    """The verdict where error(row, random) is left, in times the deviation of the currents' noise in the fit."""
    dataset, result = gentle
    random = np.random.default_rng(3)
    noise = 0.01 / 5  # white noise of 0.01, one sample in 25 kept
    series = tuple(
        replace(one, modelled=one.measured - noise * error(one, random.standard_normal(one.measured.shape)))
        for one in result.recordings
    )
    return unexplained(replace(result, recordings=series), dataset.recordings)


def test_noise_is_noise(gentle):
    left = _left(gentle, lambda row, noise: noise)
    assert not left.significant
    assert "is what the noise of the currents leaves" in left.why


def test_white_errors_beyond_the_currents_noise_are_not_called_the_currents_noise(gentle):
    left = _left(gentle, lambda row, noise: 3.0 * noise)
    assert not left.significant
    assert left.depends_on == ()
    assert "varies with nothing, as the noise of encoders" in left.why


def test_errors_that_follow_the_velocity_are_unexplained(gentle):
    left = _left(gentle, lambda row, noise: noise + 5.0 * row.velocity / row.velocity.std())
    assert left.significant
    assert "velocity" in left.depends_on


def test_two_blows_in_half_a_minute_are_unexplained(gentle):
    """As play that is crossed seldom: each rings for some rows, and with no quantity in particular."""

    def blows(row, noise):
        ringing = np.zeros_like(noise)
        for start in (300, 900):
            ringing[start : start + 6] = 60.0 * (-1.0) ** np.arange(6)[:, None]
        return noise + ringing

    left = _left(gentle, blows)
    assert left.significant
    assert "time" in left.depends_on
