"""The page of a blind trial: targets, confusion of effects, misses by size, confidence intervals, remaining errors."""

import json
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.plural import plural
from bench.basics.sentence import and_list, capital
from bench.basics.shell_word import quoted
from bench.document.typeset import typeset
from bench.page.chart_spec import chart_figure
from bench.page.parts import (
    Cell,
    Commands,
    Kind,
    Page,
    Part,
    Section,
    Tile,
    on_page,
    page_table,
    row,
    sentences_section,
)
from bench.page.section_run import CommandRun, versions_of
from bench.studies.sweep.journal import Row
from bench.studies.sweep.table import column_names, read_table
from bench.studies.trial.cases import DATASETS_A_SEED, KINDS
from bench.studies.trial.charts import confusion_chart, coverage_chart, errors_chart, misses_chart
from bench.studies.trial.markdown import (
    COUNTED,
    absorbed_table,
    confusion_table,
    coverage_table,
    failures_table,
    misses_table,
    percent,
    target_cells,
)
from bench.studies.trial.summary import TrialSummary, summarised
from bench.studies.trial.target import Attained, Share, Target, TargetFigure

NEEDED = (
    "status",
    "reason",
    "kind",
    "hidden",
    "missing",
    "absorbed",
    "least_own_error_over_floor",
    "intervals",
)
SUFFIX = ".parquet"
NOT_KEPT = {Attained.NO: "not kept", Attained.TOO_FEW: Attained.TOO_FEW.value}
CELL, LABELS = 25, 190  # px, of the confusion matrix
FEW = 20  # cases, below which a share is hardly meaningful


@dataclass(frozen=True)
class TrialResult:
    """The table of a trial, with its rows and summary."""

    table: Path
    robot: str
    rows: tuple[Row, ...]
    summary: TrialSummary


def trial_table(source: Path) -> Path | None:
    """The path of a trial's table, from its folder or itself; None if there is none.

    Raises BenchError for a folder with the trials of several robots.
    """
    paths = sorted(source.glob(f"*{SUFFIX}")) if source.is_dir() else [source]
    files = [path for path in paths if path.suffix == SUFFIX and path.is_file()]
    tables = [path for path in files if set(NEEDED) <= set(column_names(path))]
    if len(tables) > 1:
        commands = ", ".join(f"bench report {quoted(path)}" for path in tables)
        raise BenchError(
            f"{source}: holds trials of {len(tables)} robots, each with a page of its own: {commands}"
        )
    return tables[0] if tables else None


def read_trial(table: Path) -> TrialResult:
    """Read the table of a trial. Raises BenchError if it has no case."""
    columns = read_table(table)
    count = len(columns["status"])
    if not count:
        raise BenchError(f"{table}: holds no case")
    rows = tuple({name: values[i] for name, values in columns.items()} for i in range(count))
    return TrialResult(table, table.stem, rows, summarised(table.stem, rows))


def trial_page(result: TrialResult, again: Sequence[str]) -> Page:
    """The page of a trial: how far a diagnosis of this robot can be trusted. again: the commands that reproduce it."""
    summary = result.summary
    return Page(
        title=f"How far a diagnosis of {result.robot} can be trusted",
        facts=(f"robot {result.robot}", plural(summary.rows, "blind dataset"), "simulated"),
        verdict=_verdict(summary),
        tiles=_tiles(summary),
        sections=(
            _targets_section(summary),
            _confusion_section(summary),
            _misses_section(summary),
            _coverage_section(summary),
            _errors_section(result),
            _failures_section(summary),
            _limits_section(result),
            _again_section(result, again),
        ),
    )


