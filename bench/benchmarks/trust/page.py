"""The page of an evaluation, made from its table."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from bench.basics.files.atomic import write_text_atomically
from bench.basics.plural import plural
from bench.benchmarks.trust.calibration import (
    MODELLED,
    coverage,
    deviations,
    reliability,
    write_trust_figures,
)
from bench.benchmarks.trust.evaluation import Evaluation, read_evaluation
from bench.benchmarks.trust.overview import KEY, cost_of, cost_table, interval_text, overview, target_text
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.stability import NOISE, SURE, WITHOUT_LOG, changed
from bench.benchmarks.trust.words import answer_text, hidden_text, is_wrong, sentences
from bench.document.markdown.tables import rows_in_markdown
from bench.studies.sweep.journal import OK, Row
from bench.studies.sweep.progress import duration_text

PAGE = "trust.md"
ELSEWHERE = (
    "Measured machines, and logs of one machine compared with each other: [measured machines]"
    "(../measured/measured.md). Forecasts of planned motions against results: [planned motions](../excite/excite.md). "
    "Time of a diagnosis against samples, motors and catalogue: [growth](../speed/growth.png)."
)
COMMAND = "python -m bench.benchmarks.trust --case"


def write_page(table: Path) -> list[Path]:
    """Write the page and its figures next to the table; return the paths, the table's first."""
    evaluation = read_evaluation(table)
    figures = write_trust_figures(evaluation, table.parent)
    page = table.with_name(PAGE)
    write_text_atomically(page, page_text(evaluation, [figure.name for figure in figures]))
    return [table, page, *figures]


def page_text(evaluation: Evaluation, figures: Sequence[str]) -> str:
    """The whole page in Markdown."""
    blocks = [
        "# Evaluation",
        *front(evaluation),
        "## Cases that went wrong",
        wrong_cases(evaluation),
        "## Probabilities and intervals",
        reliability_table(evaluation),
        gains_table(evaluation),
        *(f"![{name}]({name})" for name in figures),
        "## Certain verdicts that change",
        changed_cases(evaluation),
        "## Cost of each question, and what was not run",
        "Cases run of those planned, mean time of one processor; the interval of the share if cases were not run.",
        cost_table(evaluation),
        "## The frozen set",
        "These cases are the same for every version.",
        overview(evaluation, frozen=True),
        ELSEWHERE,
    ]
    return "\n\n".join(block for block in blocks if block) + "\n"


def front(evaluation: Evaluation) -> list[str]:
    """The beginning of the page: the table, its key, facts, and the most frequent mistakes."""
    seconds = sum(map(cost_of, evaluation.rows))
    facts = (
        f"Commit `{evaluation.commits}`, changelog {evaluation.version}: "
        f"{plural(len(evaluation.rows), 'simulated machine')}, numbers from {evaluation.first} on, "
        f"{duration_text(seconds)} of one processor, by `make trust`."
    )
    wrong = sentences(evaluation.of(evaluation.robots, tuple(QUESTIONS)))
    said = "\n".join(f"- {sentence}" for sentence in wrong)
    return [overview(evaluation), KEY, facts, f"What goes wrong most often:\n\n{said}" if said else ""]


def wrong_cases(evaluation: Evaluation) -> str:
    """Every case with a wrong answer or a failure, with the argument that runs it again."""
    every = evaluation.of(evaluation.robots, tuple(QUESTIONS))
    rows = [row for row in every if row["status"] != OK or is_wrong(row)]
    if not rows:
        return "None."
    lines = []
    for row in rows:
        error = f"{row['error_over_floor.after']:.3g}" if row["status"] == OK else ""
        lines.append((f"`{case_name(row)}`", hidden_text(row), answer_text(row), error))
    heads = ("case", "hidden", "answer", "error over the noise floor")
    return f"`{COMMAND} CASE` runs a case again.\n\n{rows_in_markdown(heads, lines)}"


def case_name(row: Row) -> str:
    """The argument that runs a case again, ROBOT/QUESTION/NUMBER."""
    return f"{row['robot']}/{row['question']}/{row['number']}"


def reliability_table(evaluation: Evaluation) -> str:
    """Stated probabilities, and the shares of these effects that are present."""
    classes = reliability(evaluation.of(evaluation.robots, MODELLED))
    lines = [
        (
            f"{group.above:g} to {group.below:g}",
            f"{group.stated:.3f}",
            f"{group.there.count} of {group.there.of}",
            interval_text(group.there),
        )
        for group in classes
    ]
    return rows_in_markdown(("stated probability", "mean", "effects that are there", "95 % interval"), lines)


def gains_table(evaluation: Evaluation) -> str:
    """Errors of the gains and coverage of their intervals, by robot."""
    lines = []
    for robot in evaluation.robots:
        rows = [row for row in evaluation.of([robot], MODELLED) if row["status"] == OK]
        if not rows:
            continue
        errors = [
            100.0 * float(np.median([row[f"gain_error.{name}"] for row in rows]))
            for name in ("before", "after", "told")
        ]
        off = float(np.median(np.concatenate(deviations(rows))))
        lines.append(
            (robot, *(f"{value:.3g} %" for value in errors), target_text(coverage(rows)), f"{off:.2f}")
        )
    heads = (
        *("", "largest gain error, median: without effects", "as diagnosed", "with the true effects"),
        *("95 % intervals contain the truth", "error / std, median (expected: 0.67)"),
    )
    return rows_in_markdown(heads, lines)


def changed_cases(evaluation: Evaluation) -> str:
    """Cases in which a certain verdict appears or disappears."""
    rows = evaluation.of(evaluation.robots, tuple(QUESTIONS))
    lines = [
        (f"`{case_name(row)}`", hidden_text(row), row[SURE] or "–", title, row[change] or "–")
        for change, title in (
            (NOISE, "with a quarter of the noise added"),
            (WITHOUT_LOG, "without the last log"),
        )
        for row in rows
        if changed(row, change)
    ]
    heads = ("case", "hidden", "certain", "change", "certain then")
    return rows_in_markdown(heads, lines) if lines else "None."
