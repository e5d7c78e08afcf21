"""What is left when the ladder ends: noise, something that varies with the motion, blows, or encoders' noise."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.diagnosis.encoder_noise import encoder_error
from bench.diagnosis.reason_words import unexplained_words
from bench.diagnosis.result import Remainder, Unexplained
from bench.diagnosis.unexplained import unexplained
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.shown import dataset_of, identification_of


@pytest.fixture(scope="module")
def gentle():
    dataset = dataset_of(load_robot("five_bar"), duration=30.0)
    return dataset, identification_of(dataset)


def _left(gentle, error, encoders=0.0):
    """The verdict where error(row, random) is left, in times the deviation of the currents' noise in the fit."""
    dataset, result = gentle
    random = np.random.default_rng(3)
    noise = 0.01 / 5  # white noise of 0.01, one sample in 25 kept
    series = tuple(
        replace(one, modelled=one.measured - noise * error(one, random.standard_normal(one.measured.shape)))
        for one in result.recordings
    )
    return unexplained(replace(result, recordings=series), dataset.recordings, lambda: encoders)


def test_noise_is_noise(gentle):
    left = _left(gentle, lambda row, noise: noise)
    assert not left.significant
    assert "is at the noise floor of the currents" in unexplained_words(left)


def test_an_error_below_the_floor_is_called_so(gentle):
    noise = _left(gentle, lambda row, noise: noise)
    lower = replace(noise, error=0.7 * noise.noise_floor)
    assert "is below the noise floor of the currents" in unexplained_words(lower)


def test_white_errors_beyond_the_currents_noise_are_not_called_the_currents_noise(gentle):
    left = _left(gentle, lambda row, noise: 3.0 * noise)
    assert not left.significant
    assert left.much  # so that the gains' deviations hold what models that are as good make of them
    assert left.depends_on == ()
    assert "depends on no variable that was tested" in unexplained_words(left)


def test_what_the_encoders_noise_leaves_is_theirs(gentle):
    def error(row, noise):
        return 1.5 * noise + 0.3 * row.velocity / row.velocity.std()

    assert _left(gentle, error).significant
    left = _left(gentle, error, encoders=2.0 * _left(gentle, error).noise_floor)
    assert not left.significant
    assert "and of the encoders" in unexplained_words(left)


def test_the_encoders_noise_is_carried_through_the_model():
    """Nothing hidden, 16-bit encoders and little noise of the current: both together are what is left."""
    scenario = load_scenario(
        "five_bar",
        {
            "design": {"optimise": False, "duration": 8.0, "ramp": 0.5},
            "sensors": {"encoder_bits": 16, "current_noise_ratio": 0.002},
        },
    )
    dataset = as_dataset(simulate(scenario, threads=1))
    prepared = converged(prepare(problem_of(dataset)))
    result = fit(prepared)
    encoders = encoder_error(prepared)
    floor = unexplained(result, dataset.recordings).noise_floor
    assert encoders > floor
    assert result.error.validate == pytest.approx(np.hypot(floor, encoders), rel=0.15)


def test_noise_above_the_band_does_not_hide_a_pattern_below_it(gentle):
    """As play that rattles: the spectra then promise more noise than the errors have in all."""
    rattling = _left(gentle, lambda row, noise: 0.1 * noise + 0.3 * row.velocity / row.velocity.std())
    assert rattling.significant
    assert "velocity" in rattling.depends_on
    assert rattling.noise_floor < 0.5 * rattling.error
    quiet = _left(gentle, lambda row, noise: 0.3 * noise)
    assert not quiet.significant
    assert quiet.noise_floor == pytest.approx(quiet.error, rel=0.1)


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


def test_much_without_a_pattern_is_unexplained_unless_the_logs_do_not_repeat_it():
    """As a crosstalk between drives: 18 times the noise of the currents, ten times what the logs do not repeat."""
    crosstalk = Unexplained(Remainder.NO_PATTERN, 0.0101, 0.00055, (), 0.00016, 0.00104)
    assert crosstalk.significant
    said = unexplained_words(crosstalk)
    assert said.endswith(
        "and it depends on no variable that was tested: no effect of the catalogue explains it"
    )
    assert not replace(crosstalk, repeats=0.0095).significant
