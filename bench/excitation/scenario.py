"""The movements of a scenario, designed."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np

from bench.basics.progress import SILENT, Progress
from bench.dataset.robot import Robot
from bench.excitation.design import Designed, Movement, design_trajectories
from bench.scenario.scenario import (
    Scenario,
    design_center,
    load_scenario,
    payload_declared,
    per_joint,
    resolve_trajectories,
)
from bench.scenario.tables import RecordingTable
from bench.scenario.trajectory import FourierTrajectory


def designer(
    scenario: Scenario, recordings: Sequence[RecordingTable], progress: Progress = SILENT
) -> dict[str, FourierTrajectory]:
    """Trajectories for the recordings of a scenario that request an optimised one, by recording name."""
    movements = tuple(_movement(scenario, recording) for recording in recordings)
    return dict(_designed(_Request(scenario.robot, repr(movements), movements, progress)).trajectories)


def load_designed(
    scenario: str | Path, overrides: Mapping[str, Any] | None = None, progress: Progress = SILENT
) -> tuple[Scenario, dict[str, FourierTrajectory]]:
    """A scenario, a built-in name or a file, and the trajectory of every recording by its name.

    overrides: merged last, see `load_scenario`. Raises BenchError, one line that names the file and the key.
    """
    loaded = load_scenario(scenario, overrides)
    return loaded, resolve_trajectories(loaded, partial(designer, progress=progress))


@dataclass(frozen=True)
class _Request:
    """A design request; movements are compared by what they print, since arrays do not hash."""

    robot: Robot
    printed: str
    movements: tuple[Movement, ...] = field(compare=False)
    progress: Progress = field(compare=False)


@lru_cache(maxsize=64)
def _designed(request: _Request) -> Designed:
    return design_trajectories(request.robot, request.movements, request.progress)


def _movement(scenario: Scenario, recording: RecordingTable) -> Movement:
    design, robot = recording.design, scenario.robot
    assert design is not None
    limit = np.inf if design.acceleration_limit is None else design.acceleration_limit
    span, velocity, acceleration = (
        per_joint(x, robot.joints) for x in (design.span, design.velocity_limit, limit)
    )
    table = None if recording.payload is None else scenario.settings.payloads[recording.payload]
    return Movement(
        name=recording.name,
        fitted=recording.use == "identify",
        payload=None if table is None else payload_declared(str(recording.payload), table),
        center=design_center(robot, design),
        span=span,
        velocity=velocity,
        acceleration=acceleration,
        harmonics=design.harmonics,
        base_frequency=design.base_frequency,
        duration=design.duration,
        ramp=design.ramp,
        seed=design.seed,
    )
