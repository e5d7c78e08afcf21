"""Stated probabilities and standard errors compared with the truth, in numbers and figures."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import erf, sqrt
from operator import itemgetter
from pathlib import Path

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.benchmarks.trust.evaluation import Evaluation
from bench.document.charts.chart import Axis, Chart, Line, Panel, Whiskers
from bench.document.figures.write import CHART_DPI, chart_figure, write_figures
from bench.studies.sweep.journal import OK, Row, names_in
from bench.studies.trial.compatible import expected, optional
from bench.studies.trial.target import Share, Target, TargetFigure, ends_of, share_of

BOUNDS = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 0.99, 1.0)


@dataclass(frozen=True)
class Reliability:
    """Effects with a stated probability between two bounds: stated: its mean; there: the share that is present."""

    above: float
    below: float
    stated: float
    there: Share


def reliability(rows: Sequence[Row]) -> list[Reliability]:
    """Reliability by class of probability; classes without effects are omitted."""
    pairs = [pair for row in rows for pair in stated(row)]
    classes = []
    for above, below in pairwise(BOUNDS):
        last = below == BOUNDS[-1]
        inside = [(p, there) for p, there in pairs if above <= p < below or (last and p >= below)]
        if inside:
            mean = sum(p for p, _ in inside) / len(inside)
            classes.append(Reliability(above, below, mean, share_of(inside, itemgetter(1))))
    return classes


def stated(row: Row) -> list[tuple[float, bool]]:
    """Probability of each effect in a case, and whether it is present.

    Empty for a failed case, and for one with effects that are absorbed or outside the catalogue.
    """
    if row["status"] != OK or row["question"] not in MODELLED or row["absorbed"]:
        return []
    hidden = names_in(row["hidden"])
    there, aside = set(expected(hidden)), optional(hidden)
    return [
        (float(p), name in there) for name, p in json.loads(row["probabilities"]).items() if name not in aside
    ]


MODELLED = ("nothing", "one", "two", "three")
"""Questions whose hidden effects are all in the catalogue."""

COVERAGE = (0.90, 0.98)


def deviations(rows: Sequence[Row]) -> list[np.ndarray]:
    """For each case, |estimate - truth| of its gains in units of their standard deviations."""
    return [
        np.array([abs(gain["value"] - gain["truth"]) / gain["std"] for gain in json.loads(row["gains"])])
        for row in rows
        if row["status"] == OK
    ]


def coverage(rows: Sequence[Row]) -> Target:
    """Share of the 95 % intervals that contain the truth. A case counts once, as errors of its gains are correlated."""
    within = [float(np.mean(of <= WITHIN_95)) for of in deviations(rows)]
    value = float(np.mean(within)) if within else float("nan")
    share = Share(round(sum(within)), len(within))
    return Target(TargetFigure.GAINS_HELD, value, *COVERAGE, share)


LARGEST = 4.0  # standard deviations
SIZE = (5.6, 3.8)  # inches


def reliability_chart(classes: Sequence[Reliability]) -> Chart:
    """Share of effects that are present against the stated probability."""
    stated = np.array([one_class.stated for one_class in classes])
    ends = ends_of(one_class.there for one_class in classes)
    return Chart(
        "Stated probabilities against frequencies",
        Axis("stated probability", "%", domain=(-0.03, 1.03)),
        (
            Panel(
                Axis("effect is there", "%", domain=(-0.03, 1.03)),
                (
                    Line("as it should be", "noise", np.array([0.0, 1.0]), np.array([0.0, 1.0])),
                    Whiskers("share, with its 95 % interval", "after", stated, *ends),
                ),
            ),
        ),
    )


def coverage_chart(within: np.ndarray) -> Chart:
    """Share of gains within k standard deviations of the truth. within (N,): `deviations` of all gains."""
    k = np.linspace(0.0, LARGEST, 81)
    shares = np.array([np.mean(within <= limit) for limit in k])
    normal = np.array([erf(limit / sqrt(2.0)) for limit in k])
    return Chart(
        "Drive gains within k standard deviations of the truth",
        Axis("k", domain=(0.0, LARGEST)),
        (
            Panel(
                Axis("share of gains", "%", domain=(0.0, 1.03)),
                (Line("as it should be", "noise", k, normal), Line("reached", "after", k, shares)),
            ),
        ),
    )


def write_trust_figures(evaluation: Evaluation, folder: Path) -> list[Path]:
    """Write the figures for which there are cases; return their paths."""
    rows = evaluation.of(evaluation.robots, MODELLED)
    charts = {}
    if classes := reliability(rows):
        charts["reliability.png"] = reliability_chart(classes)
    if within := deviations(rows):
        charts["coverage.png"] = coverage_chart(np.concatenate(within))
    figures = {name: chart_figure(chart, chart.title, SIZE) for name, chart in charts.items()}
    return write_figures(folder, figures, dpi=CHART_DPI)
