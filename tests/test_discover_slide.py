"""Laws that are waves over the travel of a slide."""

import pytest

from bench.diagnosis.discovery.find import find_missing_effects
from bench.excitation.scenario import designer
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.discover_kit import FRICTIONS, among

GREASE = {"effect": "position_dependent_viscous_friction", "joint": "axis", "a": 100.0, "b": 25.0}


@pytest.mark.parametrize("rate", [22.0, 27.0])
def test_a_wave_of_any_length_is_one_law(rate: float) -> None:
    """Its rate (rad/m) is between those that are tried: 1 and 1.5 periods in the travel are 20 and 29."""
    changes = {
        "design": {"optimise": False, "duration": 8.0},
        "hidden": [{**GREASE, "harmonic": rate}],
        "step": 0.0005,
    }
    scenario = load_scenario("emps", changes)
    simulation = simulate(scenario, resolve_trajectories(scenario, designer))
    found = find_missing_effects(among(FRICTIONS, as_dataset(simulation)))
    assert found.missing == ()
    (law,) = found.discovered
    assert law.numbers["w"].value == pytest.approx(rate, rel=0.01)
    assert found.unexplained.error < 1.1 * found.unexplained.noise_floor
