"""Sensors: quantisation, noise of the stated size, independent streams."""

import numpy as np
import pytest

from bench.scenario.tables import Sensors
from bench.truth.sensors import sense
from bench.truth.streams import stream

JOINTS = ("left", "right")
TIME = np.arange(40_000) * 1e-3
POSITION = np.column_stack([np.sin(TIME), 0.3 * np.cos(2 * TIME)])
CURRENT = np.column_stack([2.0 * np.cos(3 * TIME), 0.5 + 0.1 * np.sin(TIME)])


def log(seed=1, name="run", **settings):
    return sense(Sensors(**settings), JOINTS, seed, name, TIME, POSITION, CURRENT)


def test_perfect_sensors_log_the_truth():
    perfect = log()
    np.testing.assert_array_equal(perfect.time, TIME)
    np.testing.assert_array_equal(perfect.position, POSITION)
    np.testing.assert_array_equal(perfect.current, CURRENT)
    np.testing.assert_array_equal(perfect.position_error, 0)


def test_an_encoder_gives_whole_steps():
    step = 2 * np.pi / 2**12
    logged = log(encoder_bits=12)
    counts = logged.position / step
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-9)
    assert np.abs(logged.position - POSITION).max() <= step / 2 * (1 + 1e-9)
    np.testing.assert_allclose(logged.position_error, step / np.sqrt(12), rtol=0.02)


def test_resolution_per_joint():
    logged = log(encoder_resolution={"left": 0.01, "right": 0.0})
    np.testing.assert_allclose(
        logged.position[:, 0] / 0.01, np.round(logged.position[:, 0] / 0.01), atol=1e-9
    )
    np.testing.assert_array_equal(logged.position[:, 1], POSITION[:, 1])


def test_noise_has_the_stated_deviation_and_is_white():
    logged = log(position_noise=1e-4, current_noise={"left": 0.02, "right": 0.05}, time_jitter=1e-5)
    for error, deviation in (
        (logged.position - POSITION, [1e-4, 1e-4]),
        (logged.current - CURRENT, [0.02, 0.05]),
        ((logged.time - TIME)[:, None], [1e-5]),
    ):
        np.testing.assert_allclose(error.std(axis=0), deviation, rtol=0.02)
        assert (np.abs(error.mean(axis=0)) < 4 * np.array(deviation) / np.sqrt(len(TIME))).all()
        lagged = (error[1:] * error[:-1]).mean(axis=0) / error.var(axis=0)
        assert (np.abs(lagged) < 4 / np.sqrt(len(TIME))).all()


def test_current_noise_as_a_share_of_the_current():
    logged = log(current_noise_ratio=0.01)
    rms = np.sqrt((CURRENT**2).mean(axis=0))
    np.testing.assert_allclose(logged.current_noise, 0.01 * rms)
    np.testing.assert_allclose(logged.current_error, 0.01 * rms, rtol=0.02)


def test_current_is_quantised_after_the_noise():
    logged = log(current_noise=0.01, current_resolution=0.004)
    np.testing.assert_allclose(logged.current / 0.004, np.round(logged.current / 0.004), atol=1e-9)
    assert logged.current_error == pytest.approx(np.sqrt(0.01**2 + 0.004**2 / 12), rel=0.02)


def test_channels_recordings_and_seeds_have_streams_of_their_own():
    one = log(current_noise=1.0, position_noise=1.0)
    errors = [one.current[:, 0] - CURRENT[:, 0], one.current[:, 1] - CURRENT[:, 1]]
    errors += [one.position[:, 0] - POSITION[:, 0]]
    errors += [log(name="other", current_noise=1.0).current[:, 0] - CURRENT[:, 0]]
    errors += [log(seed=2, current_noise=1.0).current[:, 0] - CURRENT[:, 0]]
    correlation = np.corrcoef(errors) - np.eye(len(errors))
    assert np.abs(correlation).max() < 4.5 / np.sqrt(len(TIME))


def test_a_channel_does_not_depend_on_the_settings_of_another():
    np.testing.assert_array_equal(
        log(current_noise=0.1).current, log(current_noise=0.1, position_noise=1.0, time_jitter=1e-5).current
    )


def test_a_stream_depends_on_its_names_alone():
    assert stream(1, "a", "b").random() == stream(1, "a", "b").random()
    assert stream(1, "a", "b").random() != stream(1, "b", "a").random()
