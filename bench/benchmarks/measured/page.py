"""The records as an HTML page."""

from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from bench.basics.plural import plural
from bench.benchmarks.measured.known import WITHIN, MachineTable
from bench.benchmarks.measured.run import MachineRun, Record
from bench.benchmarks.measured.sentences import absent_values, machine_sentence, short_name
from bench.benchmarks.measured.tables import (
    ERRORS,
    EXPLANATION,
    KNOWN_HEADS,
    KNOWN_TITLE,
    OMITTED_HEADS,
    RUN_HEADS,
    RUNS_TITLE,
    VALUE_HEADS,
    MeasuredCell,
    known_rows,
    omitted_rows,
    quantity_name,
    run_rows,
    sources,
    value_rows,
)
from bench.document.charts.chart import Axis, Chart, Panel, Role, Rule, Spans
from bench.document.typeset import typeset
from bench.page.chart_spec import chart_figure
from bench.page.parts import (
    Cell,
    Commands,
    Figure,
    Items,
    Kind,
    Page,
    PageColumn,
    PageRow,
    PageTable,
    Part,
    Section,
    Text,
    row,
)
from bench.page.section_run import versions_of

ROLES: tuple[Role, ...] = ("before", "after", "noise")
LINE = 16  # px, of an interval
RUN_KINDS: Mapping[str, Kind] = {"command": "keep", "verdict: missing": "words"}
VALUE_KINDS: Mapping[str, Kind] = dict.fromkeys(("value ± std", "known", "off by", "goal"), "right")


def measured_page(records: Sequence[Record], machines: Mapping[str, MachineTable], again: str) -> Page:
    """The page of results on measured logs. again: the command that reproduces it."""
    return Page(
        title="On measured logs",
        facts=(
            plural(len(records), "machine"),
            plural(sum(len(record.runs) for record in records), "command"),
        ),
        verdict=_verdict(records),
        tiles=(),
        sections=(
            _sentences_section(records, machines),
            _known_section(records, machines),
            _commands_section(records, machines),
            *(_machine_section(record, machines[record.name]) for record in records),
            _again_section(records, again),
        ),
    )


def _verdict(records: Sequence[Record]) -> tuple[str, ...]:
    """How many values are right, and which commands gave no result."""
    rows = [row for record in records for run in record.runs for row in run.rows]
    inside = [row.inside for row in rows if row.inside is not None]
    reached = [row.reached for row in rows if row.reached is not None]
    first = (
        f"Of {plural(len(inside), 'value')} that can be compared, {sum(inside)} are inside twice their standard error "
        f"and what the reference may be off by"
    )
    first += f"; of {plural(len(reached), 'goal')} {sum(reached)} are reached." if reached else "."
    failed = [f"bench {run.command}" for record in records for run in record.runs if run.failed]
    return tuple(map(typeset, (first, *([f"No answer: {'; '.join(failed)}."] if failed else []))))


