"""What hardly shows: a payload that hardly fixes the gains, an effect that hardly leaves more than the noise."""

import pytest

from bench.api.diagnose import diagnose
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate


@pytest.mark.parametrize("mass", [0.01, 0.002])
def test_a_friction_is_named_beside_a_light_payload(mass: float) -> None:
    inertia = [2e-3 * mass, 2e-3 * mass, 4e-3 * mass, 0.0, 0.0, 0.0]
    changes = {
        "step": 0.0005,
        "hidden": [{"effect": "viscous_friction", "joint": "left", "Fv": 0.1}],
        "design": {"optimise": False, "duration": 8.0},
        "payloads": {"disc": {"mass": mass, "inertia": inertia, "declared": {"mass": mass}}},
    }
    found = diagnose(as_dataset(simulate(load_scenario("five_bar", changes))), discover=False)
    assert found.missing == ("viscous_friction",)
    assert found.after.error.validate < 0.0025  # noise leaves 0.0021
    for joint, true in (("left", 3.3), ("right", 2.76)):
        gain = found.after.drive_gains[joint]
        assert abs(gain.value - true) < 3.0 * gain.std


def test_an_effect_too_small_to_be_told_counts_for_how_sure_the_gains_are() -> None:
    """A saturation of a gain that hardly leaves more than the noise moves that gain by 4.6 of its own deviations."""
    changes = {
        "seed": 100,
        "hidden": [{"effect": "gain_saturation", "joint": "motor_1", "k": 0.03}],
        "design": {"optimise": False, "duration": 8.0},
    }
    simulated = simulate(load_scenario("three_rrr", changes))
    found = diagnose(as_dataset(simulated), discover=False)
    assert found.missing == ()
    assert found.after.std_from == "models"
    for joint, true in zip(found.after.drive_gains, simulated.machine.drive.true_gains, strict=True):
        gain = found.after.drive_gains[joint]
        assert abs(gain.value - true) < 3.0 * gain.std
