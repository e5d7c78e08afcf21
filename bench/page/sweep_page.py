"""The page of a sweep: the metrics against the varied quantities, failed runs, and how to repeat it."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError
from bench.basics.plural import plural
from bench.basics.sentence import and_list
from bench.document.typeset import typeset
from bench.effects.display_names import begun
from bench.page.figures_sweep import grid_figure, plot_figure, runs_part, spread_figure
from bench.page.parts import (
    Cell,
    Commands,
    Items,
    Kind,
    Page,
    PageColumn,
    PageRow,
    PageTable,
    Part,
    Section,
    Tile,
    page_table,
    row,
    sentences_section,
)
from bench.page.section_run import versions_of
from bench.studies.sweep.axes import DrawnAxis
from bench.studies.sweep.charts import metric_axis, point_label, value_text
from bench.studies.sweep.metrics import (
    axis_title,
    axis_words,
    is_relative,
    is_share,
    metric_title,
    what_is_measured,
)
from bench.studies.sweep.plan import Plan
from bench.studies.sweep.results import default_plots, failed_runs, table_in
from bench.studies.sweep.run_sweep import FILE, RECORD
from bench.studies.sweep.summary import Spread, Summary, SummaryLine, explanation, summarise
from bench.studies.sweep.sweep_file import load_sweep
from bench.studies.sweep.table import column_names, read_table

MOST_LINES = 200  # of a table on the page; the file contains all
MOST_REASONS = 20
MOST_TILES = 3
FEW_SEEDS = 5
MOST_VALUES = 12


@dataclass(frozen=True)
class SweepResult:
    """The contents of a sweep's folder. plan: from its file; name: of that file when the sweep ran."""

    folder: Path
    name: str
    plan: Plan
    table: Path
    metrics: tuple[str, ...]
    summary: Summary
    overall: SummaryLine


def read_sweep(folder: Path) -> SweepResult:
    """Read the folder of a completed sweep. Raises BenchError naming what is missing or damaged."""
    plan = Plan(load_sweep(folder / FILE))
    table = table_in(folder)
    known = column_names(table)
    metrics = tuple(metric for metric in plan.sweep.table.show if metric in known)
    try:
        name = str(json.loads((folder / RECORD).read_text(encoding="utf-8"))["sweep"])
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BenchError(f"{folder / RECORD}: cannot be read: {error}") from None
    summary = summarise(table, [axis.name for axis in plan.sweep.grid], metrics)
    overall = summarise(table, [], metrics)
    if not overall.lines:
        raise BenchError(f"{table}: holds no run")
    return SweepResult(folder, name, plan, table, metrics, summary, overall.lines[0])


def sweep_page(result: SweepResult, again: Sequence[str]) -> Page:
    """The page of a sweep. again: the commands that reproduce it."""
    sweep = result.plan.sweep
    runs = runs_part(result.plan, result.table, result.folder, result.metrics)
    return Page(
        title=_title(result),
        facts=(
            f"base scenario {sweep.table.base}",
            plural(result.overall.runs, "run"),
            plural(len(sweep.seeds), "seed"),
        ),
        verdict=_verdict(result),
        tiles=_tiles(result),
        sections=(
            _plots_section(result),
            Section("each", "Run by run", "", (runs,), "Runs"),
            _numbers_section(result),
            _runs_section(result),
            _failures_section(result),
            _plan_section(result),
            _limits_section(result),
            _again_section(result, again),
        ),
    )


def _title(result: SweepResult) -> str:
    """The sweep's name; if that is only "sweep", what it varies."""
    if result.name.lower() != "sweep":
        return f"Sweep {result.name}"
    varied = [axis_words(axis) for axis in result.plan.axis_names]
    return f"Sweep of {and_list(varied)}" if varied else "Sweep"


