"""The table of README.md, made from the evaluation."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.benchmarks.trust.evaluation import Evaluation
from bench.benchmarks.trust.gains import MODELLED
from bench.benchmarks.trust.overview import NO_CASE, interval_text
from bench.benchmarks.trust.questions import QUESTIONS
from bench.document.markdown.tables import rows_in_markdown
from bench.studies.sweep.journal import OK

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
    groups = [*([robot] for robot in robots), list(robots)]
    lines = [["largest gain error, median", *(_gain_error(evaluation, group) for group in groups)]]
    for kind, question in QUESTIONS.items():
        targets = [question.target(evaluation.of(group, [kind])) for group in groups]
        shares = [
            f"{target.share.count} of {target.share.of}" if target.share.of else NO_CASE
            for target in targets
            if target.share is not None
        ]
        lines.append([question.title, *shares[:-1], f"{shares[-1]} ({interval_text(targets[-1])})"])
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
    """A README with its block replaced. Raises BenchError if it has no marks."""
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
