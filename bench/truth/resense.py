"""The same true motion, logged again: other noise, other sensors, another seed."""

from dataclasses import replace

import numpy as np

from bench.scenario.scenario import Scenario
from bench.truth.sensors import sense
from bench.truth.simulate import Simulation


def sense_again(simulation: Simulation, scenario: Scenario, zero: np.ndarray | float = 0.0) -> Simulation:
    """Log the motion of `simulation` with the sensors and the seed of `scenario`.

    Only these two may differ between the scenarios; what moves the machine is taken as it was. zero (n,): a position of
    each joint, rad or m, at which a step of its encoder is centred. The errors of an encoder follow from motion and
    steps alone: at the same zero they are the same for every seed.
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
