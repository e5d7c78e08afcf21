"""The law of every effect at a single motor, written a second time."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from bench.effects import CATALOGUE, ActuatorEffect, JointSamples, JointSignals
from tests.effects_kit import joint_signals, still

Law = Callable[[JointSignals], list[np.ndarray]]

LAWS: dict[str, tuple[dict[str, float], Law]] = {
    "asymmetric_viscous_friction": (
        {},
        lambda j: [np.where(j.velocity > 0, j.velocity, 0), np.where(j.velocity < 0, j.velocity, 0)],
    ),
    "cogging_torque": ({"periods": 7.5}, lambda j: [np.cos(7.5 * j.position), np.sin(7.5 * j.position)]),
    "constant_offset": ({}, lambda j: [0 * j.time + 1]),
    "coulomb_friction": ({}, lambda j: [(j.velocity > 0) * 1.0 - (j.velocity < 0)]),
    "gain_saturation": ({}, lambda j: [2.5 * j.current**3]),
    "joint_spring": ({}, lambda j: [j.position, 0 * j.time - 1]),
    "load_dependent_friction": ({}, lambda j: [np.abs(2.5 * j.current) * np.sign(j.velocity)]),
    "position_dependent_friction": (
        {"harmonic": 2.0},
        lambda j: [
            np.cos(2 * j.position) * np.sign(j.velocity),
            np.sin(2 * j.position) * np.sign(j.velocity),
        ],
    ),
    "quadratic_drag": ({}, lambda j: [j.velocity**2 * np.sign(j.velocity)]),
    "rotor_inertia": ({}, lambda j: [j.acceleration]),
    "shear_thinning_friction": (
        {"va": 0.2},
        lambda j: [np.log(j.velocity / 0.2 + np.sqrt((j.velocity / 0.2) ** 2 + 1.0))],
    ),
    "stribeck_friction": (
        {"vs": 0.2},
        lambda j: [np.sign(j.velocity), np.sign(j.velocity) * np.exp(-((j.velocity / 0.2) ** 2))],
    ),
    "thermal_friction_drift": (
        {"T": 1.5},
        lambda j: [np.sign(j.velocity) * np.exp(-j.time / 1.5), j.velocity * np.exp(-j.time / 1.5)],
    ),
    "torque_ripple": (
        {"periods": 7.5},
        lambda j: [-2.5 * j.current * np.cos(7.5 * j.position), -2.5 * j.current * np.sin(7.5 * j.position)],
    ),
    "viscous_friction": ({}, lambda j: [j.velocity]),
}
TESTED_BELOW = {"hysteretic_cable", "presliding_hysteresis", "current_delay", "current_loop_lag"}
MOTIONLESS = {  # no torque at rest, whatever the load
    *(
        "asymmetric_viscous_friction",
        "coulomb_friction",
        "load_dependent_friction",
        "position_dependent_friction",
    ),
    *(
        "presliding_hysteresis",
        "quadratic_drag",
        "rotor_inertia",
        "shear_thinning_friction",
        "stribeck_friction",
        "thermal_friction_drift",
    ),
    "viscous_friction",
}
ACTUATOR_EFFECTS = {name: effect for name, effect in CATALOGUE.items() if isinstance(effect, ActuatorEffect)}


def columns_of(name: str, joint: JointSignals, **values: float) -> np.ndarray:
    effect = ACTUATOR_EFFECTS[name]
    return replace(effect, **values).torque(joint)


def test_every_effect_of_a_single_motor_has_its_law_here() -> None:
    assert set(LAWS) | TESTED_BELOW == set(ACTUATOR_EFFECTS)


@pytest.mark.parametrize("name", LAWS)
def test_columns_are_those_of_the_law(name: str) -> None:
    shape, law = LAWS[name]
    joint = joint_signals(band=60.0)
    inner = slice(200, -200)  # the low-pass of the motor torque has ends
    expected = np.column_stack(law(joint))
    found = columns_of(name, joint, **shape)
    assert found.shape == expected.shape == (len(joint.time), len(ACTUATOR_EFFECTS[name].parameters))
    assert found[inner] == pytest.approx(expected[inner], abs=1e-6 * np.abs(expected).max())


@pytest.mark.parametrize("name", ["cogging_torque", "torque_ripple", "position_dependent_friction"])
def test_of_a_slide_the_periods_are_those_in_a_metre(name: str) -> None:
    hinge, slide = joint_signals(), joint_signals(rotates=False)
    shape = ACTUATOR_EFFECTS[name].shape[0].name
    turns = replace(hinge, position=2 * np.pi * slide.position)
    assert columns_of(name, slide, **{shape: 3.0}) == pytest.approx(columns_of(name, turns, **{shape: 3.0}))


@pytest.mark.parametrize("name", sorted(MOTIONLESS))
def test_a_joint_at_rest_has_no_friction_and_no_inertia(name: str) -> None:
    assert not np.any(columns_of(name, still(joint_signals())))


@pytest.mark.parametrize("name", ACTUATOR_EFFECTS)
def test_the_same_signals_give_the_same_finite_columns(name: str) -> None:
    first, second = columns_of(name, joint_signals()), columns_of(name, joint_signals())
    assert np.isfinite(first).all()
    assert np.array_equal(first, second)


def brute_force_dahl(joint: JointSignals, displacement: float, every: int) -> np.ndarray:
    """Dahl's differential equation by small explicit steps, at every so many-th of them."""
    z, states = 0.0, np.zeros(len(joint.time))
    step = joint.time[1]
    for i, speed in enumerate(joint.velocity[:-1]):
        z += step * (speed - abs(speed) * z) / displacement
        states[i + 1] = z
    return states[::every]


