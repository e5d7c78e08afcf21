"""The common problems: short measurements of a five-bar and of a serial arm, with known truth."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from bench.excitation.scenario import designer
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.studies.estimators import two_recordings
from bench.truth.machine import true_gains
from bench.truth.resense import sense_again
from bench.truth.simulate import Simulation, simulate

DURATION = 5.0  # s of each of two recordings, at 1 kHz
COULOMB_SHARE = 0.03  # of the RMS torque of each motor
UNKNOWN_BODIES = {"five_bar": ("left_rod", "right_rod"), "two_link": ("upper_arm", "forearm")}


@dataclass(frozen=True)
class PeerProblem:
    """A robot with two unknown drive gains and two bodies of unknown mass; everything else may be known.

    simulation: recordings without and with a completely known payload.
    """

    robot: str
    friction: bool
    seed: int
    simulation: Simulation

    @property
    def gains(self) -> np.ndarray:
        """The true drive gains (n,)."""
        return true_gains(self.simulation.scenario)

    @property
    def masses(self) -> np.ndarray:
        """The true masses (2,) of `UNKNOWN_BODIES`."""
        model = self.simulation.machine.models[None]
        return np.array([model.body(name).mass[0] for name in UNKNOWN_BODIES[self.robot]])


def make_problem(robot: str, seed: int, *, friction: bool) -> PeerProblem:
    """A problem; seeds have the same motion and different sensor noise."""
    simulation = _simulated(robot, friction=friction)
    scenario = load_scenario(robot, _changes(robot, seed, simulation.scenario.settings.hidden))
    return PeerProblem(robot, friction, seed, sense_again(simulation, scenario))


@cache
def _simulated(robot: str, *, friction: bool) -> Simulation:
    scenario = load_scenario(robot, _changes(robot, 1, ()))
    trajectories = resolve_trajectories(scenario, designer)
    simulation = simulate(scenario, trajectories)
    if not friction:
        return simulation
    torque = np.concatenate([recording.motion.torque for recording in simulation.recordings])
    sizes = COULOMB_SHARE * np.sqrt(np.mean(torque**2, axis=0))
    hidden = [
        {"effect": "coulomb_friction", "joint": joint, "Fc": float(size)}
        for joint, size in zip(scenario.robot.joints, sizes, strict=True)
    ]
    return simulate(load_scenario(robot, _changes(robot, 1, hidden)), trajectories)


def _changes(robot: str, seed: int, hidden: Sequence[Any]) -> dict[str, Any]:
    entries = [entry if isinstance(entry, dict) else entry.model_dump() for entry in hidden]
    return {"seed": seed, "hidden": entries, "recordings": two_recordings(robot, DURATION)}
