"""The deflection of an inertia on a spring against a differential equation solved step by step."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.effects.laws.drive_flexibility import deflection

INTERVAL = 0.01


def settled(time: np.ndarray) -> np.ndarray:
    return 1e-3 * (np.sin(9.0 * time) + 0.4 * np.cos(31.0 * time + 0.5) + 0.7 * np.tanh(20 * (time - 1.0)))


@pytest.mark.parametrize("frequency", [4.0, 12.0, 30.0])
@pytest.mark.parametrize("damping", [0.0, 0.06, 0.5])
def test_a_changing_inertia_swings_as_its_differential_equation_says(
    frequency: float, damping: float
) -> None:
    time = INTERVAL * np.arange(250)

    def squared(t: np.ndarray) -> np.ndarray:
        return (1.0 + 0.2 * np.sin(3.0 * t)) / (2 * np.pi * frequency) ** 2

    def rate(t: float, state: np.ndarray) -> list[float]:
        now = float(squared(np.array(t)))
        aim = float(settled(np.array(t)))
        return [state[1], (aim - state[0] - 2 * damping * np.sqrt(now) * state[1]) / now]

    start = settled(np.array([0.0, 1e-7]))
    exact = solve_ivp(
        rate, (0.0, time[-1]), [start[0], np.diff(start)[0] / 1e-7], t_eval=time, rtol=1e-9, atol=1e-12
    )
    found = deflection(settled(time)[:, None], INTERVAL, squared(time), damping)[:, 0]
    assert np.abs(found - exact.y[0]).max() < 0.01 * np.abs(exact.y[0]).max()


def test_a_stiff_spring_gives_way_at_once() -> None:
    time = INTERVAL * np.arange(200)
    aim = np.stack((settled(time), -settled(time)), axis=1)
    found = deflection(aim, INTERVAL, np.full(200, 1e-12), 0.06)
    assert found == pytest.approx(aim, abs=1e-8)
