"""The way of a link through the play of its drive: its differential equation, and a machine that has it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from bench.effects import places_in, select_effects
from bench.effects.play import Flight, Load
from bench.excitation.scenario import designer
from bench.identification.identify import fit
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.signals.decimation import noise_bandwidth
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

INTERVAL, SAMPLES = 0.004, 900
ROTOR = 0.1
NOISE = 0.005  # of the RMS current


def load_of(waves: float = 1.0) -> Load:
    time = INTERVAL * np.arange(SAMPLES)
    torque = 3.0 * np.sin(4.0 * time) + waves * np.sin(11.0 * time + 0.4) + 0.5
    return Load(torque, 2.0 * np.cos(5.0 * time), 0.4 + 0.05 * np.sin(2.0 * time), INTERVAL)


def crossed(load: Load, rotor: float, drag: float, play: float) -> np.ndarray:
    """The lag of a link that its differential equation moves from flank to flank, one crossing after the other."""
    time = INTERVAL * np.arange(SAMPLES)

    def at(t: float) -> tuple[float, float]:
        torque, acceleration, inertia = (
            float(np.interp(t, time, x)) for x in (load.torque, load.acceleration, load.inertia)
        )
        return (torque - rotor * acceleration) / (inertia - rotor), drag / (inertia - rotor)

    def rate(t: float, state: np.ndarray) -> list[float]:
        push, damping = at(t)
        return [state[1], push - damping * state[1]]

    def met(_: float, state: np.ndarray) -> float:
        return abs(state[0]) - 0.5 * play

    met.terminal = True  # type: ignore[attr-defined]
    met.direction = 1.0  # type: ignore[attr-defined]
    lag, side, now = np.empty(SAMPLES), float(np.sign(at(0.0)[0])), 0.0
    fine = np.linspace(0.0, time[-1], 100 * SAMPLES)
    torque, acceleration, inertia = (
        np.interp(fine, time, x) for x in (load.torque, load.acceleration, load.inertia)
    )
    pushes = (torque - rotor * acceleration) / (inertia - rotor)
    while True:
        away = np.flatnonzero((fine >= now) & (pushes * side < 0.0))
        leaves = fine[away[0]] if len(away) else np.inf
        lag[time >= now] = 0.5 * play * side
        if not np.isfinite(leaves):
            return lag
        way = solve_ivp(
            rate,
            (leaves, time[-1]),
            [0.5 * play * side * (1.0 - 1e-9), 0.0],
            events=met,
            dense_output=True,
            max_step=0.01,
        )
        free = (time >= leaves) & (time <= way.t[-1])
        lag[free] = way.sol(time[free])[0]
        if way.status == 0:
            return lag
        now, side = float(way.t[-1]), float(np.sign(way.y[0, -1]))


@pytest.mark.parametrize("drag", [0.0, 2.0, 100.0])
@pytest.mark.parametrize("play", [1e-3, 0.02, 0.1])
def test_a_link_crosses_the_gap_as_its_differential_equation_says(drag: float, play: float) -> None:
    load = load_of()
    lag = Flight.under(load, ROTOR, drag).lag(play)
    assert np.abs(lag).max() <= 0.5 * play
    assert np.abs(lag - crossed(load, ROTOR, drag, play)).max() < 0.03 * play
    assert np.ptp(lag) > 0.1 * play


def test_a_link_that_is_always_pressed_on_one_flank_stays_there() -> None:
    load = replace(load_of(), torque=np.full(SAMPLES, -5.0), acceleration=np.zeros(SAMPLES))
    flight = Flight.under(load, ROTOR, 1.0)
    assert not flight.happens
    assert np.all(flight.lag(0.01) == -0.005)


def test_the_lag_changes_little_with_the_play() -> None:
    flight = Flight.under(load_of(), ROTOR, 1.0)
    small, large = flight.lag(0.02), flight.lag(0.02 * 1.0001)
    assert np.abs(large - small).max() < 1e-3 * 0.02


def test_play_rotor_and_drag_of_a_wrist_are_found_and_leave_noise() -> None:
    """Half a degree that a motor crosses with its rotor three times as heavy as its link."""
    hidden = {"effect": "backlash", "joint": "motor_4", "play": 8.7e-3, "stiffness": 19.0, "damping": 2.9e-3}
    sensors = {"encoder_bits": 20, "current_noise_ratio": NOISE}
    scenario = load_scenario("wrist", {"hidden": [hidden], "sensors": sensors, "gains": {}})
    dataset = as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))
    prepared = prepare(problem_of(dataset))
    added = select_effects(["backlash:motor_4"], places_in(prepared.model.geometry, dataset.payloads))
    result = fit(with_effects(prepared, added))
    passed = float(np.sqrt(noise_bandwidth(result.settings.decimation)))
    assert (result.error.validate or np.inf) < 1.1 * NOISE * passed < (fit(prepared).error.validate or 0.0)
    estimated = result.effect_parameters["backlash"]["motor_4"]
    assert estimated["b"].value == pytest.approx(8.7e-3, rel=0.05)
    assert estimated["Ia"].value == pytest.approx(1.1e-5, rel=0.03)
