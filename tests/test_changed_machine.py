"""Effects that change the machine (zeros of encoders, lengths): steps with the regressor of the changed machine."""

from dataclasses import replace

import numpy as np
import pytest

from bench.diagnosis.base_model import base_model_of
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.identify import identify
from bench.identification.moved_regressor import machine_derivatives, regressor_change
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare, seen_nearby, with_effects
from bench.identification.problem import problem_of
from bench.identification.solve_only import candidate_columns, solved_quickly
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.discover_kit import simulated
from tests.hidden_kit import plain, scenario

ABOUT = {
    "encoder_offset": ("axis_1", "offset", 0.003),
    "geometric_error": ("carriage_1", "dl", 0.002),
    "base_tilt": ("", "tilt_x", 0.02),
}
LONGER = {"effect": "geometric_error", "joint": "left", "error": 0.004}


@pytest.mark.parametrize("name", ABOUT)
def test_the_regressor_changes_as_the_torque_of_any_parameters(name: str):
    prepared = prepare(problem_of(as_dataset(plain("orthoglide", recordings=("free",)))))
    joint, parameter, value = ABOUT[name]
    effect = CATALOGUE[name].about({parameter: value})
    instance = EffectInstance(effect, joint, name)
    for heavier in (1.0, 2.0):
        base = prepared.present.base * np.linspace(1.0, heavier, len(prepared.present.base))
        seen = with_effects(prepared, [instance], replace(prepared.present, base=base))
        changes = regressor_change(seen)
        assert changes is not None
        moving = seen.fitted[0].moving
        by_effect = candidate_columns(seen, [instance])[:, :, 0] * value * moving
        by_parameters = changes[0][:, :, : len(base)] @ base * moving
        off = np.linalg.norm(by_parameters - by_effect) / np.linalg.norm(by_effect)
        assert off < 0.01, (name, heavier)


@pytest.mark.parametrize("recordings", [("free",), ("free", "held")], ids=["nominal gains", "fitted gains"])
def test_derivatives_are_those_of_the_changed_rows_also_with_a_redundant_motor(recordings: tuple[str, ...]):
    prepared = prepare(problem_of(as_dataset(plain("dualv", recordings=recordings))))
    base = prepared.layout.base
    theta = np.append(prepared.present.base, 0.1 * np.ones(prepared.layout.size - base + 1))

    def changed_torque(offset: float) -> np.ndarray:
        instance = EffectInstance(CATALOGUE["encoder_offset"].about({"offset": offset}), "motor_1", "zero")
        changes = regressor_change(with_effects(prepared, [instance]))
        assert changes is not None
        return changes[0] @ theta + changes[1]

    about = EffectInstance(CATALOGUE["encoder_offset"].about({"offset": 0.01}), "motor_1", "zero")
    derivative = machine_derivatives(with_effects(prepared, [about]), theta)[:, :, 0]
    difference = (changed_torque(0.01001) - changed_torque(0.00999)) / 2e-5
    # the redundant motor's torque enters at few samples, with its noise
    assert np.linalg.norm(derivative - difference) < 0.03 * np.linalg.norm(difference)


def test_without_such_an_effect_nothing_changes():
    prepared = prepare(problem_of(as_dataset(plain("orthoglide", recordings=("free",)))))
    friction = EffectInstance(CATALOGUE["coulomb_friction"], "axis_1", "coulomb_friction:axis_1")
    assert regressor_change(with_effects(prepared, [friction])) is None


def test_a_model_converged_with_nearby_columns_is_converged_exactly_before_it_is_told():
    start = prepare(problem_of(as_dataset(simulated(LONGER))))
    base_model = base_model_of(start)
    asked = [
        EffectInstance(CATALOGUE["geometric_error"], body, f"geometric_error:{body}")
        for body in ("left_crank", "right_crank")
    ]
    begun = with_effects(start, asked, fitted_only=True)
    near, whole = converged(seen_nearby(begun, base_model.nearby)), converged(begun)
    for model in (near, whole):
        assert model.converged
        assert all(observation.effects.shape[2] == 2 for observation in model.observations)
    exact = base_model.exactly(near)
    assert exact.nearby is None
    assert base_model.exactly(exact) is exact
    gains = [solved_quickly(model)[1].gains for model in (exact, whole)]
    np.testing.assert_allclose(*gains, rtol=1e-4)


def test_wrong_zeros_are_found_where_parameters_are_hardly_determined():
    offsets = {"axis_1": 0.001, "axis_2": -0.001, "axis_3": 0.012}
    hidden = [{"effect": "encoder_offset", "joint": joint, "offset": x} for joint, x in offsets.items()]
    simulation = simulate(scenario("orthoglide", hidden, design={"optimise": False, "duration": 8.0}))
    answer = identify(prepare(problem_of(as_dataset(simulation), ["encoder_offset"])))
    for joint, true in offsets.items():
        offset = answer.effect_parameters["encoder_offset"][joint]["offset"]
        assert offset.value == pytest.approx(true, abs=1e-4)
        assert abs(offset.value - true) < 4.0 * offset.std
        assert offset.std < 5e-5
    assert answer.error.identify < 0.0025  # noise
