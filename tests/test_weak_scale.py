"""Effects are named where the payload hardly fixes the gains: the model without them has gains that run away."""

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
