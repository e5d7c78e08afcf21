"""Each effect beside the simulated machine that has it: two laws written apart must mean the same."""

from dataclasses import dataclass

import numpy as np
import pytest

from bench.dataset.dataset import Dataset
from bench.effects import CATALOGUE, places_in, select_effects
from bench.excitation.scenario import designer
from bench.identification.identify import fit, identify
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.signals.decimation import noise_bandwidth
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

CURRENT_NOISE = 0.01  # of the RMS current, in the scenario five_bar
GAINS = {"left": 3.0 * 1.10, "right": 3.0 * 0.92}
MOST_DEVIATIONS = 4.5
STEP, DURATION = 0.001, 6.0  # s, of the simulation and of each of its recordings
LONGER = 12.0  # s, where less leaves a parameter unsure
FINER = 0.0005  # s, where what is hidden swings faster

Values = dict[str, float]


@dataclass(frozen=True)
class Case:
    """What the machine has, and what a fit of the effect must find wherever it sits, or at one place.

    share: by how much of its value a parameter may be off in addition to its deviation. floor: how many times the
    noise floor the error may be on recordings that were not fitted. step: of the simulation, duration: of each of its
    recordings, s.
    """

    hidden: dict[str, float | str]
    found: Values
    place: str = ""
    share: float = 0.01
    floor: float = 1.1
    beside: tuple[dict[str, float | str], ...] = ()
    step: float = STEP
    duration: float = DURATION


COULOMB: dict[str, float | str] = {"effect": "coulomb_friction", "Fc": 0.15}
ROTOR = {"joint": "left", "rotor_inertia": 0.003}
CASES = {
    "asymmetric_viscous_friction": Case(
        {"Fv_plus": 0.05, "Fv_minus": 0.1}, {"Fv_plus": 0.05, "Fv_minus": 0.1}
    ),
    # flanks that give way add 2 tau / stiffness to the play
    "backlash": Case(
        {"play": 0.01, "stiffness": 2000.0, "damping": 2.0, **ROTOR},
        {"b": 0.0125},
        "left",
        0.2,
        step=FINER,
        duration=LONGER,
    ),
    "base_tilt": Case({"about_y": 0.12}, {"tilt_y": 0.12}),
    "cogging_torque": Case(
        {"a": 0.05, "b": 0.02, "period": 0.2}, {"a": 0.05, "b": 0.02, "periods": 2 * np.pi / 0.2}
    ),
    "constant_offset": Case({"c": 0.1}, {"c": 0.1}),
    "coulomb_friction": Case({"Fc": 0.1}, {"Fc": 0.1}),
    "current_delay": Case({"T": -0.004}, {"T": -0.004}),
    "current_loop_lag": Case({"T": 0.006}, {"T": 0.006}, share=0.03),
    "drive_flexibility": Case(
        {"stiffness": 300.0, "damping": 0.3, **ROTOR}, {"C": 1 / 300}, "left", step=FINER, duration=LONGER
    ),
    "encoder_offset": Case({"offset": 0.02, "joint": "left"}, {"offset": 0.02}, "left"),
    "gain_saturation": Case({"k": 0.02}, {"k": 0.02}),
    "geometric_error": Case(
        {"error": 0.004, "joint": "left_elbow"}, {"dl": 0.004}, "left_rod", duration=LONGER
    ),
    "hysteretic_cable": Case({"F": 0.2, "reach": 0.2}, {"F": 0.2, "x0": 0.2, "n": 2.0}),
    "joint_spring": Case({"k": 1.0, "q0": -1.0}, {"k": 1.0, "kq0": -1.0}, duration=LONGER),
    "load_dependent_friction": Case({"mu": 0.05}, {"mu": 0.05}, floor=1.25),
    "passive_coulomb_friction": Case({"Fc": 0.05}, {"Fc": 0.05}, share=0.02),
    # what mum is, only the model's parameters tell; so large that what it does to the force itself shows
    "passive_load_friction": Case({"mu": 0.015}, {"mu": 0.015}, share=0.03),
    "passive_rotor_inertia": Case({"Ia": 0.005}, {"Ia": 0.005}),
    "passive_spring": Case(
        {"k": 1.5, "q0": 0.4, "joint": "left_elbow"}, {"k": 1.5, "kq0": 0.6}, "left_elbow"
    ),
    "passive_viscous_friction": Case({"Fv": 0.05}, {"Fv": 0.05}),
    "platform_force": Case(
        {"fx": 1.0, "fz": 2.0, "k": 5.0}, {"Fx": 1.0, "Fz": 2.0, "kx": 5.0, "kz": 5.0}, "robot", 0.02
    ),
    "position_dependent_friction": Case(
        {"a": 0.05, "b": -0.1},
        {"a": 0.05, "b": -0.1, "harmonic": 1.0},
        share=0.1,
        floor=1.3,
        beside=(COULOMB,),
    ),
    "presliding_hysteresis": Case({"Fc": 0.1, "stiffness": 5.0}, {"Fc": 0.1, "x0": 0.02}),
    "quadratic_drag": Case({"c": 0.05}, {"c": 0.05}),
    "shear_thinning_friction": Case({"Fa": 0.05, "va": 0.3}, {"Fa": 0.05, "va": 0.3}, share=0.03),
    "stribeck_friction": Case(
        {"Fc": 0.1, "Fs": 0.1, "vs": 0.2}, {"Fc": 0.1, "Fs": 0.1, "vs": 0.2}, share=0.1, floor=1.2
    ),
    "thermal_friction_drift": Case(
        {"T": 6.0, "Fv": 0.1, "Fc": 0.05}, {"T": 6.0, "Fv": 0.1, "Fc": 0.05}, share=0.03
    ),
    "tool_drag": Case({"c": 0.5}, {"c": 0.5}, "robot"),
    "torque_ripple": Case(
        {"a": 0.03, "b": 0.02, "period": 0.2}, {"a": 0.03, "b": 0.02, "periods": 2 * np.pi / 0.2}
    ),
    "transmission_error": Case(
        {"a": 1e-3, "b": 5e-4, "period": 0.4, "joint": "left"},
        {"a": 1e-3, "b": 5e-4, "periods": 2 * np.pi / 0.4},
        "left",
        0.03,
    ),
    "viscous_friction": Case({"Fv": 0.1}, {"Fv": 0.1}),
}
ABSORBED = {"payload_mass_error": {"error": 0.03}, "rotor_inertia": {"Ia": 0.01}}


