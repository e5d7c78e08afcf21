"""The results of a trial, from its rows."""

import json
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from operator import itemgetter
from typing import Any

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.effects import CATALOGUE
from bench.studies.sweep.journal import Row, names_in
from bench.studies.trial.compatible import expected, optional
from bench.studies.trial.target import (
    FLOOR_FACTOR,
    GAIN_FACTOR,
    LAW_FACTOR,
    Share,
    Target,
    TargetFigure,
    share_of,
)

LARGE = 3.0
"""Times the noise floor: least error of each hidden effect for a case to count."""
SIZES = (0.0, 1.5, 3.0, 6.0, 12.0, np.inf)
"""Bounds of the classes of an effect's error, over the noise floor."""
NOTHING, SOMETHING, A_LAW = "nothing", "unexplained", "a law"
"""Entries of the confusion matrix for no hidden effect or no alarm, for an alarm without a name, and for an
identified law without a name.
"""


def placed(rows: Sequence[Row]) -> Share:
    """Share of the hidden and named effects at motors that were named at exactly the motors that have them.

    rows: cases with effects of the catalogue. A motor too many or too few counts as wrong. Effects of passive joints,
    bodies, payloads and the whole robot do not count, since the motors listed for them only show the effect.
    """
    return share_of([pair for row in rows for pair in _at_motors(row)], lambda pair: pair[0] == pair[1])


def _at_motors(row: Row) -> Iterator[tuple[set[str], set[str]]]:
    """For each hidden and named effect at motors, the true motors and the named ones."""
    named = {verdict["effect"]: set(verdict["actuators"]) for verdict in json.loads(row["verdicts"])}
    missing = names_in(row["missing"])
    for effect, joints in zip(names_in(row["hidden"]), names_in(row["joints"]), strict=True):
        if effect in missing and CATALOGUE[effect].place == "actuator":
            yield set(joints.split(",")), named[effect]


@dataclass(frozen=True)
class Miss:
    """Single hidden effects of one class of size: shares named first, strictly and including undecided cases."""

    above: float
    below: float
    first: Share
    first_undecided: Share


@dataclass(frozen=True)
class Coverage:
    """Share of the intervals of one parameter of an effect that contain the truth.

    deviation: median of |estimate - truth| in standard errors; 0.67 if these are right.
    """

    effect: str
    parameter: str
    within: Share
    deviation: float


@dataclass(frozen=True)
class TrialSummary:
    """All figures of a trial.

    confusion: hidden effect -> first named effect -> count, for single large effects (those outside the catalogue
    last) and for nothing hidden. undecided: hidden effect -> number of cases in which it was an explicit alternative.
    absorbed: hidden effect -> share of its absorbed cases in which nothing was named. small: number of cases that do
    not count, because a hidden effect is too small.
    """

    robot: str
    rows: int
    failed: Mapping[str, int]
    targets: tuple[Target, ...]
    confusion: Mapping[str, Mapping[str, int]]
    undecided: Mapping[str, int]
    absorbed: Mapping[str, Share]
    misses: tuple[Miss, ...]
    coverage: tuple[Coverage, ...]
    small: int = 0


def summarised(robot: str, rows: Sequence[Row]) -> TrialSummary:
    """The figures of these rows; a failed case only counts as failed."""
    done = [row for row in rows if row["status"] == "ok"]
    seen = [row for row in done if not row["absorbed"]]
    hidden = [row for row in seen if row["kind"] != "nothing"]
    large = [row for row in hidden if row["least_own_error_over_floor"] >= LARGE]
    absorbing = [row for row in done if row["absorbed"]]
    return TrialSummary(
        robot=robot,
        rows=len(rows),
        failed=Counter(row["reason"] for row in rows if row["status"] != "ok"),
        targets=_targets(done, large),
        small=len(hidden) - len(large),
        confusion=_confusion([row for row in large if row["kind"] in ("one", "outside")], done),
        undecided=Counter(
            row["hidden"]
            for row in large
            if row["kind"] == "one" and row["first_undecided"] and not row["first"]
        ),
        absorbed={
            name: share_of(
                [row for row in absorbing if row["hidden"] == name], lambda row: not row["missing"]
            )
            for name in sorted({row["hidden"] for row in absorbing})
        },
        misses=_misses([row for row in seen if row["kind"] == "one"]),
        coverage=_coverage([row for row in large if row["exact"]]),
    )


def first_named(row: Row) -> str:
    """The first effect that a diagnosis names, without companions and parts of the hidden ones; else A_LAW, SOMETHING
    or NOTHING.
    """
    drawn = names_in(row["hidden"])
    aside = {*expected(drawn), *optional(drawn)} - set(drawn)
    names = [name for name in names_in(row["missing"]) if name not in aside]
    if names:
        return names[0]
    return A_LAW if _laws(row) else SOMETHING if row["unexplained"] else NOTHING


