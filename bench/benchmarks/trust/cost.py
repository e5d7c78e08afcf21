"""What each cell cost, and what of it was not run."""

from __future__ import annotations

from bench.benchmarks.trust.evaluation import Evaluation
from bench.benchmarks.trust.overview import NO_CASE, interval_text
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.work import PROCESSOR
from bench.document.markdown.tables import rows_in_markdown
from bench.studies.sweep.journal import OK, Row
from bench.studies.sweep.progress import duration_text
from bench.studies.trial.cases import Kind


def cost_table(evaluation: Evaluation) -> str:
    """Robots × questions: cases run of those planned, mean cost, and the interval where cases were not run."""
    lines = []
    for robot in evaluation.robots:
        cells = [cell for cell in evaluation.cells if cell.robot == robot and not cell.frozen]
        by_kind = {cell.question: cell.planned for cell in cells}
        rows = evaluation.of([robot], tuple(QUESTIONS)) + evaluation.of(
            [robot], tuple(QUESTIONS), frozen=True
        )
        texts = [_cell(evaluation.of([robot], [kind]), planned, kind) for kind, planned in by_kind.items()]
        lines.append([robot, *texts, duration_text(sum(map(cost_of, rows)))])
    heads = ["", *(question.title.partition(":")[0] for question in QUESTIONS.values()), "all, frozen too"]
    return rows_in_markdown(heads, lines)


def cost_of(row: Row) -> float:
    """Seconds of one processor."""
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
        target = QUESTIONS[kind].target(rows)
        text += f", interval {interval_text(target) if target.share and target.share.of else NO_CASE}"
    return text.replace(" ", "&nbsp;").replace(",&nbsp;", ", ")
