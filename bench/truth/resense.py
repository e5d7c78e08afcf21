"""Log the same true motion again, with other noise, other sensors or another seed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.scenario.scenario import Scenario, scenario_from_dict
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.sensors import sense
from bench.truth.simulate import Simulation, simulate


def sense_again(simulation: Simulation, scenario: Scenario, zero: np.ndarray | float = 0.0) -> Simulation:
    """Log the motion of `simulation` with the sensors and the seed of `scenario`.

    The scenarios may differ only in these two; the motion is not simulated again. zero (n,): for each joint, a
    position, rad or m, at which a step of its encoder is centred. Quantisation errors follow from motion and steps
    alone: with the same zero they are the same for every seed.
    """
    settings = scenario.settings
    recordings = []
    for recording in simulation.recordings:
        log = sense(
            settings.sensors,
            scenario.robot.driven,
            settings.seed,
            recording.name,
            recording.motion.time,
            recording.position - zero,
            recording.current,
        )
        recordings.append(replace(recording, log=replace(log, position=log.position + zero)))
    return replace(simulation, scenario=scenario, recordings=tuple(recordings))


def repeated(truth: Mapping[str, Any], origin: str, threads: int = 2) -> Simulation:
    """Repeat the simulation that a truth file describes.

    origin: the file, for messages. Raises BenchError if it is damaged or of another version, and the errors of
    `simulate`.
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
