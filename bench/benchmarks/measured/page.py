"""The records as a page for a browser."""

from collections.abc import Mapping, Sequence
from typing import Literal

import numpy as np

from bench.basics.plural import plural
from bench.benchmarks.measured.known import WITHIN, MachineTable
from bench.benchmarks.measured.run import MachineRun, Record
from bench.benchmarks.measured.tables import (
    EXPLANATION,
    RUN_HEADS,
    VALUE_HEADS,
    MeasuredCell,
    quantity_name,
    run_rows,
    sources,
    value_rows,
)
from bench.document.charts.chart import Axis, Chart, Panel, Role, Rule, Spans
from bench.document.typeset import share, typeset
from bench.page.chart_spec import chart_figure
from bench.page.parts import (
    Cell,
    Commands,
    Figure,
    Items,
    Page,
    PageColumn,
    PageRow,
    PageTable,
    Part,
    Section,
    Tile,
)
from bench.page.section_run import versions_of

ROLES: tuple[Role, ...] = ("before", "after", "noise")
LINE = 16  # px, of an interval
RUN_KINDS: Mapping[str, Literal["words"]] = {"command": "words", "missing, as it says": "words"}


def measured_page(records: Sequence[Record], machines: Mapping[str, MachineTable], again: str) -> Page:
    """What comes out on measured logs. again: the command that gives this page."""
    return Page(
        title="On measured logs",
        facts=(
            plural(len(records), "machine"),
            plural(sum(len(record.runs) for record in records), "command"),
        ),
        verdict=_verdict(records),
        tiles=_tiles(records, machines),
        sections=(
            _commands_section(records, machines),
            *(_machine_section(record, machines[record.name]) for record in records),
            _again_section(records, again),
        ),
    )


def _verdict(records: Sequence[Record]) -> tuple[str, ...]:
    """Two sentences: how many values are right, and which are wrong."""
    rows = [(record, run, row) for record in records for run in record.runs for row in run.rows]
    inside = [row.inside for _, _, row in rows if row.inside is not None]
    reached = [row.reached for _, _, row in rows if row.reached is not None]
    first = (
        f"Of {plural(len(inside), 'value')} that can be compared, {sum(inside)} are inside twice their stated "
        f"deviation and what the reference may be off by"
    )
    first += f"; of {plural(len(reached), 'goal')} {sum(reached)} are reached." if reached else "."
    wrong = [
        f"{quantity_name(row)} of {row.place} ({record.name}, {run.command.split(' ')[0]}, "
        f"{share(row.off, signed=True)})"
        for record, run, row in rows
        if row.inside is False
    ]
    failed = [f"bench {run.command}" for record in records for run in record.runs if run.failed]
    second = f"Outside: {'; '.join(wrong)}." if wrong else "None is outside."
    third = (f"No answer: {'; '.join(failed)}.",) if failed else ()
    return tuple(typeset(entry) for entry in (first, second, *third))


def _tiles(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> tuple[Tile, ...]:
    tiles = []
    for record in records:
        best = [run for run in record.runs if run.error_identify is not None]
        if best:
            last = best[-1]
            known = last.error_validate if last.error_validate is not None else last.error_identify
            kind = "not fitted" if last.error_validate is not None else "fitted"
            machine = machines[record.name].machine.split(":")[0]
            tiles.append(Tile(machine, share(known), f"error, {kind}, after {last.command.split(' ')[0]}"))
    return tuple(tiles)


def _commands_section(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> Section:
    columns = tuple(PageColumn(head, RUN_KINDS.get(head, "right")) for head in RUN_HEADS)
    rows = tuple(_row(cells) for record in records for cells in run_rows(record, machines[record.name]))
    table = PageTable("Commands", "", columns, rows)
    return Section("commands", "What the commands gave", EXPLANATION, (table,), "Commands")


def _machine_section(record: Record, machine: MachineTable) -> Section:
    parts: list[Part] = [*_figure(record)]
    for run in record.runs:
        title = typeset(f"bench {run.command}")
        if run.failed:
            parts.append(Items(title, "", (run.failed,)))
            continue
        columns = tuple(
            PageColumn(head, "right" if head in ("value ± std", "known", "off by", "goal") else "keep")
            for head in VALUE_HEADS
        )
        parts.append(PageTable(title, "", columns, tuple(map(_row, value_rows(run)))))
        if run.said:
            parts.append(Items("What it says", "", tuple(map(typeset, run.said)), folded=not run.diagnosis))
    parts.append(Items("What is known, and from where", "", tuple(map(typeset, sources(machine)))))
    return Section(record.name, machine.machine, typeset(f"{machine.log}."), tuple(parts), record.name)


def _figure(record: Record) -> list[Figure]:
    """How far every estimate is from what is known, an interval for each command."""
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
