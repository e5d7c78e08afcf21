"""Stated probabilities against frequencies: of effects with about the same probability, how many are there."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from bench.benchmarks.trust.gains import MODELLED
from bench.studies.sweep.journal import OK, Row
from bench.studies.trial.compatible import expected, optional
from bench.studies.trial.name_list import names_in
from bench.studies.trial.target import Share

BOUNDS = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)


@dataclass(frozen=True)
class Reliability:
    """Effects with a stated probability between two bounds: its mean, and how many are there."""

    above: float
    below: float
    stated: float
    there: Share


def reliability(rows: Sequence[Row]) -> list[Reliability]:
    """By class of probability; classes without an effect are omitted."""
    pairs = [pair for row in rows for pair in stated(row)]
    classes = []
    for above, below in pairwise(BOUNDS):
        last = below == BOUNDS[-1]
        inside = [(p, there) for p, there in pairs if above <= p < below or (last and p >= below)]
        if inside:
            mean = sum(p for p, _ in inside) / len(inside)
            classes.append(
                Reliability(above, below, mean, Share(sum(there for _, there in inside), len(inside)))
            )
    return classes


def stated(row: Row) -> list[tuple[float, bool]]:
    """Probability of each effect of a case with effects of the catalogue, and whether it is there."""
    if row["status"] != OK or row["question"] not in MODELLED or row["absorbed"]:
        return []
    hidden = names_in(row["hidden"])
    there, aside = set(expected(hidden)), optional(hidden)
    return [
        (float(p), name in there) for name, p in json.loads(row["probabilities"]).items() if name not in aside
    ]
