"""Every hidden effect that is a law of the joint's own state obeys that law, recomputed from the true states.

The extra torque of the motors, beyond what the machine without hidden effects needs at these states, is the
law; where the effect lies in the drive, the torque of the motor and the logged current tell it.
"""

import functools
import itertools

import numpy as np
import pytest
from scipy.signal import lsim

from bench.scenario.scenario import load_scenario
from bench.truth.simulate import simulate
from tests import hidden_kit
from tests.hidden_kit import BRIEF, STEP, states

run = functools.partial(hidden_kit.run, design=BRIEF)
at_every_step = functools.partial(run, every_step=True, recordings=("free",))
SLOW = 0.02  # rad/s: below, dry friction sticks

TORQUES = {
    "viscous_friction": ({"Fv": 0.15}, lambda s: 0.15 * s.v),
    "quadratic_drag": ({"c": 0.04}, lambda s: 0.04 * s.v * abs(s.v)),
    "asymmetric_viscous_friction": (
        {"Fv_plus": 0.1, "Fv_minus": 0.25},
        lambda s: np.where(s.v > 0, 0.1 * s.v, 0.25 * s.v),
    ),
    "shear_thinning_friction": ({"Fa": 0.2, "va": 0.3}, lambda s: 0.2 * np.arcsinh(s.v / 0.3)),
    "constant_offset": ({"c": -0.2}, lambda s: -0.2 + 0 * s.v),
    "joint_spring": ({"k": 1.5, "q0": -2.0}, lambda s: 1.5 * (s.q + 2.0)),
    "cogging_torque": (
        {"a": 0.1, "b": -0.3, "period": 0.4},
        lambda s: 0.1 * np.cos(2 * np.pi * s.q / 0.4) - 0.3 * np.sin(2 * np.pi * s.q / 0.4),
    ),
    "rotor_inertia": ({"Ia": 0.02}, lambda s: 0.02 * s.a),
    "current_crosstalk": ({"c": 0.07}, lambda s: 0.07 * (s.torque.sum(axis=1, keepdims=True) - s.torque)),
    "periodic_disturbance": (
        {"size": 0.3, "frequency": 7.0, "phase": 0.4},
        lambda s: 0.3 * np.sin(2 * np.pi * 7 * s.t + 0.4) + 0 * s.v,
    ),
    "position_dependent_viscous_friction": (
        {"a": 0.1, "b": 0.05, "harmonic": 3},
        lambda s: (0.1 * np.cos(3 * s.q) + 0.05 * np.sin(3 * s.q)) * s.v,
    ),
}


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
@pytest.mark.parametrize("effect", TORQUES)
def test_torques(effect, robot):
    parameters, law = TORQUES[effect]
    for s in states(run(robot, {"effect": effect, **parameters}), robot):
        np.testing.assert_allclose(s.extra, law(s), atol=1e-11 * abs(s.torque).max())


DRY = {
    "coulomb_friction": ({"Fc": 0.3}, lambda s: 0.3),
    "stribeck_friction": (
        {"Fc": 0.2, "Fs": 0.25, "vs": 0.4, "delta": 1.5},
        lambda s: 0.2 + 0.25 * np.exp(-((abs(s.v) / 0.4) ** 1.5)),
    ),
    "load_dependent_friction": ({"mu": 0.08}, lambda s: 0.08 * abs(s.torque)),
    "thermal_friction_drift": (
        {"T": 0.7, "Fv": 0.2, "Fc": 0.3},
        lambda s: (0.3 + 0.2 * abs(s.v)) * np.exp(-s.t / 0.7),
    ),
}


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
@pytest.mark.parametrize("effect", DRY)
def test_dry_frictions_once_they_slide(effect, robot):
    parameters, law = DRY[effect]
    for s in states(run(robot, {"effect": effect, **parameters}), robot, slowest=SLOW):
        np.testing.assert_allclose(s.extra, law(s) * np.sign(s.v), atol=1e-10 * abs(s.torque).max())


def test_position_dependent_friction_needs_the_rest_to_keep_it_from_being_negative():
    hidden = (
        {"effect": "position_dependent_friction", "joint": "left", "a": 0.1, "b": -0.2, "harmonic": 2},
        {"effect": "coulomb_friction", "joint": "left", "Fc": 0.25},
    )
    for s in states(run("five_bar", *hidden), "five_bar", slowest=SLOW):
        size = 0.25 + 0.1 * np.cos(2 * s.q[:, 0]) - 0.2 * np.sin(2 * s.q[:, 0])
        np.testing.assert_allclose(s.extra[:, 0], size * np.sign(s.v[:, 0]), atol=1e-10)
        np.testing.assert_allclose(s.extra[:, 1], 0, atol=1e-10)


def test_acceleration_dependent_friction_follows_the_acceleration_of_the_step_before():
    simulation = at_every_step("five_bar", {"effect": "acceleration_dependent_friction", "c": 0.01})
    for s in states(simulation, "five_bar", step=1):
        sliding = (abs(s.v[1:]) > SLOW).all(axis=1) & (np.diff(s.t[:, 0]) < 1.2 * STEP)
        law = 0.01 * abs(s.a[:-1]) * np.sign(s.v[1:])
        np.testing.assert_allclose(s.extra[1:][sliding], law[sliding], atol=1e-10)


def test_dry_friction_holds_a_joint_at_standstill():
    still = {"optimise": False, "span": 1e-9, "velocity_limit": 1.0, "duration": 1.0, "ramp": 0.2}
    recordings = [{"name": "still", "use": "identify", "design": still}]
    hidden = [{"effect": "stribeck_friction", "Fc": 5.0, "Fs": 45.0, "vs": 0.01}]
    simulation = simulate(load_scenario("five_bar", {"recordings": recordings, "hidden": hidden}))
    motion = simulation.recordings[0].motion
    assert np.abs(motion.qvel).max() < 1e-3
    assert np.abs(motion.torque).max() < 0.1  # the brake carries the weight, not the motor


