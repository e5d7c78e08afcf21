"""Charts of a trial: what was named for what, misses by size, intervals, remaining errors."""

from collections.abc import Sequence

import numpy as np

from bench.document.charts.chart import Axis, Cells, Chart, Panel, Points, Role, Rule, Series, Spans, Whiskers
from bench.document.typeset import effect_name
from bench.studies.sweep.journal import Row
from bench.studies.trial.markdown import size_text
from bench.studies.trial.summary import A_LAW, FLOOR_FACTOR, LARGE, NOTHING, SOMETHING, Miss, TrialSummary
from bench.studies.trial.target import Share

COVERAGE = 0.95


def confusion_chart(summary: TrialSummary) -> Chart:
    """Hidden effect down, first named across; the shade is the share of a row's cases."""
    hidden = [name for name in summary.confusion if name != NOTHING]
    hidden += [NOTHING] * (NOTHING in summary.confusion)
    named = {name for line in summary.confusion.values() for name in line}
    across = [name for name in hidden if name in named and name != NOTHING]
    across += sorted(named - set(across) - {A_LAW, SOMETHING, NOTHING})
    across += [name for name in (A_LAW, SOMETHING, NOTHING) if name in named]
    cells = [
        (across.index(other), i, count / sum(summary.confusion[name].values()), str(count))
        for i, name in enumerate(hidden)
        for other, count in summary.confusion[name].items()
    ]
    x, y, shade, texts = zip(*cells, strict=True)
    rows = tuple(f"{effect_name(name)} ({sum(summary.confusion[name].values())})" for name in hidden)
    columns = tuple(effect_name(name) for name in across)
    return Chart(
        "Confusion matrix",
        Axis("named first", scale="band", categories=columns),
        (
            Panel(
                Axis("hidden (cases)", scale="band", categories=rows),
                (Cells("after", np.array(x), np.array(y), np.array(shade), texts),),
            ),
        ),
        aid="A number: cases. On the diagonal the hidden effect was named first. Only effects count whose error is "
        f"at least {LARGE:g} × the noise floor, and cases with nothing hidden.",
    )


def misses_chart(summary: TrialSummary) -> Chart:
    """Share of effects that are not named first, by their error over the noise floor."""
    classes = [miss for miss in summary.misses if miss.first.of]
    series = (
        _missed("not named first", "before", -0.1, [miss.first for miss in classes]),
        _missed("nor openly undecided", "after", 0.1, [miss.first_undecided for miss in classes]),
    )
    names = tuple(_class(miss) for miss in classes)
    return Chart(
        "Effects missed, by size",
        Axis("error of the effect over the noise floor (cases)", scale="band", categories=names),
        (Panel(Axis("share of cases", "%", domain=(-0.04, 1.04)), series),),
        aid="Error of the effect: that of a model without it. Whiskers: 95 % intervals of the share.",
    )


def coverage_chart(summary: TrialSummary) -> Chart:
    """Share of the 95 % intervals that hold the truth, for each parameter."""
    within = [covered.within for covered in summary.coverage]
    shares = Spans(
        "share, with its 95 % interval",
        "after",
        np.arange(len(within)),
        np.array([share.value for share in within]),
        np.array([share.interval[0] for share in within]),
        np.array([share.interval[1] for share in within]),
    )
    rule = Rule("95 %", "noise", "x", COVERAGE, dashed=True)
    names = tuple(
        f"{effect_name(covered.effect)} {covered.parameter} ({covered.within.of})"
        for covered in summary.coverage
    )
    return Chart(
        "Share of the intervals that hold the truth",
        Axis("intervals that hold the truth", "%", domain=(-0.02, 1.02)),
        (Panel(Axis("", scale="band", categories=names), (rule, shares)),),
        aid="In brackets: how many intervals. A whisker that misses the line: this parameter's standard errors are "
        "off.",
    )


def errors_chart(rows: Sequence[Row]) -> Chart | None:
    """Error over the noise floor before and after, a dot a case; None without any hidden effect."""
    done = [
        row
        for row in rows
        if row["status"] == "ok" and row["kind"] not in ("nothing", "outside") and not row["absorbed"]
    ]
    if not done:
        return None
    series: list[Series] = [Rule(f"{FLOOR_FACTOR:g}", "noise", "y", FLOOR_FACTOR, dashed=True)]
    sets: tuple[tuple[bool, Role, str], ...] = (
        (True, "after", "set exact"),
        (False, "before", "set not exact"),
    )
    for exact, role, name in sets:
        chosen = [row for row in done if bool(row["exact"]) is exact]
        if chosen:
            before, after = (
                np.array([row[f"error_over_floor.{when}"] for row in chosen]) for when in ("before", "after")
            )
            series.append(Points(f"{name} ({len(chosen)})", role, before, after))
    return Chart(
        "Error before and after, over the noise floor",
        Axis("error before, over the noise floor", scale="log", room=True),
        (Panel(Axis("error after, over the noise floor", scale="log"), tuple(series)),),
        aid="A dot: a case. Below the dashed line only noise remains, within the limit of the trial.",
    )


def _missed(name: str, role: Role, shift: float, shares: Sequence[Share]) -> Whiskers:
    at = np.arange(len(shares)) + shift
    share = np.array([1.0 - each.value for each in shares])
    low = np.array([1.0 - each.interval[1] for each in shares])
    high = np.array([1.0 - each.interval[0] for each in shares])
    return Whiskers(name, role, at, share, low, high, joined=False)


def _class(miss: Miss) -> str:
    return f"{size_text(miss)} ({miss.first.of})"