def _targets(done: Sequence[Row], large: Sequence[Row]) -> tuple[Target, ...]:
    def of(kind: str, rows: Sequence[Row] = large) -> list[Row]:
        return [row for row in rows if row["kind"] == kind]

    def share(
        figure: TargetFigure,
        rows: Sequence[Row],
        test: Callable[[Row], object],
        *,
        least: float | None = None,
        most: float | None = None,
    ) -> Target:
        count = share_of(rows, test)
        return Target(figure, count.value, least, most, count)

    hiding = [row for row in large if row["kind"] != "outside"]
    places = placed(hiding)
    searched = [row for row in of("outside") if row.get("laws") is not None]  # older trials lack the column
    targets = [
        share(TargetFigure.ONE_FIRST, of("one"), itemgetter("first"), least=0.95),
        share(TargetFigure.ONE_UNDECIDED, of("one"), itemgetter("first_undecided")),
        share(TargetFigure.TWO_EXACT, of("two"), itemgetter("exact"), least=0.85),
        share(TargetFigure.TWO_UNDECIDED, of("two"), itemgetter("exact_undecided")),
        share(TargetFigure.THREE_EXACT, of("three"), itemgetter("exact"), least=0.70),
        share(TargetFigure.THREE_UNDECIDED, of("three"), itemgetter("exact_undecided")),
        Target(TargetFigure.PLACES, places.value, None, None, places),
        share(TargetFigure.ALARM, of("nothing", done), alarm, most=0.02),
        share(TargetFigure.ALARM_NAMED, of("nothing", done), itemgetter("missing")),
        share(TargetFigure.OUTSIDE_HONEST, of("outside"), honest, least=0.90),
        share(TargetFigure.OUTSIDE_UNEXPLAINED, of("outside"), itemgetter("unexplained")),
        share(TargetFigure.OUTSIDE_LAW, searched, _law_at_floor),
        share(TargetFigure.OUTSIDE_NO_WRONG_NAME, of("outside"), lambda r: not r["wrong"]),
    ]
    targets += _gain_targets(hiding)
    floors = [row["error_over_floor.after"] for row in hiding]
    targets.append(Target(TargetFigure.FLOOR_MEDIAN, _median(floors), None, FLOOR_FACTOR))
    targets.append(
        share(TargetFigure.FLOOR_WITHIN, hiding, lambda r: r["error_over_floor.after"] <= FLOOR_FACTOR)
    )
    targets.append(
        share(TargetFigure.FLOOR_WITHIN_TOLD, hiding, lambda r: r["error_over_floor.told"] <= FLOOR_FACTOR)
    )
    exact = (row for row in hiding if row["exact"])
    within = share_of((interval for row in exact for interval in json.loads(row["intervals"])), _holds)
    targets.append(Target(TargetFigure.INTERVALS, within.value, 0.88, 0.99, within))
    return tuple(targets)


def _gain_targets(rows: Sequence[Row]) -> list[Target]:
    after, informed, before = (
        _rms([row[f"gain_error.{name}"] for row in rows]) for name in ("after", "told", "before")
    )
    median = _median([row["gain_error.after"] for row in rows]) / _median(
        [row["gain_error.told"] for row in rows]
    )
    near = share_of(rows, lambda row: row["gain_error.after"] <= GAIN_FACTOR * row["gain_error.told"])
    return [
        Target(TargetFigure.GAIN_ERROR_MEDIANS, median, None, GAIN_FACTOR),
        Target(TargetFigure.GAIN_ERROR_RMS, after / informed if informed else float("nan"), None, None),
        Target(TargetFigure.GAIN_ERROR_WITHIN, near.value, None, None, near),
        Target(TargetFigure.GAIN_ERROR_BEFORE, before, None, None),
        Target(TargetFigure.GAIN_ERROR_AFTER, after, None, None),
        Target(TargetFigure.GAIN_ERROR_TOLD, informed, None, None),
    ]


def alarm(row: Row) -> bool:
    """Whether a diagnosis names an effect, identifies a law, or reports an unexplained rest."""
    return bool(row["missing"]) or bool(row["unexplained"]) or bool(_laws(row))


def honest(row: Row) -> bool:
    """Whether a diagnosis identifies a law or reports an unexplained rest, without a wrong name."""
    return bool(row["unexplained"] or _laws(row)) and not row["wrong"]


def _law_at_floor(row: Row) -> bool:
    return bool(_laws(row)) and bool(row["error_over_floor.after"] <= LAW_FACTOR)


def _laws(row: Row) -> int:
    """Number of identified laws."""
    return int(row.get("laws") or 0)


def _confusion(alone: Sequence[Row], done: Sequence[Row]) -> dict[str, dict[str, int]]:
    counts: dict[str, Counter[str]] = {}
    nothing = [row for row in done if row["kind"] == "nothing"]
    ordered = sorted(alone, key=lambda row: (row["kind"] == "outside", row["hidden"]))
    for row in (*ordered, *nothing):
        counts.setdefault(row["hidden"] or NOTHING, Counter())[first_named(row)] += 1
    return {hidden: dict(named.most_common()) for hidden, named in counts.items()}


def _misses(rows: Sequence[Row]) -> tuple[Miss, ...]:
    misses = []
    for above, below in pairwise(SIZES):
        within = [row for row in rows if above <= row["least_own_error_over_floor"] < below]
        first, undecided = (share_of(within, itemgetter(name)) for name in ("first", "first_undecided"))
        misses.append(Miss(above, below, first, undecided))
    return tuple(misses)


def _coverage(rows: Sequence[Row]) -> tuple[Coverage, ...]:
    by_parameter: dict[tuple[str, str], list[Mapping[str, Any]]] = {}
    for row in rows:
        for load in json.loads(row["intervals"]):
            by_parameter.setdefault((load["effect"], load["parameter"]), []).append(load)
    return tuple(
        Coverage(
            effect,
            parameter,
            share_of(ones, _holds),
            _median([abs(interval["value"] - interval["truth"]) / interval["std"] for interval in ones]),
        )
        for (effect, parameter), ones in sorted(by_parameter.items())
    )


def _holds(interval: Mapping[str, Any]) -> bool:
    return bool(abs(interval["value"] - interval["truth"]) <= WITHIN_95 * interval["std"])


def _median(values: Sequence[float]) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _rms(values: Sequence[float]) -> float:
    return float(np.sqrt(np.mean(np.square(values)))) if len(values) else float("nan")
