"""Tables robots × questions: shares with their intervals, cost of the cells, and the table of README.md."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import isfinite
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.benchmarks.trust.calibration import MODELLED, coverage
from bench.benchmarks.trust.evaluation import Evaluation
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.stability import NOISE, WITHOUT_LOG, stability
from bench.benchmarks.trust.work import PROCESSOR
from bench.document.markdown.tables import rows_in_markdown
from bench.studies.sweep.journal import OK, Row
from bench.studies.sweep.progress import duration_text
from bench.studies.trial.cases import Kind
from bench.studies.trial.target import Attained, Share, Target

MARKS = {Attained.YES: "✓", Attained.NO: "✗", Attained.TOO_FEW: "?", None: ""}
NO_CASE = "–"
ALL = "all"
DASH = "\u2060–\u2060"  # between word joiners, which prevent a line break
FEWEST = 5  # cases, below which a share is not said to reach or miss its goal
NARROW = 10.0  # %, width of an interval below which it has a decimal
KEY = (
    "✓: reaches its goal; ✗: certainly misses it; ?: too few cases to say. In brackets: 95 % interval. A case counts "
    "if leaving out any one hidden effect raises the error of recordings that were not fitted to at least three times "
    "the noise floor. Cases go where the interval is widest for its goal: robots with wrong answers weigh more in the "
    "row of all."
)


@dataclass(frozen=True)
class OverviewColumn:
    """A question as a column. kinds: of its cases; target: the share of rows with its bounds."""

    title: str
    kinds: tuple[str, ...]
    target: Callable[[Sequence[Row]], Target]


def columns() -> list[OverviewColumn]:
    """All questions: on each kind of case, on gains, and on stability."""
    noise, logs = (partial(stability, change=change) for change in (NOISE, WITHOUT_LOG))
    return [
        *(OverviewColumn(each.title, (each.kind,), each.target) for each in QUESTIONS.values()),
        OverviewColumn("95 % intervals of gains contain the truth", MODELLED, coverage),
        OverviewColumn("certain verdicts stay with more noise", tuple(QUESTIONS), noise),
        OverviewColumn("certain verdicts stay without a log", tuple(QUESTIONS), logs),
    ]


def overview(evaluation: Evaluation, *, frozen: bool = False) -> str:
    """The table robots × questions in Markdown; frozen: of the frozen set, without gains and stability."""
    shown = columns()[: len(QUESTIONS)] if frozen else columns()
    robots = evaluation.robots
    lines = [["goal", *(goal_text(column.target([])) for column in shown)]]
    groups = [(robot, [robot]) for robot in robots] + [(f"**{ALL}**", list(robots))] * (len(robots) > 1)
    for name, group in groups:
        cells = [column.target(evaluation.of(group, column.kinds, frozen=frozen)) for column in shown]
        lines.append([name, *map(target_text, cells)])
    return rows_in_markdown(["", *(column.title for column in shown)], lines)


def target_text(target: Target) -> str:
    """A share as text, for example "✓ 43 of 45 (85–99 %)"."""
    share = target.share
    if share is None or not share.of or not isfinite(target.value):
        return NO_CASE
    kept = target.kept if share.of >= FEWEST else Attained.TOO_FEW
    counted = f"{MARKS[kept]} {share.count} of {share.of}".strip().replace(" ", "&nbsp;")
    text = f"{counted}<br>({interval_text(share)})"
    return f"**{text}**" if kept is Attained.NO else text


def interval_text(share: Share | None) -> str:
    """The interval of a share, for example "85–99 %"; a dash without cases."""
    if share is None or not share.of:
        return NO_CASE
    low, high = (100.0 * bound for bound in share.interval)
    digits = 0 if high - low >= NARROW else 1
    return f"{low:.{digits}f}{DASH}{high:.{digits}f}&nbsp;%"


def goal_text(target: Target) -> str:
    """The bounds of a share, for example "≥ 95 %"."""
    least, most = (None if bound is None else f"{100.0 * bound:.0f}" for bound in (target.least, target.most))
    if least and most:
        return f"{least} to {most}&nbsp;%"
    return f"≥&nbsp;{least}&nbsp;%" if least else f"≤&nbsp;{most}&nbsp;%"


def cost_table(evaluation: Evaluation) -> str:
    """Robots × questions: cases run of those planned, mean cost, and the interval if not all were run."""
    lines = []
    for robot in evaluation.robots:
        cells = [cell for cell in evaluation.cells if cell.robot == robot and not cell.frozen]
        by_kind = {cell.question: cell.planned for cell in cells}
        rows = [row for row in evaluation.rows if row["robot"] == robot]
        texts = [_cell(evaluation.of([robot], [kind]), planned, kind) for kind, planned in by_kind.items()]
        lines.append([robot, *texts, duration_text(sum(map(cost_of, rows)))])
    heads = ["", *(question.title.partition(":")[0] for question in QUESTIONS.values()), "all, frozen too"]
    return rows_in_markdown(heads, lines)


def cost_of(row: Row) -> float:
    """Processor time of a case with its further diagnoses, s."""
    return float(row[PROCESSOR]) + float(row.get(f"{PROCESSOR}.again") or 0.0)


def _cell(rows: list[Row], planned: int, kind: Kind) -> str:
    if not planned:
        return "none possible"
    if not rows:
        return f"0&nbsp;of&nbsp;{planned}"
    text = f"{len(rows)} of {planned}, {sum(map(cost_of, rows)) / len(rows):.1f} s"
    failed = sum(row["status"] != OK for row in rows)
    text += f", {failed} failed" if failed else ""
    if len(rows) < planned:
        text += f", interval {interval_text(QUESTIONS[kind].target(rows).share)}"
    return text.replace(" ", "&nbsp;").replace(",&nbsp;", ", ")


BEGIN, END = "<!-- evaluation -->", "<!-- end of evaluation -->"
SPOKEN: Mapping[str, str] = {
    "five_bar": "five-bar",
    "delta": "Delta",
    "three_rrr": "3-RRR",
    "stewart": "hexapod",
    "dualv": "DualV",
    "orthoglide": "Orthoglide",
    "two_link": "serial arm",
}


def readme_block(evaluation: Evaluation) -> str:
    """The text between the marks: the origin of the figures, and the table questions × robots."""
    robots = evaluation.robots
    groups = [*([robot] for robot in robots), list(robots)]
    lines = [["largest gain error, median", *(_gain_error(evaluation, group) for group in groups)]]
    for kind, question in QUESTIONS.items():
        shares = [question.target(evaluation.of(group, [kind])).share for group in groups]
        counts = [f"{share.count} of {share.of}" if share and share.of else NO_CASE for share in shares]
        lines.append([question.title, *counts[:-1], f"{counts[-1]} ({interval_text(shares[-1])})"])
    table = rows_in_markdown(
        ["", *(SPOKEN.get(robot, robot) for robot in robots), "all, 95 % interval"], lines
    )
    said = (
        "[Simulated machines](results/trust/trust.md) with 18 to 22-bit encoders and 0.2 to 2 % current noise, gains "
        "wrong by up to\na tenth, and hidden effects whose error is at least three times the noise floor "
        f"(`make trust`, commit `{evaluation.commits}`):"
    )
    return f"{said}\n\n{table}"


def with_block(text: str, block: str) -> str:
    """The text of a README with its block replaced. Raises BenchError if it has no marks."""
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise BenchError(f"README.md: no {BEGIN} … {END}")
    return f"{before}{BEGIN}\n{block}\n{END}{after}"


def write_readme(evaluation: Evaluation, path: Path) -> None:
    """Replace the block of a README."""
    write_text_atomically(path, with_block(path.read_text(encoding="utf-8"), readme_block(evaluation)))


def _gain_error(evaluation: Evaluation, robots: Sequence[str]) -> str:
    errors = [row["gain_error.after"] for row in evaluation.of(robots, MODELLED) if row["status"] == OK]
    return f"{100.0 * float(np.median(errors)):.3f} %" if errors else "no case"
