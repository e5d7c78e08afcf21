"""The same true motion, logged again: other noise, other sensors, another seed."""

from __future__ import annotations

from dataclasses import replace

from bench.scenario.scenario import Scenario
from bench.truth.sensors import sense
from bench.truth.simulate import Simulation


def sense_again(simulation: Simulation, scenario: Scenario) -> Simulation:
    """Log the motion of `simulation` with the sensors and the seed of `scenario`.

    Only these two may differ between the scenarios; what moves the machine is taken as it was.
    """
    settings = scenario.settings
    recordings = tuple(
        replace(
            recording,
            log=sense(
                settings.sensors,
                scenario.robot.driven,
                settings.seed,
                recording.name,
                recording.motion.time,
                recording.position,
                recording.current,
            ),
        )
        for recording in simulation.recordings
    )
    return replace(simulation, scenario=scenario, recordings=recordings)
