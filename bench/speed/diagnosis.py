"""Cost of a diagnosis: two recordings of 24 s at 1 kHz against the whole catalogue."""

from collections.abc import Mapping
from time import perf_counter
from typing import Any

from bench.dataset import Dataset
from bench.diagnose.diagnose import diagnose
from bench.excite.scenario import designer
from bench.scenario import resolve_trajectories, scenario_from_dict
from bench.scenario_file import find_scenario, read_with_bases
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

LIMITS = {"five_bar": 10.0, "delta": 30.0}  # s
DURATION = 24.0  # s, of either recording
HIDDEN: Mapping[str, tuple[Mapping[str, Any], ...]] = {
    "five_bar": (
        {"effect": "coulomb_friction", "Fc": 0.2},
        {"effect": "encoder_offset", "joint": "left", "offset": 0.02},
    ),
    "delta": (
        {"effect": "coulomb_friction", "Fc": 1.0},
        {"effect": "encoder_offset", "joint": "motor_1", "offset": 0.02},
    ),
}
"""A linear effect, and one whose columns depend on the model, so that they are computed anew in every round."""


def two_recordings(robot: str) -> Dataset:
    """The robot's scenario with effects that no model is told of, and its two recordings to identify from."""
    content = dict(read_with_bases(find_scenario(robot)))
    content["hidden"] = list(HIDDEN[robot])
    content["design"] = {**content["design"], "duration": DURATION}
    content["recordings"] = [one for one in content["recordings"] if one["use"] == "identify"]
    scenario = scenario_from_dict(content, robot)
    return as_dataset(simulate(scenario, resolve_trajectories(scenario, designer)))


def measure(robot: str) -> float:
    """Seconds to diagnose the two recordings."""
    dataset = two_recordings(robot)
    start = perf_counter()
    diagnose(dataset)
    return perf_counter() - start
