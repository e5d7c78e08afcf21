"""The kept figures of `bench excite` as a page: results/excite/excite.md."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from bench.basics.files.atomic import write_text_atomically
from bench.document.markdown.tables import rows_in_markdown
from bench.identification.wording import in_percent
from bench.studies.excite_forecast import CONFIDENCE

PAGE = "excite.md"
UNKNOWN = "–"
BETTER = (
    "robot",
    "worst relative standard error",
    "median of random motions",
    "best of them",
    "times better than the median",
    "commit",
)
TRUE = ("robot", "repetitions", "unknowns", "on the whole", "smallest", "largest", "by chance alone")
PLANNED = """\
Motions of 10 s by `bench excite`, one unloaded and one with the payload of the robot's scenario, and 50 random motions
inside the same limits. The worst of all unknowns counts."""
REPEATED = """\
Below, the simulated machine runs the planned motions repeatedly, with different noise in each log. Each log
is identified. The ratio of the standard deviation of the estimates to the predicted standard error is 1 if the
prediction is right."""
INTERVALS = """\
so many repetitions cannot determine a standard deviation more precisely. Those of the smallest and the largest
ratio hold for all unknowns at once (Bonferroni), because these two were selected from all. "By chance alone": the
range of all ratios, with at least that probability, if every prediction is exact. "On the whole" is the root mean
square over the unknowns; its interval takes account of their correlations."""

Figures = Mapping[str, Any]


def kept_figures(folder: Path, robots: Sequence[str]) -> list[Figures]:
    """The figures of those robots that have a file in the folder."""
    files = [folder / f"{robot}.json" for robot in robots]
    return [json.loads(file.read_text(encoding="utf-8")) for file in files if file.is_file()]


def write_page(folder: Path, robots: Sequence[str]) -> None:
    """Write the page next to the figures of which it is made."""
    write_text_atomically(folder / PAGE, page(kept_figures(folder, robots)))


def page(robots: Sequence[Figures]) -> str:
    """Both tables as Markdown."""
    parts = (
        "# Planned motions, and whether predictions come true",
        PLANNED,
        rows_in_markdown(BETTER, map(_better, robots)),
        REPEATED,
        rows_in_markdown(TRUE, [_true(figures) for figures in robots if "pooled" in figures]),
        f"In brackets {in_percent(CONFIDENCE, 2)} intervals by chi-square:\n{INTERVALS}",
        "`python -m bench.studies.excite_figures ROBOT --repetitions N -o results/excite` rewrites this page.",
    )
    return "\n\n".join(parts) + "\n"


def _better(figures: Figures) -> Sequence[str]:
    errors = [in_percent(figures[name], 2) for name in ("worst", "random_median", "random_best")]
    return figures["robot"], *errors, f"{figures['better']:.1f}", figures.get("commit", UNKNOWN)


def _true(figures: Figures) -> Sequence[str]:
    intervals = [with_interval(figures, name) for name in ("pooled", "smallest", "largest")]
    unknowns = str(len(figures["ratios"])) if "ratios" in figures else UNKNOWN
    chance = "{:.2f} to {:.2f}".format(*figures["chance"]) if "chance" in figures else UNKNOWN
    return figures["robot"], str(figures["repetitions"]), unknowns, *intervals, chance


def with_interval(figures: Figures, name: str) -> str:
    """Such as 0.99 [0.97, 1.01]; without the interval where an older file has none."""
    interval = figures.get(f"{name}_interval")
    return f"{figures[name]:.2f}" + ("" if interval is None else " [{:.2f}, {:.2f}]".format(*interval))
