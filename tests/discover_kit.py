"""Machines with laws that no catalogue has, for tests of their discovery."""

import json
from functools import cache

from bench.dataset.dataset import Dataset
from bench.excitation.scenario import designer
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation, simulate
from tests.hidden_kit import STEP

BRAKED = {"effect": "acceleration_dependent_friction", "c": 0.015}


def measured(*hidden: dict[str, object]) -> Dataset:
    """Measurements of a five-bar with these hidden effects."""
    return as_dataset(simulated(*hidden))


def simulated(*hidden: dict[str, object]) -> Simulation:
    """A five-bar with these hidden effects, simulated; the same ones once."""
    return _simulated(json.dumps(hidden))


@cache
def _simulated(hidden: str) -> Simulation:
    changes = {"design": {"optimise": False, "duration": 8.0}, "hidden": json.loads(hidden), "step": STEP}
    scenario = load_scenario("five_bar", changes)
    return simulate(scenario, resolve_trajectories(scenario, designer))
