"""Stability of verdicts: the same machine diagnosed again, with more noise and without one log."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.benchmarks.trust.stability import NOISE, SURE, WITHOUT_LOG, certain_in, verdicts_of
from bench.diagnosis.discovery.find import find_missing_effects
from bench.identification.problem import problem_of
from bench.studies.sweep.journal import Row
from bench.studies.trial.name_list import cell_of
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation
from bench.truth.streams import stream

MORE_NOISE = 0.25
"""Standard deviation of the noise that is added to the currents, over that of the noise that they have."""

FEWEST_LOGS = 3


def again_columns(simulation: Simulation, row: Row) -> Row:
    """Names of the effects that are certain at first, with more noise, and without the last log."""
    columns: Row = {
        SURE: cell_of(certain_in(verdicts_of(row))),
        NOISE: _sure(with_more_noise(simulation)),
    }
    if len(simulation.recordings) >= FEWEST_LOGS:
        columns[WITHOUT_LOG] = _sure(replace(simulation, recordings=simulation.recordings[:-1]))
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


def _sure(simulation: Simulation) -> str:
    diagnosis = find_missing_effects(problem_of(as_dataset(simulation)))
    named = {v.effect: v.verdict for v in diagnosis.ranking if v.effect in diagnosis.missing}
    return cell_of(certain_in(named))
