"""A simulation made again from what truth.json holds of it, to the last bit."""

from collections.abc import Mapping
from typing import Any

from bench.basics.errors import BenchError
from bench.scenario.scenario import Scenario, scenario_from_dict
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.simulate import Simulation, simulate


def repeated(truth: Mapping[str, Any], origin: str, threads: int = 2) -> Simulation:
    """Simulate once more what a truth file describes.

    origin: the file, for messages. Raises BenchError where it is damaged or of another version, and what
    `simulate` raises.
    """
    scenario = recorded_scenario(truth, origin)
    try:
        trajectories = {
            table.name: FourierTrajectory.from_dict(
                truth["recordings"][f"{table.name}.{scenario.settings.file_format}"]["trajectory"]
            )
            for table in scenario.settings.recordings
        }
    except (KeyError, TypeError, ValueError) as error:
        raise BenchError(f"{origin}: damaged truth file: {type(error).__name__} at {error}") from None
    return simulate(scenario, trajectories, threads)


def recorded_scenario(truth: Mapping[str, Any], origin: str, *, hidden: bool = True) -> Scenario:
    """The scenario of a truth file, with its hidden effects or (hidden=False) without."""
    try:
        content = {**truth["settings"], "robot": truth["robot"]}
        name = str(truth["scenario"])
    except (KeyError, TypeError) as error:
        raise BenchError(f"{origin}: damaged truth file: {type(error).__name__} at {error}") from None
    return scenario_from_dict(content if hidden else {**content, "hidden": []}, name, origin)
