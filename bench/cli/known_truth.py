"""What a simulation knows of the dataset that it wrote: what its hidden effects did."""

import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.truth.dataset import truth_path
from bench.truth.inverse import hidden_torque, plain_machine
from bench.truth.report import truth
from bench.truth.resense import repeated
from bench.truth.simulate import Simulation
from bench.viewer.context import KnownTruth


def truth_next_to(dataset: Dataset) -> dict[str, Any] | None:
    """The content of the truth file next to a dataset's folder; None where there is none, as of a real robot."""
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


def simulated_again(dataset: Dataset, content: Mapping[str, Any]) -> Simulation | None:
    """The simulation that wrote a dataset; None where the dataset was changed since."""
    origin = str(truth_path(dataset.folder))
    simulation = repeated(content, origin)
    made = {
        f"{recording.name}.{simulation.scenario.settings.file_format}": recording.log
        for recording in simulation.recordings
    }
    for logged in dataset.recordings:
        log = made.get(logged.name)
        if log is None or log.current.shape != logged.current.shape:
            return None
        if not (
            np.array_equal(log.position, logged.position) and np.array_equal(log.current, logged.current)
        ):
            return None
    return simulation


def known_of(simulation: Simulation) -> dict[str, KnownTruth]:
    """References, hidden torques and the openings of loops, by recording of the dataset."""
    plain = plain_machine(simulation)
    suffix = simulation.scenario.settings.file_format
    by_file = {}
    for recording in simulation.recordings:
        hidden = hidden_torque(simulation, recording, plain)
        torque = hidden.torque if simulation.machine.hidden else None
        by_file[f"{recording.name}.{suffix}"] = KnownTruth(
            hidden.time, hidden.reference, torque, hidden.loop_gap
        )
    return by_file


def truth_of(simulation: Simulation) -> dict[str, Any]:
    """What the truth file of a simulation would hold."""
    return truth(simulation)
