"""Recordings to judge on, if the user named none."""

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.dataset.sampling import FEWEST
from bench.identification.decision import RULE
from bench.identification.result import CurrentSeries
from bench.identification.tolerances import TOLERANCES


def with_held_out_parts(dataset: Dataset) -> tuple[Dataset, float]:
    """The dataset with held-out data, and the share of every recording that was reserved for it.

    Without a recording for validation, the last 30 % of every recording's motion are reserved. Raises BenchError if
    these are too few samples.
    """
    if any(recording.use == "validate" for recording in dataset.recordings):
        return dataset, 0.0
    parts = []
    for recording in dataset.recordings:
        first, last = _motion(recording.position)
        cut = first + round((1.0 - TOLERANCES.statistics.held_out) * (last - first))
        _check_length(dataset, recording, len(recording.time) - cut)
        parts.append(_part(recording, recording.name, "identify", slice(0, cut)))
        parts.append(_part(recording, f"{recording.name} (end)", "validate", slice(cut, None)))
    return replace(dataset, recordings=tuple(parts)), TOLERANCES.statistics.held_out


def _motion(position: np.ndarray) -> tuple[int, int]:
    """First sample of the motion and one past the last, from positions (N, n): without a standstill at either end that
    is longer than what a user drops by request.
    """
    travel = np.ptp(position, axis=0)
    noise = np.std(np.diff(position, 2, axis=0), axis=0)
    moving = position[:, travel > 2.0 * RULE.certain * noise]
    small, ends = TOLERANCES.motion.slow * np.ptp(moving, axis=0), [0, len(position)]
    for end, at in enumerate((0, -1)):
        away = np.flatnonzero((np.abs(moving - moving[at]) > small).any(axis=1))
        if len(away) and abs(int(away[at]) - ends[end]) > TOLERANCES.findings.disturbed * len(position):
            ends[end] = int(away[at]) + end
    return ends[0], ends[1]


def _check_length(dataset: Dataset, recording: Recording, held_out: int) -> None:
    """Raise BenchError if the held-out samples at a recording's end are too few to judge on."""
    if held_out < FEWEST:
        needed = ceil(FEWEST / TOLERANCES.statistics.held_out)
        raise BenchError(
            f"{dataset.folder}: {recording.name} has {len(recording.time)} samples, the last {held_out} of which are "
            f'too few to judge on: record another motion with use = "validate", or one of at least {needed} samples '
            f"({needed / recording.rate:.2g} s)"
        )


def dataset_of(dataset: Dataset, series: Sequence[CurrentSeries]) -> Dataset:
    """The dataset of the series: with recordings' ends held out if these were judged on."""
    names = {recording.name for recording in dataset.recordings}
    return dataset if all(trace.name in names for trace in series) else with_held_out_parts(dataset)[0]


def _part(recording: Recording, name: str, use: str, where: slice) -> Recording:
    return replace(
        recording.part(where),
        name=name,
        use="identify" if use == "identify" else "validate",
        part_of=recording.log,
        started=recording.began,
    )