def measurements(
    *hidden: dict[str, float | str], robot: str = "five_bar", step: float = STEP, duration: float = DURATION
) -> Dataset:
    """Three of the scenario's recordings, at a larger step and shorter: one to judge on says what two would."""
    tables = [one.model_dump(exclude_none=True) for one in load_scenario(robot).settings.recordings]
    kept = [one for one in tables if one["use"] == "identify" or "payload" in one]
    short = [{**one, "design": {**one["design"], "duration": duration}} for one in kept]
    scenario = load_scenario(robot, {"hidden": list(hidden), "recordings": short, "step": step})
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


def over_noise(result: Identification) -> float:
    """Error on the recordings that were not fitted, over that which the currents' noise alone leaves."""
    passed = np.sqrt(noise_bandwidth(result.settings.decimation))
    return float(result.error.validate or np.inf) / (CURRENT_NOISE * passed)


def test_every_effect_stands_here() -> None:
    assert set(CASES) | set(ABSORBED) == set(CATALOGUE)


@pytest.mark.parametrize("name", CASES)
def test_an_effect_finds_what_the_machine_has(name: str) -> None:
    case = CASES[name]
    dataset = measurements(
        {"effect": name, **case.hidden}, *case.beside, step=case.step, duration=case.duration
    )
    beside = [str(one["effect"]) for one in case.beside]
    prepared = prepare(problem_of(dataset, beside))
    added = select_effects([name], places_in(prepared.model.geometry, dataset.payloads))
    plain, result = fit(prepared), fit(with_effects(prepared, [*added, *prepared.effects]))
    assert over_noise(result) < case.floor
    assert result.error.validate < plain.error.validate
    for joint, gain in result.drive_gains.items():
        off = abs(gain.value - GAINS[joint])
        assert off < MOST_DEVIATIONS * gain.std + 0.0005 * gain.value
    places = result.effect_parameters[name]
    for place in [case.place] if case.place else list(places):
        for symbol, value in case.found.items():
            one = places[place][symbol]
            assert one.value == pytest.approx(
                value, abs=MOST_DEVIATIONS * one.std + case.share * abs(value)
            ), symbol
            assert one.std < 0.25 * abs(value)


@pytest.mark.parametrize("name", ABSORBED)
def test_what_the_model_s_own_parameters_take_up_leaves_no_error(name: str) -> None:
    result = identify(prepare(problem_of(measurements({"effect": name, **ABSORBED[name]}), [name])))
    assert over_noise(result) < 1.1
    assert all(
        np.isinf(one.std) for values in result.effect_parameters[name].values() for one in values.values()
    )


def test_a_rotor_s_inertia_is_a_parameter_where_its_motor_is_carried_along() -> None:
    dataset = measurements(
        {"effect": "rotor_inertia", "joint": "elbow", "Ia": 0.03}, robot="two_link", duration=LONGER
    )
    result = identify(prepare(problem_of(dataset, ["rotor_inertia"])))
    own = {parameter.name: parameter for parameter in result.parameters}["Ia(elbow)"]
    assert own.value == pytest.approx(0.03, abs=4.5 * own.std)
    assert own.std < 0.01
    found = result.effect_parameters["rotor_inertia"]
    assert np.isinf(found["elbow"]["Ia"].std), "the model has it already"
    assert np.isinf(found["shoulder"]["Ia"].std)
