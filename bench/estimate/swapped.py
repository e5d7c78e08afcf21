"""Whether two columns of a log were taken for each other: tried where the model explains little."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import numpy as np

from bench.dataset import Dataset
from bench.errors import BenchError
from bench.estimate.identify import fit
from bench.estimate.prepare import prepare
from bench.estimate.result import Identification
from bench.recording import Recording

LARGE = 0.05  # relative error from which it is worth a try
BETTER = 0.5  # of the error: what a swap must bring it down to
ALIKE = 1.1  # of the least error: on a symmetric robot currents or positions may be those that are swapped


def swapped_notes(dataset: Dataset, result: Identification) -> list[str]:
    """A sentence on the two columns that, taken for each other, bring the error down most; none where none do.

    Tried one pair at a time: currents, then positions, of any two motors, without effects and with the filters
    of the result. Where the error of the result is small, nothing is tried.
    """
    error = result.error.identify
    if error is None or error < LARGE:
        return []
    tried = sorted((_error_with(dataset, result, *pair), pair) for pair in _pairs(dataset))
    best = tried[0][0] if tried else np.inf
    if not best < BETTER * error:
        return []
    joints = list(result.drive_gains)
    pairs = " or ".join(
        f"{what}.{joints[a]} and {what}.{joints[b]}" for now, (what, a, b) in tried if now < ALIKE * best
    )
    note = (
        f"The columns {pairs} are probably swapped: with them exchanged the error falls from {100 * error:.3g} % to "
        f"{100 * best:.3g} %. Exchange the names in the recordings' headers."
    )
    return [note]


def _pairs(dataset: Dataset) -> Iterator[tuple[str, int, int]]:
    motors = len(dataset.robot.nominal_gains)
    for what in ("current", "position"):
        for a, b in combinations(range(motors), 2):
            yield what, a, b


def _swapped(recording: Recording, what: str, a: int, b: int) -> Recording:
    order = np.arange(recording.current.shape[1])
    order[[a, b]] = b, a
    if what == "current":
        return replace(recording, current=recording.current[:, order])
    return replace(recording, position=recording.position[:, order])


def _error_with(dataset: Dataset, result: Identification, what: str, a: int, b: int) -> float:
    """Relative error of the fit with two columns exchanged; inf where the robot cannot stand as they say."""
    fitted = [one for one in dataset.recordings if one.use == "identify"]
    swapped = replace(dataset, recordings=tuple(_swapped(one, what, a, b) for one in fitted))
    try:
        found = fit(prepare(swapped, filters=result.settings), "ls").error.identify
    except BenchError:  # loops that do not close
        return float("inf")
    return float("inf") if found is None else found
