"""The figures of a trial in print and on a page: nothing without cases, no verdict on too few."""

import io
import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest
from rich.console import Console

from bench.studies.sweep.journal import cell_of, names_in
from bench.studies.trial.charts import write_trial_figures
from bench.studies.trial.command import show
from bench.studies.trial.markdown import coverage_table, deviation_text, parts, trial_markdown
from bench.studies.trial.summary import TrialSummary, summarised
from bench.studies.trial.target import Attained, Share, Target, TargetFigure
from tests.trial_rows import trial_row, trial_rows

pytestmark = pytest.mark.pictures


def printed(summary: TrialSummary) -> str:
    console = Console(file=io.StringIO(), width=132)
    show(summary, console)
    return console.file.getvalue()


@pytest.fixture
def nothing() -> TrialSummary:
    """Ten cases without any hidden effect, one of them with an alarm."""
    return summarised("robot", [trial_row("nothing", "", "")] * 9 + [trial_row("nothing", "", "base_tilt")])


def test_what_was_not_tried_is_left_out(nothing: TrialSummary) -> None:
    figures, confusion = parts(nothing)
    assert figures.table.columns[0].texts == ["nothing hidden: any alarm", "– an effect named"]
    row = [column.texts for column in confusion.table.columns]
    assert row == [["nothing"], ["10"], ["nothing named: 90 %"], ["base tilt 1"], [""]]
    for text in (printed(nothing), trial_markdown(nothing, {})):
        assert "nan" not in text
        assert "one hidden effect" not in text
        assert "gain" not in text
        for part in (figures, confusion):
            assert part.title in text
        assert "by size" not in text
        assert "Parameters of" not in text


def test_the_terminal_says_which_cases_do_not_count_in_a_hundred_columns() -> None:
    summary = summarised("robot", trial_rows())
    text = printed(summary)
    assert max(map(len, map(str.rstrip, text.splitlines()))) <= 100
    assert summary.small > 0
    said = f"at least 3 × the noise floor; this is not so in {summary.small} case"
    assert said in " ".join(text.split())
    assert "do not count" not in printed(summarised("robot", [trial_row("nothing", "", "")]))


def test_pictures_are_of_what_there_are_cases_for(tmp_path: Path) -> None:
    nothing = [trial_row("nothing", "", "")] * 2
    assert write_trial_figures(summarised("robot", nothing), nothing, tmp_path) == []
    paths = write_trial_figures(summarised("robot", trial_rows()), trial_rows(), tmp_path)
    assert [path.name for path in paths] == [
        f"robot_{name}.png" for name in ("confusion", "misses", "errors")
    ]


KEPT = sorted(path for path in Path("results/trial").glob("*.parquet") if not path.stem.endswith("_unknown"))


@pytest.mark.parametrize("table", KEPT, ids=lambda path: path.stem)
def test_kept_pages_are_those_of_their_tables(table: Path) -> None:
    page = table.with_suffix(".md").read_text(encoding="utf-8")
    notes, _, tables = page.partition("\n## ")
    summary = summarised(table.stem, pq.read_table(table).to_pylist())
    told = trial_markdown(summary, {}, re.findall(r"^!\[(.*)\]", page, re.MULTILINE))
    assert tables == told.partition("\n## ")[2]
    assert notes.startswith(f"# Blind trial of the diagnosis: {table.stem}\n\n- datasets: ")


@pytest.mark.parametrize(
    "table",
    sorted(Path("results/trial").rglob("*.parquet")),
    ids=lambda path: f"{path.parent.name}-{path.stem}",
)
def test_kept_tables_have_every_dataset_once(table: Path) -> None:
    rows = pq.read_table(table).to_pylist()
    numbers = [(row["kind"], row.get("drawn_from") or "", row["run"]) for row in rows]
    assert len(set(numbers)) == len(numbers)


def test_every_table_has_a_title_and_rows_with_cases() -> None:
    summary = summarised("robot", trial_rows())
    text, page = printed(summary), trial_markdown(summary, {})
    for part in parts(summary):
        assert part.table.columns[0].cells
        assert part.title in text
        assert f"## {part.title}" in page
    sizes = next(part for part in parts(summary) if "size" in part.title)
    assert sizes.table.columns[0].texts == ["0 to 1.5", "3 to 6"]
    assert "three" not in text
    assert "lost" in text


def test_what_is_another_value_altogether_has_no_number_of_standard_errors() -> None:
    assert deviation_text(0.674) == "0.67"
    headers = [column.header for column in coverage_table(summarised("robot", trial_rows())).columns]
    assert headers[-1] == "median error / std (expected: 0.67)"  # "right" is the name of many a motor
    assert deviation_text(10904.78) == "over 100"


def test_gain_errors_are_in_percent_of_the_true_gain_and_ratios_are_not() -> None:
    errors = {"gain_error.before": 0.0725, "gain_error.after": 0.0121, "gain_error.told": 0.002334}
    rows = [trial_row("one", "viscous_friction", "viscous_friction", **errors)] * 2
    figures = parts(summarised("robot", rows))[0].table
    reached = dict(zip(figures.columns[0].texts, figures.columns[1].texts, strict=True))
    assert reached["– largest gain error, root mean square: before"] == "7.25 %"
    assert (reached["– after"], reached["– with the true effects"]) == ("1.21 %", "0.233 %")
    assert reached["– root mean squares"] == "5.184"  # of the errors, over those with the true effects
    rows[0] |= {"gain_error.before": 2e6}  # a gain that the data do not determine
    figures = parts(summarised("robot", rows))[0].table
    assert ">1000 %" in figures.columns[1].texts


def test_a_row_of_names_and_numbers_keeps_to_one_line(nothing: TrialSummary) -> None:
    (line,) = [line for line in printed(nothing).splitlines() if "any alarm" in line]
    assert line.split("  ")[-1].strip() == "1.8 % to 40.4 %"


@pytest.mark.parametrize(
    ("count", "of", "least", "most", "kept"),
    [
        (0, 10, None, 0.02, Attained.TOO_FEW),
        (0, 200, None, 0.02, Attained.YES),
        (1, 10, None, 0.02, Attained.TOO_FEW),
        (3, 10, None, 0.02, Attained.NO),
        (10, 10, 0.95, None, Attained.TOO_FEW),
        (96, 100, 0.95, None, Attained.YES),
        (94, 100, 0.95, None, Attained.TOO_FEW),
        (80, 100, 0.95, None, Attained.NO),
        (9, 10, 0.88, 0.99, Attained.TOO_FEW),
        (190, 200, 0.88, 0.99, Attained.YES),
        (150, 200, 0.88, 0.99, Attained.NO),
        (5, 5, None, None, None),
        (0, 0, 0.95, None, None),
    ],
)
def test_a_verdict_needs_enough_cases(
    count: int, of: int, least: float | None, most: float | None, kept: Attained | None
) -> None:
    share = Share(count, of)
    assert Target(TargetFigure.ALARM, share.value, least, most, share).kept is kept


def test_a_median_is_held_against_its_limit_as_it_is() -> None:
    assert Target(TargetFigure.FLOOR_MEDIAN, 1.2, None, 1.15).kept is Attained.NO
    assert Target(TargetFigure.FLOOR_MEDIAN, 1.1, None, 1.15).kept is Attained.YES
    assert Target(TargetFigure.FLOOR_MEDIAN, float("nan"), None, 1.15).kept is None


@pytest.mark.parametrize("names", [(), ("backlash",), ("backlash", "viscous_friction")])
def test_names_in_a_cell_are_read_as_they_were_written(names: tuple[str, ...]) -> None:
    assert names_in(cell_of(names)) == names
