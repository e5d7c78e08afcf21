"""Whether two motors' columns of a log were taken for each other: tried where the model explains little."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from bench.dataset import Dataset
from bench.estimate.identify import fit
from bench.estimate.observation import Observation
from bench.estimate.prepare import Prepared, prepare
from bench.estimate.result import Identification

LIKELY = ("coulomb_friction", "viscous_friction")  # what nearly every machine has, lest it hide the swap
LARGE = 0.05  # relative error from which it is worth a try
SWAPPED = "are probably swapped"
BETTER = 0.5  # of the error: what a swap must bring it down to


def swapped_notes(dataset: Dataset, result: Identification) -> list[str]:
    """A sentence on the two motors whose columns, exchanged, bring the error down most; none where none do.

    Tried one pair at a time, in all fitted recordings and in each of them, with dry and viscous friction beside the
    rigid bodies and with the filters of the result. Where the error of the result is small, nothing is tried.
    """
    error = result.error.identify
    joints = list(result.drive_gains)
    if error is None or error < LARGE or len(joints) < 2:
        return []
    prepared = prepare(dataset, LIKELY, result.settings)
    own = _error(prepared)
    best, (names, a, b) = min(
        (_error(_exchanged(prepared, names, a, b)), (names, a, b))
        for names, a, b in _swaps(prepared, len(joints))
    )
    if not best < BETTER * own:
        return []
    first, second = joints[a], joints[b]
    where = "" if len(names) == len(prepared.fitted) else f" in {names[0]}"
    note = (
        f"The columns of {first} and {second}{where} {SWAPPED}: with current.{first} and current.{second} "
        f"exchanged (or their positions, on a symmetric robot), and with friction, the error falls to "
        f"{100 * best:.3g} %. Exchange the names in the header."
    )
    return [note]


def _swaps(prepared: Prepared, motors: int) -> Iterator[tuple[tuple[str, ...], int, int]]:
    """Names of recordings, and the two motors whose columns may be exchanged in them."""
    names = tuple(one.name for one in prepared.fitted)
    for chosen in dict.fromkeys([names, *((name,) for name in names)]):
        for a, b in combinations(range(motors), 2):
            yield chosen, a, b


def _exchanged(prepared: Prepared, names: Sequence[str], a: int, b: int) -> Prepared:
    def one(rows: Observation) -> Observation:
        if rows.name not in names:
            return rows
        order = np.arange(rows.current.shape[1])
        order[[a, b]] = b, a
        return replace(rows, current=rows.current[:, order])

    return replace(prepared, observations=tuple(map(one, prepared.observations)))


def _error(prepared: Prepared) -> float:
    """Relative error of the fit, inf where there is none."""
    found = fit(prepared, "ls").error.identify
    return float("inf") if found is None else found
