"""The truth about simulated recordings, to be shown with an answer: from the truth file next to the dataset."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.dataset.robot import Robot
from bench.document.numbers import effect_key
from bench.model.model import build_model
from bench.studies.sweep.accuracy import true_values
from bench.studies.trial.intervals import as_logged
from bench.studies.trial.intervals import true_values as true_effect_values
from bench.truth.dataset import truth_path
from bench.truth.inverse import hidden_torque, plain_machine
from bench.truth.report import truth
from bench.truth.resense import repeated
from bench.truth.simulate import Simulation
from bench.viewer.context import KnownTruth

WHOLE_ROBOT = "robot"
Known = tuple[Mapping[str, KnownTruth], Mapping[str, float] | None]
"""The truth by recording, and the true gains, base parameters and effect parameters by key (None if unknown)."""


def known_next_to(logged: Dataset, shown: Dataset) -> Known:
    """The truth about a simulation's dataset; empty and None for others. shown: its recordings or parts of them."""
    content = _truth_next_to(logged)
    simulation = None if content is None else _simulated_again(logged, content)
    if content is None or simulation is None:
        return {}, None
    known = _of_recordings(simulation)
    parts = {part.name: part for part in shown.recordings if part.log in known}
    by_part = {name: known[part.log].within(part.time[0], part.time[-1]) for name, part in parts.items()}
    return by_part, _values(shown.robot, content)


def known_to(simulation: Simulation, robot: Robot) -> Known:
    """The truth about all recordings of a simulation."""
    return _of_recordings(simulation), _values(robot, truth(simulation))


def _values(robot: Robot, truth: Mapping[str, Any]) -> dict[str, float]:
    """True gains, base parameters and parameters of hidden effects; truth: the content of a truth file."""
    model = build_model(robot)
    values = true_values(model, truth)
    slides = {joint.name for joint in model.geometry.joints if joint.kind == "slide"}
    for hidden in as_logged(truth["hidden"]):
        joint = hidden.get("joint") or WHOLE_ROBOT
        parameters = true_effect_values(hidden["effect"], hidden, slide=joint in slides)
        values |= {effect_key(hidden["effect"], joint, name): value for name, value in parameters.items()}
    return values


def _truth_next_to(dataset: Dataset) -> dict[str, Any] | None:
    """The content of the truth file next to a dataset's folder; None if there is none, as for a real robot."""
    path = truth_path(dataset.folder)
    if not path.is_file():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError, UnicodeDecodeError) as error:
        raise BenchError(f"{path}: cannot be read ({error})") from None
    if not isinstance(content, dict):
        raise BenchError(f"{path}: not a truth file")
    return content


def _simulated_again(dataset: Dataset, content: Mapping[str, Any]) -> Simulation | None:
    """The simulation that wrote a dataset, repeated; None if the dataset has been changed since."""
    simulation = repeated(content, str(truth_path(dataset.folder)))
    suffix = simulation.scenario.settings.file_format
    made = {f"{recording.name}.{suffix}": recording.log for recording in simulation.recordings}
    for logged in dataset.recordings:
        log = made.get(logged.name)
        same = log is not None and np.array_equal(log.position, logged.position)
        if log is None or not (same and np.array_equal(log.current, logged.current)):
            return None
    return simulation


def _of_recordings(simulation: Simulation) -> dict[str, KnownTruth]:
    """References, hidden torques and loop gaps, by recording of the dataset."""
    plain = plain_machine(simulation)
    suffix = simulation.scenario.settings.file_format
    by_file = {}
    for recording in simulation.recordings:
        hidden = hidden_torque(simulation, recording, plain)
        torque = hidden.torque if simulation.machine.hidden else None
        known = KnownTruth(hidden.time, hidden.reference, torque, hidden.loop_gap)
        by_file[f"{recording.name}.{suffix}"] = known
    return by_file
