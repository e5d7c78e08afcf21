"""Pictures of a trial: what was named for what, misses by size, and the error that is left."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from bench.effects.display_names import spoken
from bench.files.atomic import atomic_path
from bench.studies.sweep.journal import Row
from bench.studies.trial.markdown import size_text
from bench.studies.trial.summary import FLOOR_FACTOR, LARGE, NOTHING, SOMETHING, TrialSummary

BLUE, ORANGE, GREY = "#0072B2", "#C44E00", "#8A929C"
CELL = 0.26  # inches


def write_figures(summary: TrialSummary, rows: Sequence[Row], stem: Path) -> list[Path]:
    """Draw what there are cases for: STEM_confusion.png, STEM_misses.png, STEM_errors.png."""
    drawn = []
    figures = {
        "confusion": confusion_figure(summary) if set(summary.confusion) - {NOTHING} else None,
        "misses": misses_figure(summary) if any(miss.first.of for miss in summary.misses) else None,
        "errors": errors_figure(rows),
    }
    for name, figure in figures.items():
        if figure is None:
            continue
        path = stem.with_name(f"{stem.name}_{name}.png")
        with atomic_path(path) as partial:
            figure.savefig(partial, dpi=130)
        drawn.append(path)
    return drawn


def confusion_figure(summary: TrialSummary) -> Figure:
    """Hidden effect down, first named across, shares of the cases of a row."""
    hidden = [name for name in summary.confusion if name != NOTHING]
    hidden += [NOTHING] * (NOTHING in summary.confusion)
    named = {name for row in summary.confusion.values() for name in row}
    across = [name for name in hidden if name in named and name != NOTHING]
    across += sorted(named - set(across) - {SOMETHING, NOTHING})
    across += [name for name in (SOMETHING, NOTHING) if name in named]
    counts = np.array([[summary.confusion[h].get(n, 0) for n in across] for h in hidden], dtype=float)
    shares = counts / counts.sum(axis=1, keepdims=True)
    figure = Figure(figsize=(3.2 + CELL * len(across), 2.6 + CELL * len(hidden)), layout="constrained")
    axes = figure.add_subplot()
    axes.imshow(shares, cmap="Blues", vmin=0.0, vmax=1.0, aspect="equal")
    for i, j in zip(*np.nonzero(counts), strict=True):
        colour = "white" if shares[i, j] > 0.6 else "black"
        axes.text(j, i, f"{counts[i, j]:.0f}", ha="center", va="center", fontsize=6.5, color=colour)
    axes.set_xticks(range(len(across)), [spoken(name) for name in across], rotation=90, fontsize=7)
    axes.set_yticks(range(len(hidden)), [spoken(name) for name in hidden], fontsize=7)
    axes.set_xticks(np.arange(len(across) + 1) - 0.5, minor=True)
    axes.set_yticks(np.arange(len(hidden) + 1) - 0.5, minor=True)
    axes.grid(which="minor", color="#E6E9ED", linewidth=0.6)
    axes.tick_params(which="both", length=0)
    axes.set_xlabel("named first", fontsize=8)
    axes.set_ylabel("hidden", fontsize=8)
    figure.suptitle(
        f"{summary.robot}: cases with one effect hidden, own\nerror at least {LARGE:g} × the noise floor"
        + (", or nothing" if NOTHING in hidden else ""),
        fontsize=8,
        x=0.01,
        ha="left",
    )
    return figure


def misses_figure(summary: TrialSummary) -> Figure:
    """Share of effects that are not named first, by their own error over the noise floor."""
    figure = Figure(figsize=(6.0, 3.4), layout="constrained")
    axes = figure.add_subplot()
    classes = [miss for miss in summary.misses if miss.first.of]
    at = np.arange(len(classes))
    for shift, colour, label, shares in (
        (-0.12, ORANGE, "not named first", [miss.first for miss in classes]),
        (0.12, BLUE, "nor openly undecided", [miss.first_undecided for miss in classes]),
    ):
        missed = np.array([1.0 - share.value for share in shares])
        bounds = np.array([[1.0 - share.interval[1], 1.0 - share.interval[0]] for share in shares])
        spread = np.abs(bounds - missed[:, None]).T
        axes.errorbar(at + shift, missed, spread, fmt="o", color=colour, capsize=3, markersize=5, label=label)
    axes.set_xticks(at, [f"{size_text(miss)}\n({miss.first.of})" for miss in classes])
    axes.set_xlabel("error of the model without the effect, over the noise floor (cases)")
    axes.set_ylabel("share of cases")
    axes.set_ylim(-0.03, 1.03)
    _plain(axes)
    axes.legend(frameon=False, fontsize=8)
    axes.set_title(f"{summary.robot}: effects missed, by size", fontsize=9, loc="left")
    return figure


def errors_figure(rows: Sequence[Row]) -> Figure | None:
    """Error on recordings not fitted over the noise floor, before and after; None without any hidden effect."""
    done = [
        row
        for row in rows
        if row["status"] == "ok" and row["kind"] not in ("nothing", "outside") and not row["absorbed"]
    ]
    if not done:
        return None
    figure = Figure(figsize=(6.0, 3.8), layout="constrained")
    axes = figure.add_subplot()
    for exact, colour, label in ((True, BLUE, "set exact"), (False, ORANGE, "set not exact")):
        chosen = [row for row in done if row["exact"] is exact]
        axes.loglog(
            [row["error_over_floor.before"] for row in chosen],
            [row["error_over_floor.after"] for row in chosen],
            "o",
            markersize=3.5,
            color=colour,
            alpha=0.7,
            label=f"{label} ({len(chosen)})",
        )
    axes.axhline(FLOOR_FACTOR, color=GREY, linewidth=0.8, linestyle="--")
    low, high = axes.get_xlim()
    axes.plot([low, high], [low, high], color=GREY, linewidth=0.8)
    axes.set_xlabel("error before, over the noise floor")
    axes.set_ylabel("after the found effects")
    _plain(axes)
    axes.legend(frameon=False, fontsize=8)
    axes.set_title("error of the current on recordings that were not fitted", fontsize=9, loc="left")
    return figure


def _plain(axes: Axes) -> None:
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    axes.grid(visible=True, color="#E6E9ED", linewidth=0.6)
    axes.set_axisbelow(True)
