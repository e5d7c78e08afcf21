"""The table of README.md, made from the evaluation."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.benchmarks.trust.evaluation import Evaluation
from bench.benchmarks.trust.gains import MODELLED
from bench.benchmarks.trust.overview import interval_text
from bench.benchmarks.trust.questions import QUESTIONS
from bench.document.markdown.tables import rows_in_markdown
from bench.studies.sweep.work import OK

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
    """The text between the marks: how the figures are made, and the table questions × robots."""
    robots = evaluation.robots
    lines = [["largest gain error, median", *(_gain_error(evaluation, robot) for robot in robots), ""]]
    for kind, question in QUESTIONS.items():
        targets = [question.target(evaluation.of([robot], [kind])) for robot in robots]
        shares = [f"{t.share.count} of {t.share.of}" for t in targets if t.share is not None]
        lines.append([question.title, *shares, interval_text(question.target(evaluation.of(robots, [kind])))])
    table = rows_in_markdown(
        ["", *(SPOKEN.get(robot, robot) for robot in robots), "95 % interval, all"], lines
    )
    said = (
        "[Simulated machines](results/trust/trust.md) with 18 to 22-bit encoders and 0.2 to 2 % current noise, gains "
        "wrong by up to\na tenth, and hidden effects whose error is at least three times the noise floor "
        f"(`make trust`, commit `{evaluation.commits}`):"
    )
    return f"{said}\n\n{table}"


def with_block(text: str, block: str) -> str:
    """A README with its block replaced. Raises BenchError if it has no marks."""
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise BenchError(f"README.md: no {BEGIN} … {END}")
    return f"{before}{BEGIN}\n{block}\n{END}{after}"


def write_readme(evaluation: Evaluation, path: Path) -> None:
    """Replace the block of a README."""
    write_text_atomically(path, with_block(path.read_text(encoding="utf-8"), readme_block(evaluation)))


def _gain_error(evaluation: Evaluation, robot: str) -> str:
    errors = [row["gain_error.after"] for row in evaluation.of([robot], MODELLED) if row["status"] == OK]
    return f"{100.0 * float(np.median(errors)):.3f} %" if errors else "no case"
