"""An identification, comparisons of models with recordings, and where a model fails, in a terminal."""

from collections.abc import Sequence

from rich.console import Console, Group, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from bench.basics.plural import plural
from bench.document.identification import (
    effects_table,
    errors_table,
    gains_table,
    kept_errors_table,
    motor_errors_table,
    parameters_table,
)
from bench.document.numbers import Truth, is_poor, settings_lines
from bench.document.side_by_side import compared_errors_table, compared_gains_table
from bench.document.table import Column, Table
from bench.document.terminal.tables import POOR_STYLE, printed
from bench.identification.decision import RULE
from bench.identification.model_file import Comparison
from bench.identification.result import CurrentSeries, Identification, ModelledRecording
from bench.residuals.residuals import WhereItFails
from bench.residuals.side_by_side import SideBySide
from bench.residuals.words import overlapping, where_sentences

ERRORS = "Error of the modelled current, RMS(error) / RMS(measured)"


def identification_report(
    result: Identification,
    console: Console,
    *,
    verbose: bool = False,
    truth: Truth | None = None,
    without_currents: Sequence[ModelledRecording] = (),
) -> None:
    """Print gains, parameters, errors, settings and notes, to fit the console's width.

    verbose: show every grouping in full. truth: true values to compare with, see `Truth`; cells without one are blank.
    without_currents: the recordings of a saved model, of which only errors are saved.
    """
    width = console.width
    recordings = result.recordings or without_currents
    payloads = sorted({trace.payload for trace in recordings if trace.payload is not None})
    facts = [
        f"estimator {result.method}",
        f"effects {', '.join(result.effects)}" if result.effects else "rigid bodies only",
        plural(len(recordings), "recording"),
        f"payload {', '.join(payloads)}" if payloads else "no payload",
    ]
    heading(console, result.robot, " · ".join(facts))
    remark = "" if result.gains_fitted else ", kept at their nominal values"
    section(console, f"Drive gains{remark}", printed(gains_table(result, truth), width))
    section(console, "Dynamic parameters", printed(parameters_table(result, truth), width))
    if poor := sum(map(is_poor, result.parameters)):
        share = f"standard error above {100 * RULE.loose:.0f} % of the value"
        text = f"! {poor} of {len(result.parameters)} poorly determined: {share}"
        console.print(Text(text, POOR_STYLE))
    if result.left_out:
        console.print(Text(f"omitted because the data do not need them: {', '.join(result.left_out)}", "dim"))
    if result.effect_parameters:
        section(console, "Effects", printed(effects_table(result, truth), width))
    if result.recordings:
        _errors_section(console, result.recordings, result.joints)
    else:
        section(console, ERRORS, printed(kept_errors_table(result.error, without_currents), width))
    if verbose:
        groupings = listing("", "dim")
        for parameter in result.parameters:
            groupings.add_row(Text(parameter.name), Text(parameter.grouping))
        section(console, "Groupings of the parameters", groupings)
    console.print()
    console.print(Group(*(Text(line, "dim") for line in settings_lines(result))))
    if result.notes:
        console.print()
        console.print(sentences_list(result.notes, POOR_STYLE))
    console.print()


def comparison_report(comparison: Comparison, console: Console) -> None:
    """Print how well a saved model predicts recordings, by recording and motor."""
    heading(console, comparison.robot, f"model {comparison.model}")
    # Nothing is fitted, whatever the use of a recording in its dataset.
    joints = tuple(comparison.error.by_actuator or comparison.error.by_actuator_validate)
    _errors_section(console, comparison.recordings, joints)
    if comparison.notes:
        console.print()
        console.print(sentences_list(comparison.notes, POOR_STYLE))
    console.print()


def heading(console: Console, robot: str, facts: str) -> None:
    """Print the subject of a report."""
    console.print()
    console.print(Text.assemble((robot, "bold"), "  ", (facts, "dim")))


def section(console: Console, title: str, part: RenderableType) -> None:
    """Print a part under its title."""
    console.print()
    console.print(Text(title, "bold"))
    console.print(part)


def sentences_list(sentences: Sequence[str], style: str = "") -> Grid:
    """Sentences as a bulleted list. style: of the bullets."""
    grid = Grid.grid(padding=(0, 1, 0, 0))
    grid.add_column(style=style)
    grid.add_column()
    for sentence in sentences:
        grid.add_row("•", Text(sentence))
    return grid


def listing(*styles: str) -> Grid:
    """A grid of columns in these styles; only the last one wraps."""
    grid = Grid.grid(padding=(0, 2, 0, 0))
    for style in styles[:-1]:
        grid.add_column(style=style, no_wrap=True)
    grid.add_column(style=styles[-1], overflow="fold")
    return grid


def _errors_section(console: Console, series: Sequence[CurrentSeries], joints: Sequence[str]) -> None:
    """Print the errors; if not all motors fit into the width, they have a separate table."""
    table = printed(errors_table(series, joints), console.width)
    section(console, ERRORS, table)
    if len(joints) > 1 and len(table.columns) <= 4:
        section(console, "The same by motor", printed(motor_errors_table(series, joints), console.width))


def where_report(where: WhereItFails, console: Console) -> None:
    """Print every motor's error relative to the noise, and sentences on where it is."""
    console.print(Text("Where it fails", "bold"))
    console.print(printed(motors_table(where), console.width))
    console.print()
    console.print(sentences_list(where_sentences(where)))
    if shares := overlapping(where):
        console.print(Text(shares, "dim"))
    console.print()


def motors_table(where: WhereItFails) -> Table:
    """A row for each motor: error, noise, autocorrelation time, error in the first and last third and by payload."""
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
    for k, load in enumerate(loads if len(loads) > 1 else ()):
        columns.append(Column(load, [motor.by_load[k].error for motor in motors], "share", 2))
    return Table(tuple(columns))


def _ratio(error: float, noise: float) -> str:
    ratio = error / noise if noise > 0 else float("inf")
    return f"{ratio:.2f}" if ratio < 10.0 else f"{ratio:.0f}" if ratio < float("inf") else "–"


def side_by_side_report(comparison: SideBySide, changed: Sequence[str], console: Console) -> None:
    """Print errors and gains of every model, and the differences between them."""
    heading(console, comparison.robot, f"{len(comparison.models)} models")
    section(console, ERRORS, printed(compared_errors_table(comparison), console.width))
    section(console, "Drive gains [95 % intervals]", printed(compared_gains_table(comparison), console.width))
    section(console, "What changed", sentences_list(changed))
    console.print()