GAINS = {
    "gain_saturation": ({"k": 4e-3}, lambda s: 1 - 4e-3 * s.current**2),
    "torque_ripple": (
        {"a": 0.05, "b": -0.03, "period": 0.3},
        lambda s: 1 + 0.05 * np.cos(2 * np.pi * s.q / 0.3) - 0.03 * np.sin(2 * np.pi * s.q / 0.3),
    ),
    "speed_dependent_gain": ({"v0": 40.0}, lambda s: 1 - abs(s.v) / 40),
}


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
@pytest.mark.parametrize("effect", GAINS)
def test_drive_gains(effect, robot):
    parameters, factor = GAINS[effect]
    for s in states(run(robot, {"effect": effect, **parameters}), robot):
        np.testing.assert_allclose(s.torque, s.gains * s.current * factor(s), rtol=1e-12)
        # and nothing else is changed
        np.testing.assert_allclose(s.extra, 0, atol=1e-11 * abs(s.torque).max())


@pytest.mark.parametrize("steps", [5, 8.25, -12, -6.5])
def test_current_delay(steps):
    """τ(t) = g i(t - T) for both signs of T; what flows is what the robot needs."""
    delay = steps * STEP
    simulation = at_every_step("five_bar", {"effect": "current_delay", "joint": "right", "T": delay})
    for s in states(simulation, "five_bar", step=1):
        grid = np.arange(len(s.t))
        inside = (grid - steps > 0) & (grid - steps < len(grid) - 1)
        flowing = s.torque / s.gains
        if steps > 0:
            expected = np.interp(grid - steps, grid, s.current[:, 1])
            np.testing.assert_allclose(flowing[inside, 1], expected[inside], atol=1e-10)
        else:  # logged late: what is logged now flowed then
            expected = np.interp(grid + steps, grid, flowing[:, 1])
            late = grid > -steps
            np.testing.assert_allclose(s.current[late, 1], expected[late], atol=1e-10)
        np.testing.assert_allclose(flowing[:, 0], s.current[:, 0], atol=1e-12)
        np.testing.assert_allclose(s.extra, 0, atol=1e-10)


def test_current_loop_lag():
    simulation = at_every_step("five_bar", {"effect": "current_loop_lag", "T": 0.004})
    for s in states(simulation, "five_bar", step=1):
        flowing, time = s.torque / s.gains, STEP * np.arange(len(s.current))
        for j in range(flowing.shape[1]):  # straight between two steps
            first = flowing[0, j] * 0.004
            expected = lsim(([1.0], [0.004, 1.0]), s.current[:, j], time, X0=first)[1]
            np.testing.assert_allclose(flowing[:, j], expected, atol=1e-9)
        np.testing.assert_allclose(s.extra, 0, atol=1e-10)


@pytest.mark.parametrize("robot", ["five_bar", "delta"])
def test_presliding_hysteresis_is_dahl_s(robot):
    """Integrated here over the true positions: each step being a piece of one direction, the last one a line."""
    size = 0.4 if robot == "five_bar" else 20.0
    reach = 0.02
    effect = {"effect": "presliding_hysteresis", "Fc": size, "stiffness": size / reach}
    for s in states(at_every_step(robot, effect), robot, step=1):
        moves = np.diff(s.q, axis=0)
        z = s.extra[1] / (size / reach)
        z = (z - moves[0]) / (1 - abs(moves[0]) / reach)
        present = [z + moves[0] * (1 - np.sign(moves[0]) * z / reach)]
        for before, move in itertools.pairwise(moves):
            end = np.sign(before) * reach
            z = end + (z - end) * np.exp(-abs(before) / reach)
            present.append(z + move * (1 - np.sign(move) * z / reach))
        torque = np.array(present) * size / reach
        np.testing.assert_allclose(s.extra[1:], torque, atol=2e-9 * size)
        assert abs(torque).max() > 0.98 * size
        assert abs(torque).max() <= size * (1 + 1e-12)


def test_viscoelastic_cable():
    simulation = at_every_step("five_bar", {"effect": "viscoelastic_cable", "k": 2.0, "T": 0.3})
    for s in states(simulation, "five_bar", step=1):
        z, stay = s.extra / 2.0, np.exp(-STEP / 0.3)
        grown = stay * z[:-1] + (1 - stay) * 0.3 / STEP * np.diff(s.q, axis=0)
        np.testing.assert_allclose(z[1:], grown, atol=1e-10)


def test_torque_drift_is_slow_as_large_as_told_and_another_one_everywhere():
    effect = {"effect": "torque_drift", "size": 0.2, "T": 0.2, "seed": 5}
    courses = []
    for s in states(hidden_kit.run("five_bar", effect), "five_bar", step=1):
        courses += [s.extra[:, 0], s.extra[:, 1]]
    for course in courses:
        assert 0.08 < np.sqrt(np.mean(course**2)) < 0.4
        # no wave is faster than ω = 2 / T
        assert abs(np.diff(course)).max() < 0.001 * (2 / 0.2) * np.sqrt(24) * 0.2
    similar = np.corrcoef(courses) - np.eye(4)
    assert abs(similar).max() < 0.8
    (again, *_) = states(hidden_kit.run("five_bar", effect), "five_bar", step=1)
    np.testing.assert_array_equal(again.extra[:, 0], courses[0])
    (other, *_) = states(hidden_kit.run("five_bar", effect | {"seed": 6}), "five_bar", step=1)
    assert abs(other.extra[:, 0] - courses[0]).max() > 0.05
