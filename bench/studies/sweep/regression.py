"""What got worse and what got better, in units of the spread from seed to seed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np

from bench.studies.sweep.metrics import is_share
from bench.studies.sweep.reference import ReferenceLine

Verdict = Literal["same", "better", "worse", "over its limit", "new"]
ALARMS = ("worse", "over its limit")
COVERAGE = 0.95
RELATIVE_SPREAD = 0.01  # least spread, as a share of the value: where one seed is all there is
LEAST_SPREAD = 1e-12
LIMITS = {
    "identify_error": "error.identify",
    "validate_error": "error.validate",
}
"""Tolerances of scenarios whose metric has another name; the others have theirs."""


@dataclass(frozen=True)
class ReferenceComparison:
    """One metric of one reference scenario.

    reference, now: means over the same seeds; of a share of intervals that hold the truth, the coverage.
    change: for the worse if positive, in units of the spread from seed to seed; None without a reference.
    limit: what no run may exceed; None where there is none.
    """

    sweep: str
    line: str
    metric: str
    reference: float | None
    now: float | None
    change: float | None
    tolerance: float
    limit: float | None
    verdict: Verdict


def compare_line(
    sweep: str,
    label: str,
    reference: ReferenceLine | None,
    now: ReferenceLine,
    tolerances: Mapping[str, float],
    limits: Mapping[str, float],
) -> list[ReferenceComparison]:
    """Every metric that has a tolerance, seed by seed; `limits`: what no run may exceed."""
    comparisons = []
    for metric, tolerance in tolerances.items():
        values = _by_seed(now, metric)
        limit = limits.get(metric)
        before = {} if reference is None else _by_seed(reference, metric)
        seeds = [seed for seed in now.seeds if seed in before]
        if not seeds:
            mean, change, old = _mean(list(values.values())), None, None
            verdict: Verdict = "new"
        else:
            old_values, new_values = [before[seed] for seed in seeds], [values[seed] for seed in seeds]
            old, mean = _mean(old_values), _mean(new_values)
            change = _change(metric, old_values, new_values, list(before.values()))
            verdict = _verdict(change, tolerance)
        if limit is not None and any(value is not None and value > limit for value in values.values()):
            verdict = "over its limit"
        comparisons.append(
            ReferenceComparison(sweep, label, metric, old, mean, change, tolerance, limit, verdict)
        )
    return comparisons


def limits_of(tolerances: Mapping[str, float]) -> dict[str, float]:
    """A scenario's tolerances by the names of metrics."""
    return {LIMITS.get(name, name): value for name, value in tolerances.items()}


def _by_seed(line: ReferenceLine, metric: str) -> dict[int, float | None]:
    values = line.values.get(metric)
    return {} if values is None else dict(zip(line.seeds, values, strict=True))


def _change(
    metric: str, old: Sequence[float | None], new: Sequence[float | None], everything: Sequence[float | None]
) -> float:
    """How much worse, in spreads; infinite where a run fails that did not."""
    if any(a is not None and b is None for a, b in zip(old, new, strict=True)):
        return float("inf")
    pairs = [(a, b) for a, b in zip(old, new, strict=True) if a is not None and b is not None]
    if not pairs:
        return float("-inf") if any(value is not None for value in new) else 0.0
    before, after = np.array(pairs).T
    if is_share(metric):
        unit = float(np.sqrt(COVERAGE * (1 - COVERAGE) / len(pairs)))
        return float(abs(after.mean() - COVERAGE) - abs(before.mean() - COVERAGE)) / unit
    known = np.array([value for value in everything if value is not None])
    spread = float(np.std(known, ddof=1)) if len(known) > 1 else 0.0
    unit = max(spread, RELATIVE_SPREAD * float(np.abs(known).mean()), LEAST_SPREAD)
    return float((after - before).mean()) / unit


def _verdict(change: float, tolerance: float) -> Verdict:
    if change > tolerance:
        return "worse"
    return "better" if change < -tolerance else "same"


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None
