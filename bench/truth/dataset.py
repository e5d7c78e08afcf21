"""A simulation as a dataset, in memory, or as a folder and a file with the truth."""

from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import whole_folder, write_json_atomically
from bench.dataset.controller import ControlLaw, reference_column
from bench.dataset.dataset import Dataset, RecordingEntry, write_dataset_toml
from bench.dataset.names import DATASET_FILE
from bench.dataset.recording import Recording, position_column, write_recording
from bench.dataset.recording_checks import LARGEST_CURRENT
from bench.dataset.robot import Robot
from bench.scenario.scenario import payload_declared
from bench.truth.report import truth
from bench.truth.simulate import SimulatedRecording, Simulation


def as_dataset(simulation: Simulation) -> Dataset:
    """The part of a simulation that an identification may know: its logs and the declared values, not the truth."""
    scenario, m = simulation.scenario, len(simulation.robot.joints)
    redundant = simulation.robot.redundant
    declared = scenario.settings.controller.declared
    return Dataset(
        folder=Path(),
        robot=scenario.robot,
        payloads={name: payload_declared(name, t) for name, t in scenario.settings.payloads.items()},
        recordings=tuple(
            Recording(
                f"{r.name}.{scenario.settings.file_format}",
                r.table.use,
                r.table.payload,
                r.log.time,
                r.log.position[:, :m],
                r.log.current[:, :m],
                _extra_columns(r, scenario.robot, references=declared),
                redundant=r.log.current[:, m:] if redundant else None,
            )
            for r in simulation.recordings
        ),
        controller=_law(simulation) if declared else None,
    )


def _law(simulation: Simulation) -> ControlLaw:
    """The control law; MuJoCo's velocity is the backward difference of its positions over a step."""
    drive = simulation.machine.drive
    n = len(simulation.robot.joints)
    kp, kv, ka = ((values / drive.nominal_gains)[:n] for values in (drive.kp, drive.kv, drive.feedforward))
    return ControlLaw(kp, kv, ka, 0.5 * simulation.scenario.settings.step)


def _extra_columns(recording: SimulatedRecording, robot: Robot, *, references: bool) -> dict[str, np.ndarray]:
    """Positions of the joints of redundant motors, and with `references` the reference positions of the other
    joints.
    """
    first = len(robot.joints)
    columns = {
        position_column(actuator.joint): recording.log.position[:, first + r]
        for r, actuator in enumerate(robot.redundant)
    }
    if references:
        wanted = recording.trajectory.evaluate(recording.motion.time)[0]
        columns |= {reference_column(joint): wanted[:, j] for j, joint in enumerate(robot.joints)}
    return columns


def truth_path(folder: str | Path) -> Path:
    """The path of the truth of the dataset in `folder`: DIR.truth.json, next to DIR."""
    folder = Path(folder).resolve()
    return folder.with_name(f"{folder.name}.truth.json")


def write_simulation(simulation: Simulation, folder: str | Path) -> Path:
    """Write the dataset folder and, next to it, its truth; returns the path of the truth.

    The folder appears whole or not at all. A simulated dataset of that name is replaced.
    Raises BenchError if `folder` has other content than a simulated dataset, or cannot be written.
    """
    target = Path(folder).resolve()
    empty = not target.exists() or (target.is_dir() and not any(target.iterdir()))
    if not empty and not (target / DATASET_FILE).is_file():
        raise BenchError(f"{folder}: already exists and holds no dataset: give another folder")
    if not empty and not truth_path(target).is_file():
        raise BenchError(
            f"{folder}: holds a dataset that was not simulated (without {truth_path(target).name}): "
            "give another folder"
        )
    with whole_folder(folder) as partial:
        _write_folder(simulation, partial)
        write_json_atomically(truth_path(target), truth(simulation))
    return truth_path(target)


def _write_folder(simulation: Simulation, folder: Path) -> None:
    scenario = simulation.scenario
    dataset = as_dataset(simulation)
    for recording, recorded in zip(simulation.recordings, dataset.recordings, strict=True):
        file = folder / recorded.name
        log = recording.log
        write_recording(file, log.time, log.position, log.current, scenario.robot.driven, recorded.extra)
    entries = [
        # the units of a simulation are known: with large masses, currents may be large as well
        RecordingEntry(
            r.name, r.use, r.payload, ("units",) if np.abs(r.current).max() > LARGEST_CURRENT else ()
        )
        for r in dataset.recordings
    ]
    used = {entry.payload for entry in entries}
    payloads = [payload for name, payload in dataset.payloads.items() if name in used]
    write_dataset_toml(
        folder,
        scenario.robot_reference,
        entries,
        payloads,
        controller=dataset.controller,
        joints=scenario.robot.joints,
    )
