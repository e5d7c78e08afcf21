"""Stability of verdicts: the same machine diagnosed again, with more noise and without one log."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.diagnosis.discovery.find import find_missing_effects
from bench.diagnosis.result import Diagnosis
from bench.identification.problem import problem_of
from bench.studies.sweep.journal import Row
from bench.studies.trial.name_list import cell_of, names_in
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation
from bench.truth.streams import stream

MORE_NOISE = 0.25
"""Standard deviation of the noise that is added to the currents, over that of the noise that they have."""

FEWEST_LOGS = 3
SURE = "missing"
"""The verdict that is certain."""


def again_columns(simulation: Simulation, row: Row) -> Row:
    """Names of the effects that are certain at first, with more noise, and without the last log."""
    columns: Row = {"sure": cell_of(sure_in(row)), "sure.noise": _sure(with_more_noise(simulation))}
    if len(simulation.recordings) >= FEWEST_LOGS:
        columns["sure.without_log"] = _sure(replace(simulation, recordings=simulation.recordings[:-1]))
    return columns


def with_more_noise(simulation: Simulation) -> Simulation:
    """The same logs with independent noise added to the currents."""
    seed = simulation.scenario.settings.seed
    recordings = []
    for recording in simulation.recordings:
        current = recording.log.current
        noise = np.std(current - recording.current, axis=0)
        drawn = stream(seed, recording.name, "more noise").standard_normal(current.shape)
        log = replace(recording.log, current=current + MORE_NOISE * noise * drawn)
        recordings.append(replace(recording, log=log))
    return replace(simulation, recordings=tuple(recordings))


def sure_in(row: Row) -> list[str]:
    """The effects that a row names with certainty, by name."""
    named = names_in(row["missing"])
    verdicts = {verdict["effect"]: verdict["verdict"] for verdict in json.loads(row["verdicts"])}
    return sorted(name for name in named if verdicts.get(name) == SURE)


def _sure(simulation: Simulation) -> str:
    diagnosis = find_missing_effects(problem_of(as_dataset(simulation)))
    return cell_of(_certain(diagnosis, diagnosis.missing))


def _certain(diagnosis: Diagnosis, names: Sequence[str]) -> list[str]:
    verdicts = {verdict.effect: verdict.verdict for verdict in diagnosis.ranking}
    return sorted(name for name in names if verdicts.get(name) == SURE)
