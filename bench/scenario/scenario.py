"""A scenario: one simulated experiment, as a TOML file with everything that the experiment depends on."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ValidationError

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import UserTable, first_mistake
from bench.basics.joint_units import units_of_gain
from bench.dataset.catalogue import built_in_robots
from bench.dataset.home_qpos import home_qpos
from bench.dataset.payload import Payload, payload_fault
from bench.dataset.robot import Robot, load_robot
from bench.scenario.file import (
    find_scenario,
    merged,
    read_table,
    read_with_bases,
    with_absolute_paths,
    with_design_defaults,
)
from bench.scenario.tables import Design, PayloadTable, RecordingTable, ScenarioTable
from bench.scenario.trajectory import FourierTrajectory, random_trajectory

Array = NDArray[np.float64]

TOLERANCES: Mapping[str, str] = {
    "gain_error": "largest relative deviation of an estimated drive gain from the true one",
    "identify_error": "relative error of the current, all fitted recordings",
    "identify_error_over_noise_floor": "the same, over the error that the sensor noise alone leaves",
    "loop_gap": "largest opening of a loop during the simulation, m",
    "parameter_error": "largest relative deviation of an essential base parameter from the true one",
    "validate_error": "relative error of the current, all recordings that were not fitted",
    "validate_error_over_noise_floor": "the same, over the error that the sensor noise alone leaves",
}
"""Metrics for which a scenario may set a tolerance, and their meaning."""


@dataclass(frozen=True, eq=False)
class Scenario:
    """A checked scenario with its robot."""

    name: str
    """The file's name without its suffix."""
    robot: Robot
    robot_reference: str
    """The robot's reference in a dataset: a built-in name, or an absolute path."""
    settings: ScenarioTable

    @property
    def log_every(self) -> int:
        """Steps of the simulation per sample of the log."""
        return round(1.0 / (self.settings.step * self.settings.log_rate))

    @property
    def log_period(self) -> float:
        """The log period, s."""
        return self.log_every * self.settings.step


Designer = Callable[[Scenario, Sequence[RecordingTable]], Mapping[str, FourierTrajectory]]
"""Designs exciting trajectories, by recording name, for the recordings with `optimise = true` in their design."""


def load_scenario(scenario: str | Path, overrides: Mapping[str, Any] | None = None) -> Scenario:
    """Read and check a scenario, and load its robot.

    `scenario` is a built-in name or the path of a TOML file. With the key `base` (a name or a path relative to the
    file), the file contains only the differences from that scenario: tables are merged key by key, and everything
    else, including lists and the table of tolerances, is replaced. The keys of the table `design` are defaults for
    every recording that has a design. `overrides` are merged last, like a file with this one as its base.

    Raises BenchError, one line that names the file and the key.
    """
    path = find_scenario(scenario)
    content = merged(read_with_bases(path), with_absolute_paths(dict(overrides or {}), Path.cwd()))
    return scenario_from_dict(content, path.stem, str(path))


def scenario_from_dict(
    content: Mapping[str, Any], name: str, origin: str | None = None, robot: Robot | None = None
) -> Scenario:
    """Check the content of a scenario file, merged with its base and with absolute paths.

    origin: the file, for messages. robot: the robot that the content names, if it is already loaded.
    """
    where = origin or f"scenario {name}"
    try:
        settings = ScenarioTable.model_validate(with_design_defaults(content))
    except ValidationError as error:
        raise BenchError(f"{where}: {first_mistake(error)}") from error
    robot = robot or load_robot(settings.robot)
    for fault in (*_reference_faults(settings, robot), *_joint_faults(settings, robot)):
        raise BenchError(f"{where}: {fault}")
    reference = settings.robot if settings.robot in built_in_robots() else str(robot.folder)
    return Scenario(name, robot, reference, settings)


def per_joint(value: float | Mapping[str, float], joints: Sequence[str]) -> Array:
    """A number for all joints, or a table joint = number, as an array (n,) in the order of `joints`."""
    if isinstance(value, Mapping):
        return np.array([value[joint] for joint in joints], dtype=float)
    return np.full(len(joints), float(value))


def home_position(robot: Robot) -> Array:
    """Positions of the actuated joints (n,) in the keyframe `home`, or in the reference pose if there is none."""
    model = robot.mjcf_model()
    qpos = home_qpos(model)
    return np.array([qpos[model.joint(joint).qposadr[0]] for joint in robot.joints])


def resolve_trajectories(
    scenario: Scenario, designer: Designer | None = None
) -> dict[str, FourierTrajectory]:
    """The trajectory of every recording, by its name: given, read from a file, random or designed.

    `designer` is called once with all recordings with `optimise = true` in their design.
    Raises BenchError if there are such recordings but no designer, or if a trajectory does not match the robot's
    joints.
    """
    joints = scenario.robot.joints
    to_design = [r for r in scenario.settings.recordings if r.design is not None and r.design.optimise]
    if to_design and designer is None:
        raise BenchError(
            f"scenario {scenario.name}: recording {to_design[0].name!r} requests an optimised trajectory,"
            " but no designer is available: give the trajectory, or set optimise = false"
        )
    designed = dict(designer(scenario, to_design)) if to_design and designer is not None else {}
    home = home_position(scenario.robot)
    trajectories = {}
    for recording in scenario.settings.recordings:
        trajectory = designed.get(recording.name) or _given_trajectory(scenario, recording, home)
        if len(trajectory.center) != len(joints):
            raise BenchError(
                f"scenario {scenario.name}: the trajectory of recording {recording.name!r} is for"
                f" {len(trajectory.center)} joints, the robot has {len(joints)} ({', '.join(joints)})"
            )
        trajectories[recording.name] = trajectory
    return trajectories


