"""Periods of what repeats with the position: found from the error, and how far small steps may move them."""

import numpy as np
import pytest

from bench.effects import CATALOGUE, JointSamples, periods


def samples(true: float) -> tuple[JointSamples, ...]:
    """A joint that swings over two radians, with an error that repeats."""
    time = np.linspace(0.0, 10.0, 1500)
    position = np.sin(1.3 * time) + 0.1 * np.sin(4.0 * time)
    velocity = np.gradient(position, time)
    return (
        JointSamples(
            position=position,
            velocity=velocity,
            motor_torque=np.ones_like(time),
            error=np.cos(true * position + 0.4) + 0.3 * np.sin(9.0 * time),
            duration=10.0,
            speed=float(np.sqrt((velocity**2).mean())),
            travel=float(np.ptp(position)),
            band=20.0,
            rotates=True,
        ),
    )


@pytest.mark.parametrize("true", [7.3, 31.0])
def test_the_periods_that_stand_out_are_found_in_parts_as_at_once(true, monkeypatch):
    seen = samples(true)
    found = periods.strongest_periods(seen, [np.ones(1500)])
    assert any(low <= true <= high for low, _, high in found)
    monkeypatch.setattr(periods, "TOGETHER", 4000)
    np.testing.assert_allclose(periods.strongest_periods(seen, [np.ones(1500)]), found, rtol=1e-12)


@pytest.mark.parametrize("name", ["cogging_torque", "torque_ripple", "transmission_error"])
def test_small_steps_stay_at_a_peak_without_looking_for_others(name, monkeypatch):
    seen = samples(12.0)
    effect = type(CATALOGUE[name])(periods=12.0)
    monkeypatch.setattr(periods, "_moments", None)
    ((low, value, high),) = effect.brackets_near(effect.shape[0], seen)
    assert low < value == 12.0 < high
    assert high - low == pytest.approx(4.0 * np.pi / seen[0].travel)
