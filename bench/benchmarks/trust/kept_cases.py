"""Part of the evaluation for `bench check`: runs cases of the frozen set again that were right."""

import tempfile
from collections.abc import Callable, Sequence
from contextlib import closing
from pathlib import Path
from statistics import fmean

from rich.console import Console

from bench.basics.plural import plural
from bench.benchmarks.trust.cells import TrustCase, TrustCells
from bench.benchmarks.trust.evaluation import Evaluation, read_evaluation
from bench.benchmarks.trust.overview import cost_of
from bench.benchmarks.trust.plan import case_runs
from bench.benchmarks.trust.questions import QUESTIONS
from bench.benchmarks.trust.run import ROBOTS, setups_of
from bench.benchmarks.trust.words import answer_text, hidden_text, is_wrong
from bench.benchmarks.trust.work import trust_work
from bench.studies.sweep.journal import Journal, Row
from bench.studies.sweep.pool import Pool
from bench.studies.sweep.run_plan import Driver, Work


def cheapest_right(evaluation: Evaluation, seconds: float) -> list[Row]:
    """Right cases of the frozen set: the cheapest of each question, from the robot with the cheapest cases on.

    seconds: processor time that they may take together, according to the evaluation.
    """
    chosen: list[Row] = []
    kinds = tuple(QUESTIONS)
    of_robot = {
        robot: evaluation.of([robot], kinds, frozen=True) for robot in evaluation.robots if robot in ROBOTS
    }
    asked = [robot for robot, rows in of_robot.items() if rows]
    for robot in sorted(asked, key=lambda robot: fmean(map(cost_of, of_robot[robot]))):
        for kind in kinds:
            right = [row for row in of_robot[robot] if row["question"] == kind and is_right(row)]
            if right:
                chosen.append(min(right, key=cost_of))
                seconds -= cost_of(chosen[-1])
                if seconds < 0.0:
                    return chosen[:-1]
    return chosen


def run_again(
    rows: Sequence[Row], first: int, pool: Pool, make_work: Callable[[TrustCells], Work] = trust_work
) -> dict[str, Row]:
    """The new rows, by name, of the cases of these rows of the frozen set.

    first: number of the first fresh case of the evaluation.
    """
    cells = TrustCells(setups_of([*dict.fromkeys(row["robot"] for row in rows)]), first)
    cases = [_case(cells, row) for row in rows]
    with tempfile.TemporaryDirectory(prefix="bench-check-") as name:
        folder = Path(name)
        with closing(Journal(folder / "cases.jsonl", cells.size)) as journal:
            runs = case_runs(cells, cases)
            Driver(runs, journal, pool, make_work(cells), folder / "designs").run(lambda _: None)
            now = {row["run"]: row for row in journal.rows()}
    return {case.name: now[case.row] for case in cases}


def _case(cells: TrustCells, row: Row) -> TrustCase:
    cell = next(
        cell
        for cell in cells.all
        if cell.frozen and (cell.robot, cell.question.kind) == (row["robot"], row["question"])
    )
    return TrustCase(cell, cell.numbers.index(row["number"]))


def is_right(row: Row) -> bool:
    """Whether a case counts and its answer is right."""
    return QUESTIONS[row["question"]].counts(row) and not is_wrong(row)


def check_kept_cases(table: Path, pool: Pool, console: Console, seconds: float = 30.0) -> int:
    """Run right cases of an evaluation again, print the results, and return how many are wrong now."""
    evaluation = read_evaluation(table)
    chosen = cheapest_right(evaluation, seconds)
    now = run_again(chosen, evaluation.first, pool)
    wrong = {name: row for name, row in now.items() if not is_right(row)}
    for name, row in wrong.items():
        text = f"{name}: was right; hidden: {hidden_text(row)}; answer: {answer_text(row)}"
        console.print(text, style="red", markup=False, soft_wrap=True)
    robots = ", ".join(dict.fromkeys(row["robot"] for row in chosen))
    text = f"{plural(len(now), 'case')} of the evaluation ({robots}): {len(wrong)} worse"
    console.print(text, markup=False, soft_wrap=True)
    return len(wrong)
