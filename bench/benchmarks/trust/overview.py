"""The table robots × questions: each cell a share with its interval, and whether it reaches its goal."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from math import isfinite

from bench.benchmarks.trust.evaluation import Evaluation
from bench.benchmarks.trust.gains import MODELLED, coverage
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.stability import NOISE, WITHOUT_LOG, stability
from bench.document.markdown.tables import rows_in_markdown
from bench.studies.sweep.journal import Row
from bench.studies.trial.target import Attained, Target

MARKS = {Attained.YES: "✓", Attained.NO: "✗", Attained.TOO_FEW: "?", None: ""}
NO_CASE = "–"
ALL = "all"
DASH = "\u2060–\u2060"  # between word joiners: no line ends there
FEWEST = 5  # cases of which a share is said to miss its goal
NARROW = 10.0  # %
KEY = (
    "✓: reaches its goal; ✗: certainly misses it; ?: too few cases to say. In brackets: 95 % interval. A case counts "
    "if leaving out any one hidden effect raises the error of recordings that were not fitted to at least three times "
    "the noise floor. Cases go where the interval is widest for its goal: robots with wrong answers weigh more in the "
    "row of all."
)


@dataclass(frozen=True)
class OverviewColumn:
    """A question as a column: the kinds of cases that it is asked of, and its share of them."""

    title: str
    kinds: tuple[str, ...]
    target: Callable[[Sequence[Row]], Target]


def columns() -> list[OverviewColumn]:
    """All questions: of each kind, of gains, and of stability."""
    shown = [
        OverviewColumn(question.title, (question.kind,), question.target) for question in QUESTIONS.values()
    ]
    shown.append(OverviewColumn("95 % intervals of gains contain the truth", MODELLED, coverage))
    for change, title in (
        (NOISE, "certain verdicts stay with more noise"),
        (WITHOUT_LOG, "certain verdicts stay without a log"),
    ):
        shown.append(OverviewColumn(title, tuple(QUESTIONS), partial(stability, change=change)))
    return shown


def overview(evaluation: Evaluation, *, frozen: bool = False) -> str:
    """Robots × questions, in Markdown."""
    shown = columns()[: len(QUESTIONS)] if frozen else columns()
    robots = evaluation.robots
    lines = [["goal", *(goal_text(column.target([])) for column in shown)]]
    groups = [(robot, [robot]) for robot in robots] + [(f"**{ALL}**", list(robots))] * (len(robots) > 1)
    for name, group in groups:
        cells = [column.target(evaluation.of(group, column.kinds, frozen=frozen)) for column in shown]
        lines.append([name, *map(target_text, cells)])
    return rows_in_markdown(["", *(column.title for column in shown)], lines)


def target_text(target: Target) -> str:
    """Such as "✓ 43 of 45 (85–99 %)"."""
    share = target.share
    if share is None or not share.of or not isfinite(target.value):
        return NO_CASE
    kept = target.kept if share.of >= FEWEST else Attained.TOO_FEW
    counted = f"{MARKS[kept]} {share.count} of {share.of}".strip().replace(" ", "&nbsp;")
    text = f"{counted}<br>({interval_text(target)})"
    return f"**{text}**" if kept is Attained.NO else text


def interval_text(target: Target) -> str:
    """Such as "85–99 %"."""
    if target.share is None:
        return NO_CASE
    low, high = (100.0 * bound for bound in target.share.interval)
    digits = 0 if high - low >= NARROW else 1
    return f"{low:.{digits}f}{DASH}{high:.{digits}f}&nbsp;%"


def goal_text(target: Target) -> str:
    """Such as "≥ 95 %"."""
    least, most = (None if bound is None else f"{100.0 * bound:.0f}" for bound in (target.least, target.most))
    if least and most:
        return f"{least} to {most}&nbsp;%"
    return f"≥&nbsp;{least}&nbsp;%" if least else f"≤&nbsp;{most}&nbsp;%"