def again_line(result: TrialResult, times: int = 1) -> str:
    """The command that repeats the trial, as far as its folder records it, with `times` as many seeds."""
    counts = Counter(row["kind"] for row in result.rows)
    kinds = [kind for kind in KINDS if counts[kind]]
    each = Counter((row["kind"], row["hidden"]) for row in result.rows if row["kind"] in ("one", "outside"))
    seeds = max(
        [*each.values(), *(-(-counts[k] // DATASETS_A_SEED) for k in kinds if k not in ("one", "outside"))]
    )
    kept = _saved_settings(result, kinds)
    given = kept.get("given", {})
    options = {
        "scenario": given.get("scenario"),
        "duration": f"{given['duration']:g}" if "duration" in given else None,
        "kinds": ",".join(kinds) if len(kinds) < len(KINDS) else None,
        "effects": ",".join(kept.get("effects", [])) or None,
        "seeds": times * seeds,
    }
    robot = given.get("robot", result.robot)
    return CommandRun("trial", robot, options=options, output=str(result.table.parent)).line()


def _saved_settings(result: TrialResult, kinds: Sequence[str]) -> dict[str, Any]:
    """What the trial's folder records of its command: the effects to draw from (empty: all), and `given` options."""
    for kind in kinds:
        path = result.table.with_suffix("") / f"{kind}.json"
        if path.is_file():
            try:
                kept = json.loads(path.read_text(encoding="utf-8"))
                return {
                    "effects": [str(effect) for effect in kept["effects"]],
                    "given": dict(kept.get("given", {})),
                }
            except (ValueError, KeyError, TypeError) as error:
                raise BenchError(f"{path}: damaged: {error}") from None
    return {}


def _verdict(summary: TrialSummary) -> tuple[str, ...]:
    """Three sentences: correct answers, false alarms, and which limits are kept."""
    shares = {target.figure: target.share for target in summary.targets}
    phrases = {
        TargetFigure.ONE_FIRST: "a single hidden effect is named first in",
        TargetFigure.TWO_EXACT: "two are found exactly in",
        TargetFigure.THREE_EXACT: "three in",
    }
    parts = [
        f"{words} {_of(share)}" for figure, words in phrases.items() if (share := shares[figure]) and share.of
    ]
    first = f"{and_list(parts)} of the cases." if parts else "No effect that counts was hidden."
    alarms, outside = shares[TargetFigure.ALARM], shares[TargetFigure.OUTSIDE_HONEST]
    said = []
    if alarms is not None and alarms.of:
        said.append(f"with nothing hidden, {alarms.count} of {plural(alarms.of, 'dataset')} raised an alarm")
    if outside is not None and outside.of:
        said.append(
            "an effect that no model knows became a law or was left unexplained, without a wrong name, in "
            f"{_of(outside)}"
        )
    second = f"{'; '.join(said)}." if said else "False alarms were not tried."
    reached = [target for target in summary.targets if target.reached is not None]
    limited = [target for target in reached if (target.least, target.most) != (None, None)]
    kept = sum(target.kept is Attained.YES for target in limited)
    third = f"Of {plural(len(limited), 'figure')} with a limit, {kept} surely keep it"
    for answer, words in NOT_KEPT.items():
        names = [target.figure.words for target in limited if target.kept is answer]
        third += f"; {words}: {and_list(names)}" if names else ""
    if not limited:
        third = "No case counts, so nothing is said: longer recordings or more seeds help"
    return tuple(typeset(capital(name)) for name in (first, second, f"{third}."))


def _of(share: Share) -> str:
    return f"{percent(share)} ({share.count} of {share.of})"


def _tiles(summary: TrialSummary) -> tuple[Tile, ...]:
    wanted = {
        TargetFigure.ONE_FIRST: "One effect: named first",
        TargetFigure.TWO_EXACT: "Two: the set exactly",
        TargetFigure.THREE_EXACT: "Three: the set exactly",
        TargetFigure.ALARM: "Nothing hidden: alarms",
    }
    tiles = []
    for target in summary.targets:
        if target.figure in wanted and target.share is not None and target.share.of:
            bound = target_cells(target)[2]
            note = f"{target.share.count} of {target.share.of}" + (f", must be {bound}" if bound else "")
            tiles.append(Tile(wanted[target.figure], typeset(percent(target.share)), typeset(note)))
    return tuple(tiles)


def _targets_section(summary: TrialSummary) -> Section:
    heads: dict[str, Kind] = {"figure": "words", "reached": "right", "must be": "keep"}
    heads |= {"": "", "cases": "right", "95 % interval": "keep"}
    rows = []
    for target in summary.targets:
        if target.reached is None:
            continue  # not asked for
        name, reached, bound, _, cases, interval = target_cells(target)
        kept = Cell("") if not bound else _kept(target)
        first = typeset(name.replace("`", ""))
        texts = (typeset(cell) for cell in (reached, bound))
        rows.append(row(first, *texts, kept, cases, typeset(interval), kind="" if bound else "weak"))
    parts = (page_table("Figures and what they must reach", COUNTED, heads, rows),)
    lead = "A wide interval means too few cases: more seeds add to what is there."
    return Section("reached", "What was reached", lead, parts)


def _kept(target: Target) -> Cell:
    if target.kept is Attained.YES:
        return Cell("kept", "badge missing")
    return Cell(NOT_KEPT[target.kept] if target.kept else "", "badge indistinguishable")


def _confusion_section(summary: TrialSummary) -> Section:
    if not summary.confusion:
        return sentences_section("confusion", "What was named for what", ["No such case."])
    aid = "openly undecided: the hidden effect was listed as an alternative of the one that was named."
    chart = confusion_chart(summary)
    columns = chart.x.categories
    height = 70 + 7 * max(map(len, columns)) + CELL * len(chart.y.categories)
    parts: list[Part] = [
        chart_figure(chart, height, least=LABELS + CELL * len(columns), turned=True),
        on_page(confusion_table(summary), "The same in words", aid),
    ]
    if summary.absorbed:
        said = "No data of this robot can show these: the model's own parameters take them up, and diagnose says so."
        parts.append(on_page(absorbed_table(summary), "Absorbed effects", said))
    lead = "Cases with one effect hidden, with one that no model knows, and with nothing hidden."
    return Section("confusion", "What was named for what", lead, tuple(parts), "Named for what")


def _misses_section(summary: TrialSummary) -> Section:
    if not any(miss.first.of for miss in summary.misses):
        why = ["No single effect was hidden."]
        return sentences_section("misses", "Misses by size of the effect", why, short="Misses")
    aid = "own error: that of a model which lacks this effect alone, on recordings that were not fitted."
    parts = (
        chart_figure(misses_chart(summary), 270),
        on_page(misses_table(summary), "The same in numbers", aid),
    )
    lead = "A small effect may be lost in the noise; a large one must be found."
    return Section("misses", "Misses by size of the effect", lead, parts, "Misses")


def _coverage_section(summary: TrialSummary) -> Section:
    if not summary.coverage:
        why = ["No set that counts was found exactly: no interval to judge."]
        return sentences_section("coverage", "Intervals of the effects' parameters", why, short="Intervals")
    aid = "Error: of an estimate, in its standard errors. Where these are right, the median is 0.67."
    parts = (
        chart_figure(coverage_chart(summary), 76 + 22 * len(summary.coverage)),
        on_page(coverage_table(summary), "The same in numbers", aid),
    )
    lead = "Do the 95 % intervals hold the truth 95 % of the time? Of cases whose set was found exactly."
    return Section("coverage", "Intervals of the effects' parameters", typeset(lead), parts, "Intervals")


def _errors_section(result: TrialResult) -> Section:
    chart = errors_chart(result.rows)
    if chart is None:
        why = ["No effect of the catalogue was hidden."]
        return sentences_section("errors", "What is left of the error", why, short="Error left")
    lead = "Error of the current on recordings that were not fitted, before and after the found effects."
    figure = chart_figure(chart, 320, name="Error before and after")
    return Section("errors", "What is left of the error", lead, (figure,), "Error left")


def _failures_section(summary: TrialSummary) -> Section:
    if not summary.failed:
        return sentences_section("failures", "Cases that came to nothing", ["None."], short="Failures")
    part = on_page(failures_table(summary), "Reasons", "The most frequent first. They count nowhere else.")
    return Section("failures", "Cases that came to nothing", "", (part,), "Failures")


def _limits_section(result: TrialResult) -> Section:
    said = [
        "Every dataset is simulated, with laws of its own for the hidden effects: a real machine may have others.",
        COUNTED,
    ]
    few = [
        target.figure.words
        for target in result.summary.targets
        if target.share and 0 < target.share.of < FEW and target.figure.main
    ]
    if few:
        said.append(f"Fewer than {FEW} cases, so the shares say little: {'; '.join(few)}.")
    untried = [kind for kind in KINDS if not any(row["kind"] == kind for row in result.rows)]
    if untried:
        said.append(f"Not tried: {', '.join(untried)}.")
    return sentences_section("limits", "Known limits", map(typeset, said))


def _again_section(result: TrialResult, again: Sequence[str]) -> Section:
    columns: dict[str, list[Any]] = {
        name: [row[name] for row in result.rows]
        for name in result.rows[0]
        if name == "commit" or name.startswith("version.")
    }
    counts = Counter(row["kind"] for row in result.rows)
    heads: dict[str, Kind] = {"kind": "keep", "datasets": "right", "hidden": "words"}
    hidden = {
        "nothing": "nothing",
        "one": "one effect of the catalogue",
        "two": "two effects",
        "three": "three effects",
        "outside": "an effect that is not in the catalogue",
    }
    rows = [(kind, str(counts[kind]), hidden[kind]) for kind in KINDS if counts[kind]]
    aid = "Drawn from seeds; each was diagnosed without access to the truth."
    parts: tuple[Part, ...] = (
        page_table("Datasets", aid, heads, rows),
        versions_of(columns),
        Commands("Run it again", "More seeds add to what is there.", tuple(again)),
    )
    return Section("run", "Datasets, versions, and how to run it again", "", parts, "Versions")
