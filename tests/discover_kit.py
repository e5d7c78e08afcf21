"""Machines with laws that no catalogue has, for tests of their discovery."""

import json
from dataclasses import replace
from functools import cache

from bench.dataset.dataset import Dataset
from bench.excitation.scenario import designer
from bench.identification.problem import Problem, problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation, simulate
from tests.hidden_kit import STEP

BRAKED = {"effect": "acceleration_dependent_friction", "c": 0.015}
FRICTIONS = (
    "viscous_friction",
    "asymmetric_viscous_friction",
    "coulomb_friction",
    "stribeck_friction",
    "shear_thinning_friction",
    "quadratic_drag",
    "load_dependent_friction",
    "position_dependent_friction",
    "constant_offset",
    "joint_spring",
)


def among(names: tuple[str, ...], dataset: Dataset, effects: tuple[str, ...] = ()) -> Problem:
    """Where only these effects of the catalogue are known: half of the time goes by how many there are."""
    problem = problem_of(dataset, effects)
    return replace(problem, catalogue={name: problem.catalogue[name] for name in names})


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
