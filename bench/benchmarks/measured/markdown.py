"""The records as a page of text."""

from collections.abc import Mapping, Sequence

from bench.benchmarks.measured.known import MachineTable
from bench.benchmarks.measured.run import Record
from bench.benchmarks.measured.tables import (
    EXPLANATION,
    RUN_HEADS,
    VALUE_HEADS,
    MeasuredCell,
    run_rows,
    sources,
    value_rows,
)
from bench.document.markdown.tables import rows_in_markdown


def measured_markdown(records: Sequence[Record], machines: Mapping[str, MachineTable]) -> str:
    """All machines: first what the commands gave, then the estimates of each with the known values."""
    rows = [
        (kept.name, _unbroken(command.text), *_weighted(cells))
        for kept in records
        for command, *cells in run_rows(kept, machines[kept.name])
    ]
    blocks = [
        "# On measured logs",
        EXPLANATION,
        rows_in_markdown(("machine", *RUN_HEADS), rows),
    ]
    for record in records:
        machine = machines[record.name]
        blocks += [
            f"## {machine.machine}",
            f"{machine.log}. Program: commit {record.program.get('commit', '')}.",
        ]
        blocks.append("\n".join(f"- {source}" for source in sources(machine)))
        for run in record.runs:
            blocks.append(f"### bench {run.command}")
            if run.failed:
                blocks.append(f"Failed: {run.failed}")
                continue
            blocks.append(rows_in_markdown(VALUE_HEADS, map(_weighted, value_rows(run))))
            blocks.append("\n".join(f"- {sentence}" for sentence in run.said))
    return "\n\n".join(block for block in blocks if block) + "\n"


def _unbroken(command: str) -> str:
    """A command as pieces of code, each of which stays on a line: an option is not torn from its name or its value."""
    first, *options = command.split(" --")
    return " ".join(f"`{part}`" for part in (first, *(f"--{option}" for option in options)))


def _weighted(row: Sequence[MeasuredCell]) -> list[str]:
    return [f"**{cell.text}**" if cell.wrong else cell.text for cell in row]