def _verdict(result: SweepResult) -> tuple[str, ...]:
    """Up to three sentences: how many runs gave a result, the first metric over all runs, and its extremes."""
    all_runs = result.overall
    ended = str(all_runs.runs - all_runs.failed) if all_runs.failed else "all"
    about = result.plan.sweep.table.description.rstrip(".") or result.name
    said = [f"{about}: {plural(all_runs.runs, 'run')}, {ended} came to an answer."]
    metrics = [metric for metric in result.metrics if all_runs.spreads[metric].count]
    if not metrics:
        return (*said, "None of the metrics asked for was recorded.")
    said.append(_over_all(metrics[0], all_runs.spreads[metrics[0]]))
    known = [line for line in result.summary.lines if line.spreads[metrics[0]].count]
    if len(known) > 1:
        ranked = sorted(known, key=lambda line: line.spreads[metrics[0]].middle)
        low, high = (
            f"{value_text(metrics[0], line.spreads[metrics[0]].middle)} at {_place(result, line)}"
            for line in (ranked[0], ranked[-1])
        )
        kind = "mean" if is_share(metrics[0]) else "median"
        said.append(f"The {kind} of a combination goes from {low} to {high}.")
    elif len(metrics) > 1:
        said.append(_over_all(metrics[1], all_runs.spreads[metrics[1]]))
    return tuple(typeset(sentence) for sentence in said)


def _over_all(metric: str, spread: Spread) -> str:
    what = what_is_measured(metric)
    low, high = value_text(metric, spread.low), value_text(metric, spread.high)
    middle = value_text(metric, spread.middle)
    if is_share(metric):
        return f"{begun(what)}: {middle}, 95 % interval {low} to {high}."
    if spread.count == 1:
        return f"{begun(what)}: {middle}."
    return f"{begun(what)}: {middle} in the median; nine runs in ten lie between {low} and {high}."


def _place(result: SweepResult, line: SummaryLine) -> str:
    values = zip(result.summary.axes, line.values, strict=True)
    return and_list([f"{axis_words(axis)} {point_label(value)}" for axis, value in values])


def _tiles(result: SweepResult) -> tuple[Tile, ...]:
    ended = result.overall.runs - result.overall.failed
    failed = "none failed" if not result.overall.failed else f"{result.overall.failed} failed"
    tiles = [Tile("Runs that came to an answer", str(ended), failed)]
    for metric in result.metrics[:MOST_TILES]:
        spread = result.overall.spreads[metric]
        if spread.count:
            kind = "95 % interval" if is_share(metric) else "middle 90 %"
            note = f"{kind}: {value_text(metric, spread.low)} to {value_text(metric, spread.high)}"
            name = f"{begun(metric_title(metric))}, {'mean' if is_share(metric) else 'median'}"
            if spread.count == 1 and not is_share(metric):
                name, note = begun(metric_title(metric)), ""
            tiles.append(Tile(name, value_text(metric, spread.middle), typeset(note)))
    return tuple(tiles)


def _plots_section(result: SweepResult) -> Section:
    known = column_names(result.table)
    plots = result.plan.sweep.table.plots or default_plots(result.plan)
    grid = grid_figure(result.summary, [(plot.x, plot.lines) for plot in plots])
    axes = [axis.name for axis in result.plan.sweep.grid if len(axis.points) > 1]
    parts: list[Part] = [grid] if grid is not None else []
    parts += [
        plot_figure(result.table, plot.x, plot.y, plot.lines, axes)
        for plot in plots
        if {plot.x, plot.y, *([plot.lines] if plot.lines else [])} <= set(known)
    ]
    why = "None of the metrics asked for was recorded." if plots else "Nothing was varied: one run."
    lead = "As the sweep's file asks for it; the first metrics against the first axis where it does not."
    shown = tuple(parts) or (Items("", "", (why,)),)
    return Section("plots", "Metrics against what was varied", lead, shown, "Metrics")


def _numbers_section(result: SweepResult) -> Section:
    summary = result.summary
    failed = any(line.failed for line in summary.lines)
    numbers = ["runs", *(["failed"] if failed else [])]
    numbers += [
        begun(metric_title(metric)) if is_relative(metric) else metric_axis(metric).title
        for metric in summary.metrics
    ]
    columns = [PageColumn(axis_title(axis), "keep") for axis in summary.axes]
    columns += [PageColumn(header, "right") for header in numbers]
    rows = tuple(_line(summary, line, failed=failed) for line in summary.lines[:MOST_LINES])
    aid = explanation(summary)
    if len(summary.lines) > MOST_LINES:
        aid += f" The first {MOST_LINES} of {len(summary.lines)} lines; summary.md has all."
    table = PageTable("Every combination", aid, tuple(columns), rows)
    return Section("numbers", "In numbers", "", (table,))