def design_center(robot: Robot, design: Design) -> Array:
    """The center (n,) of a designed trajectory: as given, or the home pose."""
    return home_position(robot) if design.center is None else per_joint(design.center, robot.joints)


def payload_truth(name: str, table: PayloadTable) -> Payload:
    """The true rigid body at the tool."""
    return Payload(name, table.mass, np.array(table.center_of_mass), np.array(table.inertia))


def payload_declared(name: str, table: PayloadTable) -> Payload:
    """The payload as the dataset declares it."""
    if table.declared is None:
        return payload_truth(name, table)
    center, inertia = table.declared.center_of_mass, table.declared.inertia
    return Payload(
        name,
        table.declared.mass,
        None if center is None else np.array(center),
        None if inertia is None else np.array(inertia),
    )


def _given_trajectory(scenario: Scenario, recording: RecordingTable, home: Array) -> FourierTrajectory:
    try:
        if recording.trajectory is not None:
            return FourierTrajectory.from_dict(recording.trajectory)
        if recording.trajectory_file is not None:
            return FourierTrajectory.from_dict(read_table(Path(recording.trajectory_file)))
        if recording.design is not None:
            return _random(scenario.robot, recording.design, home)
    except BenchError as error:
        raise BenchError(f"scenario {scenario.name}: recording {recording.name!r}: {error}") from error
    raise BenchError(f"scenario {scenario.name}: recording {recording.name!r} has no trajectory")


def _random(robot: Robot, design: Design, home: Array) -> FourierTrajectory:
    acceleration = np.inf if design.acceleration_limit is None else design.acceleration_limit
    span, velocity, limit = (
        per_joint(x, robot.joints) for x in (design.span, design.velocity_limit, acceleration)
    )
    return random_trajectory(
        design.seed,
        home if design.center is None else per_joint(design.center, robot.joints),
        span,
        velocity,
        acceleration_limit=limit,
        harmonics=design.harmonics,
        base_frequency=design.base_frequency,
        duration=design.duration,
        ramp=design.ramp,
    )


def _reference_faults(settings: ScenarioTable, robot: Robot) -> Iterator[str]:
    """Inconsistencies between the tables of a scenario, and between them and the robot's tool."""
    for name in settings.tolerances:
        if name not in TOLERANCES:
            yield f"tolerances.{name}: no such metric; known are {', '.join(TOLERANCES)}"
    names = [recording.name for recording in settings.recordings]
    for i, recording in enumerate(settings.recordings):
        if recording.name in names[:i]:
            yield f"recordings[{i}].name: {recording.name!r} is used twice"
        if recording.payload is None:
            continue
        if recording.payload not in settings.payloads:
            known = ", ".join(settings.payloads) or "none"
            yield f"recordings[{i}].payload: {recording.payload!r} is not defined under [payloads] ({known})"
        if robot.tool_site is None:
            yield f"recordings[{i}].payload: the robot {robot.name!r} has no [tool] site to fix it at"
    for name, table in settings.payloads.items():
        for key, payload in (("", payload_truth(name, table)), (".declared", payload_declared(name, table))):
            if (fault := payload_fault(payload)) is not None:
                yield f"payloads.{name}{key}.{fault[0]}: {fault[1]}"
    every = 1.0 / (settings.step * settings.log_rate)
    if round(every) < 1 or abs(every - round(every)) > 1e-6 * every:
        yield f"log_rate: one sample must be a whole number of steps of {settings.step:g} s, not {every:g}"


def _joint_faults(settings: ScenarioTable, robot: Robot) -> Iterator[str]:
    """Tables joint = number that do not name exactly the robot's actuated joints, and encoder bits for slide joints."""
    tables: list[tuple[str, UserTable]] = [
        ("gains", settings.gains),
        ("controller", settings.controller),
        ("sensors", settings.sensors),
    ]
    tables += [
        (f"recordings[{i}].design", recording.design)
        for i, recording in enumerate(settings.recordings)
        if recording.design is not None
    ]
    for prefix, table in tables:
        joints = robot.joints if prefix.startswith("recordings") else robot.driven
        for key, value in table:
            for joint in value if isinstance(value, Mapping) else ():
                if joint not in joints:
                    yield f"{prefix}.{key}: no actuated joint {joint!r}; there are {', '.join(joints)}"
            for joint in joints if isinstance(value, Mapping) else ():
                if joint not in value:
                    yield f"{prefix}.{key}: joint {joint!r} is missing"
    for actuator in robot.motors:
        if settings.sensors.encoder_bits and not units_of_gain(actuator.gain_unit).rotates:
            yield f"sensors.encoder_bits: {actuator.joint!r} is a slide joint: give encoder_resolution in m"
