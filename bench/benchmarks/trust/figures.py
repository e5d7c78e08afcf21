"""Figures of an evaluation: probabilities against frequencies, and coverage of the gains' intervals."""

from __future__ import annotations

from collections.abc import Sequence
from math import erf, sqrt
from pathlib import Path

import numpy as np

from bench.benchmarks.trust.evaluation import Evaluation
from bench.benchmarks.trust.gains import MODELLED, deviations
from bench.benchmarks.trust.reliability import Reliability, reliability
from bench.document.charts.chart import Axis, Chart, Line, Panel, Whiskers
from bench.document.figures.write import CHART_DPI, chart_figure, write_figures

LARGEST = 4.0  # standard deviations
SIZE = (5.6, 3.8)  # inches


def reliability_chart(classes: Sequence[Reliability]) -> Chart:
    """Share of effects that are there over the stated probability."""
    low, high = np.array([one_class.there.interval for one_class in classes]).T
    stated = np.array([one_class.stated for one_class in classes])
    shares = np.array([one_class.there.value for one_class in classes])
    return Chart(
        "Stated probabilities against frequencies",
        Axis("stated probability", "%", domain=(-0.03, 1.03)),
        (
            Panel(
                Axis("effect is there", "%", domain=(-0.03, 1.03)),
                (
                    Line("as it should be", "noise", np.array([0.0, 1.0]), np.array([0.0, 1.0])),
                    Whiskers("share, with its 95 % interval", "after", stated, shares, low, high),
                ),
            ),
        ),
    )


def coverage_chart(within: np.ndarray) -> Chart:
    """Share of gains within k standard deviations of the truth. within (N,): deviations of all gains."""
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
    """Draw what there are cases for."""
    rows = evaluation.of(evaluation.robots, MODELLED)
    charts = {}
    if classes := reliability(rows):
        charts["reliability.png"] = reliability_chart(classes)
    if within := deviations(rows):
        charts["coverage.png"] = coverage_chart(np.concatenate(within))
    figures = {name: chart_figure(chart, chart.title, SIZE) for name, chart in charts.items()}
    return write_figures(folder, figures, dpi=CHART_DPI)