def _line(summary: Summary, line: SummaryLine, *, failed: bool) -> PageRow:
    cells: list[str | Cell] = [point_label(value) for value in line.values]
    cells.append(str(line.runs))
    if failed:
        cells.append(Cell(str(line.failed), "poor" if line.failed else ""))
    return row(*cells, *(_spread_text(metric, line.spreads[metric]) for metric in summary.metrics))


def _spread_text(metric: str, spread: Spread) -> str:
    if not spread.count:
        return "–"
    middle = value_text(metric, spread.middle)
    if spread.count == 1 and not is_share(metric):
        return middle
    return f"{middle} [{value_text(metric, spread.low)}, {value_text(metric, spread.high)}]"


def _runs_section(result: SweepResult) -> Section:
    spreads = result.overall.spreads
    numbers = [metric for metric in result.metrics if not is_share(metric) and spreads[metric].count > 1]
    lead = "How the metrics spread over all runs, whatever was varied."
    if not numbers:
        return sentences_section("spread", "All runs together", ["One run only."], short="All runs")
    part = spread_figure(read_table(result.table, numbers), numbers)
    return Section("spread", "All runs together", lead, (part,), "All runs")


def _failures_section(result: SweepResult) -> Section:
    if not result.overall.failed:
        return sentences_section("failures", "Runs that failed", ["None."], short="Failures")
    reasons = list(failed_runs(result.table).items())[:MOST_REASONS]
    rows = [(str(len(runs)), str(runs[0]), reason) for reason, runs in reasons]
    aid = "The most frequent first; the column reason of runs.parquet has every one."
    table = page_table("Reasons", aid, {"runs": "right", "first": "right", "reason": "words"}, rows)
    return Section("failures", "Runs that failed", "", (table,), "Failures")


def _plan_section(result: SweepResult) -> Section:
    sweep = result.plan.sweep
    rows = []
    for axis in sweep.axes:
        if isinstance(axis, DrawnAxis):
            drawn = ", ".join(f"{k} {point_label(v)}" for k, v in axis.draw.model_dump(by_alias=True).items())
            rows.append((axis_title(axis.name), "drawn for each seed", drawn))
            continue
        values = [point_label(point.label) for point in axis.points]
        more = f" … {values[-1]}" if len(values) > MOST_VALUES else ""
        rows.append((axis_title(axis.name), str(len(values)), ", ".join(values[:MOST_VALUES]) + more))
    seeds = list(sweep.seeds)
    which = f"{seeds[0]} to {seeds[-1]}" if len(seeds) > 1 else str(seeds[0])
    rows.append(("seed", str(len(seeds)), which))
    aid = "Every combination was run with every seed. A seed gives the noise and whatever else is drawn."
    identify = sweep.table.identify
    settings = [
        ("base scenario", sweep.table.base),
        (
            "trajectories",
            "designed once" if sweep.table.design == "once" else "designed for each payload and limit",
        ),
        ("estimator", identify.method),
        ("effects in the model", ", ".join(identify.effects) or "none: rigid bodies only"),
        ("recorded", ", ".join(sweep.table.record)),
        *((f"changed: {key}", json.dumps(value)) for key, value in sweep.table.scenario.items()),
    ]
    shared: dict[str, Kind] = {"setting": "keep", "value": "words"}
    parts = (
        page_table("What was varied", aid, {"axis": "keep", "values": "keep", "which": "words"}, rows),
        page_table("What all runs share", "Unless an axis says otherwise.", shared, settings),
    )
    return Section("plan", "The plan", "", parts)


def _limits_section(result: SweepResult) -> Section:
    said = ["Every run is a simulation: it shows what the method can do, not what a real machine is like."]
    if len(result.plan.sweep.seeds) < FEW_SEEDS:
        count = plural(len(result.plan.sweep.seeds), "seed")
        said.append(f"{count} for each combination: the spread within one says little.")
    if result.overall.failed:
        said.append("Runs that failed are in no median.")
    return sentences_section("limits", "Known limits", said)


def _again_section(result: SweepResult, again: Sequence[str]) -> Section:
    names = [name for name in column_names(result.table) if name == "commit" or name.startswith("version.")]
    columns = read_table(result.table, names)
    aid = (
        "Started again on the same folder, a sweep goes on where it was; on another, it gives the same table."
    )
    parts: tuple[Part, ...] = (versions_of(columns), Commands("Run it again", aid, tuple(again)))
    return Section("run", "Versions, and how to run it again", "", parts, "Versions")