@pytest.mark.parametrize("displacement", [0.003, 0.03, 0.3])
def test_dahl_s_friction_solves_its_differential_equation(displacement: float) -> None:
    fine = joint_signals(samples=80001, duration=4.0)
    expected = brute_force_dahl(fine, displacement, 20)
    coarse = joint_signals(samples=4001, duration=4.0)
    found = columns_of("presliding_hysteresis", coarse, x0=displacement)[:, 0]
    # an explicit step of 2 mrad/s * 50 us, and the coarse samples' own reversals
    assert found == pytest.approx(expected, abs=0.02 if displacement > 0.01 else 0.06)


def test_dahl_s_friction_becomes_coulomb_s() -> None:
    joint = joint_signals()
    found = columns_of("presliding_hysteresis", joint, x0=1e-7)[1:, 0]
    moving = np.abs(joint.velocity[1:]) > 0.01
    assert found[moving] == pytest.approx(np.sign(joint.velocity[1:])[moving])


@pytest.mark.parametrize("sharpness", [1.0, 2.0, 5.0])
def test_a_cable_solves_bouc_and_wen_s_differential_equation(sharpness: float) -> None:
    z, reach, states = 0.0, 0.05, [0.0]
    fine = joint_signals(samples=80001, duration=4.0)
    for way in np.diff(fine.position) / reach:
        z += way - abs(way) * abs(z) ** (sharpness - 1.0) * z
        states.append(z)
    coarse = joint_signals(samples=4001, duration=4.0)
    found = columns_of("hysteretic_cable", coarse, x0=reach, n=sharpness)[:, 0]
    assert found == pytest.approx(np.array(states[::20]), abs=0.01)
    if sharpness == 1.0:
        dahl = columns_of("presliding_hysteresis", coarse, x0=reach)[:, 0]
        assert found == pytest.approx(dahl, abs=1e-4)


def sine(frequency: float) -> JointSignals:
    joint = joint_signals()
    needed = joint.gain * np.sin(frequency * joint.time)
    return replace(joint, needs=lambda: needed, band=400.0)


@pytest.mark.parametrize("late", [0.0004, 0.004, 0.0137, 0.05, -0.0025, -0.0004])
def test_a_delayed_current_is_what_the_torque_will_be(late: float) -> None:
    frequency, joint = 40.0, sine(40.0)
    found = columns_of("current_delay", joint, T=late)[:, 0] * late
    expected = joint.gain * (np.sin(frequency * (joint.time + late)) - np.sin(frequency * joint.time))
    inner = slice(60, -60)
    assert found[inner] == pytest.approx(expected[inner], abs=2e-6 * joint.gain)


def test_a_lagging_torque_needs_its_derivative_ahead() -> None:
    joint = sine(20.0)
    found = columns_of("current_loop_lag", joint)[:, 0]
    derivative = joint.gain * 20.0 * np.cos(20.0 * joint.time)
    assert found[50:-50] == pytest.approx(derivative[50:-50], abs=1e-3 * joint.gain * 20.0)


def test_a_delay_begins_as_the_derivative_of_the_torque() -> None:
    joint = sine(20.0)
    derivative = joint.gain * 20.0 * np.cos(20.0 * joint.time)
    for value in (0.0, 1e-7, 1e-5):
        found = columns_of("current_delay", joint, T=value)[:, 0]
        assert found[50:-50] == pytest.approx(derivative[50:-50], abs=0.02 * joint.gain * 20.0)


def samples_of(joint: JointSignals, error: np.ndarray) -> JointSamples:
    kept = slice(None, None, 10)
    return JointSamples(
        position=joint.position[kept],
        velocity=joint.velocity[kept],
        motor_torque=joint.gain * joint.current[kept],
        error=error[kept],
        duration=4.0,
        speed=joint.speed,
        travel=float(np.ptp(joint.position)),
        band=joint.band,
        rotates=joint.rotates,
    )


@pytest.mark.parametrize("rotates", [True, False])
@pytest.mark.parametrize("name", ["cogging_torque", "torque_ripple"])
@pytest.mark.parametrize("periods", [9.0, 31.3, 77.0])
def test_the_periods_are_found_in_the_error(name: str, rotates: bool, periods: float) -> None:
    joint = joint_signals(rotates=rotates)
    periods = periods if rotates else periods / (2 * np.pi)
    wave = columns_of(name, joint, periods=periods) @ np.array([0.02, -0.03])
    noise = 0.02 * np.random.default_rng(3).normal(size=len(wave))
    effect = ACTUATOR_EFFECTS[name]
    brackets = effect.brackets(effect.shape[0], [samples_of(joint, wave + noise)])
    assert any(low < periods < high for low, _, high in brackets)


def test_shape_candidates_follow_the_joint_s_speed_and_the_recording() -> None:
    joint = joint_signals()
    samples = [samples_of(joint, 0 * joint.time)]
    stribeck, thermal = CATALOGUE["stribeck_friction"], CATALOGUE["thermal_friction_drift"]
    speeds = [value for _, value, _ in stribeck.brackets(stribeck.shape[0], samples)]
    assert speeds == pytest.approx([joint.speed * share for share in stribeck.shape[0].candidates])
    times = [value for _, value, _ in thermal.brackets(thermal.shape[0], samples)]
    assert times == pytest.approx([4.0 * share for share in thermal.shape[0].candidates])
