"""Where a model fails, in a terminal."""

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from bench.document.side_by_side import compared_errors_table, compared_gains_table
from bench.document.table import Column, Table
from bench.document.terminal.identification import section, sentences_list
from bench.document.terminal.tables import printed
from bench.residuals.residuals import WhereItFails
from bench.residuals.side_by_side import SideBySide
from bench.residuals.words import overlapping, where_sentences


def where_report(where: WhereItFails, console: Console | None = None) -> None:
    """Print how large every motor's error is relative to the noise, and in sentences where it is."""
    console = console or Console()
    console.print(Text("Where it fails", "bold"))
    console.print(printed(motors_table(where), console.width))
    console.print()
    console.print(sentences_list(where_sentences(where)))
    if shares := overlapping(where):
        console.print(Text(shares, "dim"))
    console.print()


def motors_table(where: WhereItFails) -> Table:
    """A row a motor: error, noise of the current, how long errors are alike, warm-up, and payloads."""
    motors = where.motors
    loads = [opposing.part for opposing in motors[0].by_load] if motors else []
    columns = [
        Column("motor", [motor.joint for motor in motors]),
        Column("error", [motor.error for motor in motors], "share"),
        Column("noise", [motor.noise for motor in motors], "share"),
        Column("× noise", [_ratio(motor.error, motor.noise) for motor in motors], "number", format="s"),
        Column("alike over", [motor.autocorrelation_time for motor in motors], "number", 3, ".2g", "s"),
        Column("first third", [motor.warm_up[0].error for motor in motors], "share", 1),
        Column("last third", [motor.warm_up[1].error for motor in motors], "share", 1),
    ]
    if len(loads) > 1:
        columns += [
            Column(load, [motor.by_load[k].error for motor in motors], "share", 2)
            for k, load in enumerate(loads)
        ]
    return Table(tuple(columns))


def _ratio(error: float, noise: float) -> str:
    ratio = error / noise if noise > 0 else float("inf")
    return f"{ratio:.2f}" if ratio < 10.0 else f"{ratio:.0f}" if ratio < float("inf") else "–"


def side_by_side_report(
    comparison: SideBySide, changed: Sequence[str], console: Console | None = None
) -> None:
    """Print errors and gains of every model, and what changed."""
    console = console or Console()
    console.print()
    console.print(
        Text.assemble((comparison.robot, "bold"), "  ", (f"{len(comparison.models)} models", "dim"))
    )
    section(
        console,
        "Error of the modelled current, RMS(error) / RMS(measured)",
        printed(compared_errors_table(comparison), console.width),
    )
    section(console, "Drive gains [95 % intervals]", printed(compared_gains_table(comparison), console.width))
    section(console, "What changed", sentences_list(changed))
    console.print()