def _sentences_section(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> Section:
    """Each machine in a sentence."""
    rows = tuple(
        row(Cell(short_name(machine)), typeset(machine_sentence(record, machine)))
        for record in records
        for machine in [machines[record.name]]
    )
    table = PageTable("", "", (PageColumn("machine", "keep"), PageColumn("in a sentence", "words")), rows)
    return Section("machines", "Each machine in a sentence", "", (table,), "In a sentence")


def _known_section(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> Section:
    """Known and estimated values of all machines."""
    of_machines = {short_name(machines[record.name]): list(known_rows(record)) for record in records}
    table = _table("", KNOWN_HEADS, _grouped(of_machines), quantity="", at="keep")
    return Section("known", KNOWN_TITLE, EXPLANATION, (table,), "Known and estimated")


def _commands_section(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> Section:
    """Errors of every command, and the effects that each diagnosis names."""
    of_machines = {}
    for record in records:
        machine = machines[record.name]
        rows = zip(record.runs, run_rows(record, machine), strict=True)
        of_machines[short_name(machine)] = [(MeasuredCell(_what(run)), *cells) for run, (_, *cells) in rows]
    table = _table("", RUN_HEADS, _grouped(of_machines), **RUN_KINDS)
    return Section("commands", RUNS_TITLE, ERRORS, (table,), "Errors")


def _table(
    title: str, heads: Sequence[str], rows: Iterable[PageRow], default: Kind = "right", **kinds: Kind
) -> PageTable:
    """A table whose columns are of the `default` kind, others than these aside."""
    return PageTable(
        title, "", tuple(PageColumn(head, kinds.get(head, default)) for head in heads), tuple(rows)
    )


def _grouped(of_machines: Mapping[str, Sequence[Sequence[MeasuredCell]]]) -> tuple[PageRow, ...]:
    """Rows below the names of their machines, omitting machines without rows."""
    rows = []
    for name, lines in of_machines.items():
        if lines:
            rows += [row(name, *[""] * (len(lines[0]) - 1), kind="strong"), *map(_row, lines)]
    return tuple(rows)


def _what(run: MachineRun) -> str:
    """A command in short; its whole line is in the section of its machine."""
    given = "--with" in run.command
    return ("diagnose" if run.diagnosis else "identify") + (", with friction" if given else "")


def _machine_section(record: Record, machine: MachineTable) -> Section:
    note = " ".join((machine.note, *absent_values(record))).strip()
    parts: list[Part] = [*_figure(record), *([Text("", (typeset(note),))] if note else [])]
    for run in record.runs:
        title = typeset(f"bench {run.command}")
        if run.failed:
            parts.append(Items(title, "", (run.failed,)))
            continue
        parts.append(_table(title, VALUE_HEADS, map(_row, value_rows(run)), "keep", **VALUE_KINDS))
        if run.omitted:
            parts.append(_table("With each log omitted", OMITTED_HEADS, map(_row, omitted_rows(run)), ""))
        if run.said:
            parts.append(Items("What it says", "", tuple(map(typeset, run.said)), folded=not run.diagnosis))
    parts.append(Items("What is known, and from where", "", tuple(map(typeset, sources(machine)))))
    return Section(
        record.name, machine.machine, typeset(f"{machine.log}."), tuple(parts), short_name(machine)
    )


def _figure(record: Record) -> list[Figure]:
    """Differences of all estimates from known values, with an interval for each command; empty without known values."""
    runs = [run for run in record.runs if not run.failed]
    names = list(
        dict.fromkeys((quantity_name(r), r.place) for run in runs for r in run.rows if r.known is not None)
    )
    if not names:
        return []
    series = tuple(
        _intervals(run, names, ROLES[i % len(ROLES)], (i + 0.5) / len(runs) - 0.5)
        for i, run in enumerate(runs)
    )
    labels = tuple(typeset(f"{quantity} of {place}") for quantity, place in names)
    rule = Rule("as known", "noise", "x", 0.0, dashed=True)
    chart = Chart(
        "Estimates and known values",
        Axis("difference from the known value", "%"),
        (Panel(Axis("", scale="band", categories=labels), (rule, *series)),),
        f"Whiskers: {WITHIN:g} of the stated deviations. The tables give the uncertainty of the reference.",
    )
    return [chart_figure(chart, 76 + (LINE * len(runs) + 8) * len(labels))]


def _intervals(run: MachineRun, names: Sequence[tuple[str, str]], role: Role, shift: float) -> Spans:
    by_name = {(quantity_name(known), known.place): known for known in run.rows}
    rows = [by_name.get(name) for name in names]
    centre = np.array([np.nan if known is None or known.off is None else known.off for known in rows])
    half = np.array([np.nan if known is None or known.claimed is None else known.claimed for known in rows])
    at = np.arange(len(names))
    return Spans(typeset(run.command), role, at, centre, centre - half, centre + half, 0.7 * shift)


def _row(cells: Sequence[MeasuredCell]) -> PageRow:
    return PageRow(tuple(Cell(typeset(cell.text), "poor" if cell.wrong else "") for cell in cells))


def _again_section(records: Sequence[Record], again: str) -> Section:
    programs = [record.program for record in records]
    columns = (
        {name: [program.get(name, "") for program in programs] for name in programs[0]} if programs else {}
    )
    parts: tuple[Part, ...] = (
        Commands("Run it again", "$PARABENCH_DATA names the folder of the logs.", (again,)),
        versions_of(columns),
    )
    return Section("run", "How to run it again, and versions", "", parts, "Versions")
