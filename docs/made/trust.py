"""The tables of "how far to trust it", from the files under results: nothing is copied by hand."""

import json
from pathlib import Path

import mkdocs_gen_files
import pyarrow.parquet as pq

from bench.document.markdown.tables import rows_in_markdown
from bench.studies.trial.markdown import MAIN, target_cells
from bench.studies.trial.summary import TrialSummary, summarised
from bench.studies.trial.target import Figure

SHOWN = MAIN | {Figure.ONE_UNDECIDED, Figure.TWO_UNDECIDED, Figure.THREE_UNDECIDED}
RESULTS = Path(__file__).resolve().parents[2] / "results"


def trials() -> list[TrialSummary]:
    """Of every robot with a table of cases."""
    return [
        summarised(path.stem, pq.read_table(path).to_pylist())
        for path in sorted((RESULTS / "trial").glob("*.parquet"))
    ]


def trial_table(summaries: list[TrialSummary]) -> str:
    """The figures of all trials side by side, with what they must be."""
    cells = {
        one.robot: {t.figure: target_cells(t) for t in one.targets if t.reached is not None}
        for one in summaries
    }
    figures = list(dict.fromkeys(figure for of in cells.values() for figure in of if figure in SHOWN))
    rows = []
    for figure in figures:
        (name, _, must, *_) = next(of[figure] for of in cells.values() if figure in of)
        reached = [_with_cases(of[figure]) if figure in of else "" for of in cells.values()]
        rows.append([name, *reached, must])
    heads = ["", *(f"[{robot}](trust/trial_{robot}.md)" for robot in cells), "must be"]
    return rows_in_markdown(heads, rows)


def _with_cases(cells: tuple[object, ...]) -> str:
    _, reached, _, _, cases, _ = cells
    text = f"{reached} of {cases}" if cases else str(reached)
    return text.replace(" ", "&nbsp;")


def speed_table() -> str:
    """Every figure of speed as it was last measured, with its commit."""
    last: dict[str, tuple[float, str]] = {}
    for line in (RESULTS / "speed" / "history.jsonl").read_text(encoding="utf-8").splitlines():
        record = json.loads(line)
        last |= {name: (value, record["commit"]) for name, value in record["figures"].items()}
    rows = [(name, f"{value:.3g}", commit) for name, (value, commit) in last.items()]
    return rows_in_markdown(("", "measured", "commit"), rows)


def page(text: str) -> str:
    """The text with its tables in their places."""
    for place, table in (("trials", trial_table(trials())), ("speed", speed_table())):
        text = text.replace(f"<!-- {place} -->", table)
    return text


with mkdocs_gen_files.open("trust.md", "r") as read:
    whole = page(read.read())
with mkdocs_gen_files.open("trust.md", "w") as written:
    written.write(whole)
