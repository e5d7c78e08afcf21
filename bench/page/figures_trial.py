"""Figures of a trial: what was named for what, misses by size, intervals, errors left."""

from collections.abc import Sequence
from typing import Any

from bench.page.parts import Figure, one_figure
from bench.page.thinned import significant
from bench.page.words import effect_name
from bench.studies.sweep.journal import Row
from bench.studies.trial.markdown import size_text
from bench.studies.trial.summary import FLOOR_FACTOR, LARGE, NOTHING, SOMETHING, TrialSummary

CELL, LABELS = 25, 190  # px
COVERAGE = 0.95

Spec = dict[str, Any]


def confusion_figure(summary: TrialSummary) -> Figure:
    """Hidden effect down, first named across; the shade is the share of a row's cases."""
    hidden = [name for name in summary.confusion if name != NOTHING]
    hidden += [NOTHING] * (NOTHING in summary.confusion)
    named = {name for line in summary.confusion.values() for name in line}
    across = [name for name in hidden if name in named and name != NOTHING]
    across += sorted(named - set(across) - {SOMETHING, NOTHING})
    across += [name for name in (SOMETHING, NOTHING) if name in named]
    x, y, share, texts = [], [], [], []
    for i, name in enumerate(hidden):
        line = summary.confusion[name]
        for other, count in line.items():
            x.append(across.index(other))
            y.append(i)
            share.append(round(count / sum(line.values()), 4))
            texts.append(str(count))
    cells = {"kind": "cells", "role": "after", "x": x, "y": y, "share": share, "texts": texts}
    rows = [f"{_spoken(name)} ({sum(summary.confusion[name].values())})" for name in hidden]
    columns = [_spoken(name) for name in across]
    spec = {
        "label": "Hidden effect against the effect named first",
        "height": 70 + 7 * max(map(len, columns)) + CELL * len(hidden),
        "least": LABELS + CELL * len(across),
        "x": {"label": "named first", "scale": "band", "categories": columns, "turned": True},
        "panels": [
            {"y": {"label": "hidden (cases)", "scale": "band", "categories": rows}, "series": [cells]}
        ],
    }
    aid = (
        "A number: cases. On the diagonal the hidden effect was named first. Counted are effects whose own error is "
        f"at least {LARGE:g} × the noise floor, and cases with nothing hidden."
    )
    return one_figure("Confusion matrix", aid, spec)


def misses_figure(summary: TrialSummary) -> Figure:
    """Share of effects that are not named first, by their own error over the noise floor."""
    classes = [miss for miss in summary.misses if miss.first.of]
    series = []
    for role, name, shift, shares in (
        ("before", "not named first", -0.1, [miss.first for miss in classes]),
        ("after", "nor openly undecided", 0.1, [miss.first_undecided for miss in classes]),
    ):
        series.append(
            {
                "kind": "bins",
                "clear": True,
                "apart": True,
                "role": role,
                "name": name,
                "x": [i + shift for i in range(len(classes))],
                "mean": significant([1.0 - share.value for share in shares]),
                "spread": [0.0] * len(classes),
                "low": significant([1.0 - share.interval[1] for share in shares]),
                "high": significant([1.0 - share.interval[0] for share in shares]),
            }
        )
    spec = {
        "label": "Effects missed, by size",
        "height": 270,
        "x": {
            "label": "own error over the noise floor (cases)",
            "scale": "band",
            "categories": [f"{size_text(miss)} ({miss.first.of})" for miss in classes],
        },
        "panels": [
            {"y": {"label": "share of cases [%]", "percent": True, "domain": [-0.04, 1.04]}, "series": series}
        ],
    }
    return one_figure(
        "Effects missed, by size",
        "Own error: that of a model without the effect. Whiskers: 95 % intervals of the share.",
        spec,
    )


def coverage_figure(summary: TrialSummary) -> Figure:
    """Share of the 95 % intervals that hold the truth, for each parameter."""
    shares = {
        "kind": "intervals",
        "role": "after",
        "name": "share, with its 95 % interval",
        "y": list(range(len(summary.coverage))),
        "x": significant([c.within.value for c in summary.coverage]),
        "low": significant([c.within.interval[0] for c in summary.coverage]),
        "high": significant([c.within.interval[1] for c in summary.coverage]),
    }
    rule = {"kind": "rule", "role": "noise", "name": "95 %", "axis": "x", "at": COVERAGE, "dashed": True}
    names = [f"{effect_name(c.effect)} {c.parameter} ({c.within.of})" for c in summary.coverage]
    spec = {
        "label": "Share of the intervals that hold the truth",
        "height": 76 + 22 * len(names),
        "x": {"label": "intervals that hold the truth [%]", "percent": True, "domain": [-0.02, 1.02]},
        "panels": [{"y": {"scale": "band", "categories": names}, "series": [rule, shares]}],
    }
    aid = "In brackets: how many intervals. A whisker that misses the line: this parameter's standard errors are off."
    return one_figure("Share of the intervals that hold the truth", aid, spec)


def errors_figure(rows: Sequence[Row]) -> Figure | None:
    """Error over the noise floor before and after, a dot a case; None without any hidden effect."""
    done = [
        row
        for row in rows
        if row["status"] == "ok" and row["kind"] not in ("nothing", "outside") and not row["absorbed"]
    ]
    if not done:
        return None
    series: list[Spec] = [
        {"kind": "rule", "role": "noise", "name": f"{FLOOR_FACTOR:g}", "at": FLOOR_FACTOR, "dashed": True}
    ]
    for exact, role, name in ((True, "after", "set exact"), (False, "before", "set not exact")):
        chosen = [row for row in done if bool(row["exact"]) is exact]
        if chosen:
            series.append(
                {
                    "kind": "points",
                    "role": role,
                    "name": f"{name} ({len(chosen)})",
                    "x": significant([row["error_over_floor.before"] for row in chosen]),
                    "y": significant([row["error_over_floor.after"] for row in chosen]),
                }
            )
    spec = {
        "label": "Error before and after, over the noise floor",
        "height": 320,
        "x": {"label": "error before, over the noise floor", "scale": "log", "room": True},
        "panels": [{"y": {"label": "error after, over the noise floor", "scale": "log"}, "series": series}],
    }
    aid = "A dot: a case. Below the dashed line: what is left is noise, within the limit of the trial."
    return one_figure("Error before and after", aid, spec)


def _spoken(name: str) -> str:
    return effect_name(name)
