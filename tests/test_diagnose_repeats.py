"""What a log does not repeat where its motion returns."""

import numpy as np
import pytest

from bench.diagnosis.noise import not_repeated
from bench.identification.result import CurrentSeries

NOISE = 0.02


def series(period: float, *, drift: float = 0.0, standing: bool = False) -> CurrentSeries:
    """20 s at 20 Hz; currents with errors that come again with the motion, and noise that does not."""
    time = np.arange(400) / 20.0
    angle = 2.0 * np.pi * time / period
    position = np.column_stack((np.sin(angle), 0.3 * np.cos(angle) + 0.1 * np.sin(2.0 * angle)))
    position += drift * time[:, None]
    random = np.random.default_rng(1)
    measured = 2.0 * position + 0.3 * position**3 + NOISE * random.standard_normal(position.shape)
    moving = np.ones(position.shape, dtype=bool)
    if standing:
        moving[:, 1] = False
    return CurrentSeries(
        "log", "identify", None, time, measured, 2.0 * position, position, position, position, moving
    )


@pytest.mark.parametrize("standing", [False, True])
def test_noise_is_not_repeated_and_a_model_s_error_is(standing: bool) -> None:
    one = series(6.48, standing=standing)
    size = float(np.sqrt((one.measured[one.moving] ** 2).mean()))
    assert np.sqrt((one.error[one.moving] ** 2).mean()) > 2.0 * NOISE
    assert not_repeated([one]) == pytest.approx(NOISE / size, rel=0.15)


@pytest.mark.parametrize("one", [series(24.0), series(6.48, drift=0.05)])
def test_where_the_motion_never_returns_there_is_nothing_to_tell(one: CurrentSeries) -> None:
    assert not_repeated([one]) is None
