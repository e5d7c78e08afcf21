"""An identification as tables in a terminal."""

import math
from collections.abc import Sequence

import numpy as np
from rich.console import Console, Group, RenderableType
from rich.table import Table
from rich.text import Text

from bench.estimate.model_file import Comparison
from bench.estimate.result import CurrentSeries, Identification, Quantity, relative_error
from bench.show.columns import Column, aligned_pair, fit_columns, table_of
from bench.show.numbers import (
    GIVEN,
    POOR,
    USES,
    Truth,
    deviations_away,
    effect_key,
    flat_effects,
    gain_change,
    is_poor,
    other_terms,
    percent,
    pretty_unit,
    relative_error_to,
    rounded_terms,
    settings_lines,
    value_and_deviation,
)

WIDTH = 100  # columns of a table that is asked for by itself
NARROWEST_GROUPING = 14  # columns below which a grouping says nothing
POOR_STYLE = "yellow"
ABSORBED = "absorbed"  # by other parameters: no value of its own


def identification_report(
    result: Identification,
    console: Console | None = None,
    *,
    verbose: bool = False,
    truth: Truth | None = None,
) -> None:
    """Print gains, parameters, errors, settings and notes, to fit the console's width.

    verbose: every grouping in full. truth: true values to compare with, see `Truth`; what it does not name
    is left blank.
    """
    console = console or Console()
    width = console.width
    payloads = sorted({one.payload for one in result.recordings if one.payload is not None})
    facts = [
        f"estimator {result.method}",
        f"effects {', '.join(result.effects)}" if result.effects else "rigid bodies only",
        f"{len(result.recordings)} recording{'s' if len(result.recordings) != 1 else ''}",
        f"payload {', '.join(payloads)}" if payloads else "no payload",
    ]
    console.print()
    console.print(Text.assemble((result.robot, "bold"), "  ", (" · ".join(facts), "dim")))
    kept = "" if result.gains_fitted else ", kept at their nominal values"
    _section(console, f"Drive gains{kept}", gains_table(result, truth, width=width))
    _section(console, "Dynamic parameters", parameters_table(result, truth, width=width))
    _poor_line(console, list(result.parameters))
    if result.left_out:
        console.print(Text(f"left out, as the data do not need them: {', '.join(result.left_out)}", "dim"))
    if result.effect_parameters:
        _section(console, "Effects", effects_table(result, truth, width=width))
    _errors_section(console, result.recordings, tuple(result.drive_gains))
    if verbose:
        _section(console, "What the parameters stand for", groupings_table(result))
    console.print()
    console.print(Group(*(Text(line, "dim") for line in settings_lines(result))))
    if result.notes:
        console.print()
        console.print(notes_list(result.notes))
    console.print()


def comparison_report(comparison: Comparison, console: Console | None = None) -> None:
    """Print how well a saved model foretells recordings, by recording and motor."""
    console = console or Console()
    console.print()
    console.print(Text.assemble((comparison.robot, "bold"), "  ", (f"model {comparison.model}", "dim")))
    # Nothing is fitted here, whatever a recording's use in its dataset is.
    joints = tuple(comparison.error.by_actuator or comparison.error.by_actuator_validate)
    _errors_section(console, comparison.recordings, joints)
    if comparison.notes:
        console.print()
        console.print(notes_list(comparison.notes))
    console.print()


def gains_table(result: Identification, truth: Truth | None = None, *, width: int = WIDTH) -> Table:
    """Drive gains with deviation and, where they were fitted, the change against the nominal value."""
    joints, gains = list(result.drive_gains), list(result.drive_gains.values())
    against_nominal = (
        Column("nominal", [f"{gain.nominal:.6g}" for gain in gains], "right"),
        Column("change", [percent(gain_change(gain), signed=True) for gain in gains], "right"),
    )
    return table_of(
        [
            Column("joint", joints),
            *_quantity_columns(gains),
            Column("unit", [pretty_unit(gain.unit) for gain in gains]),
            *(against_nominal if result.gains_fitted else ()),
            *_truth_columns(gains, joints, truth),
        ],
        width,
    )


def parameters_table(result: Identification, truth: Truth | None = None, *, width: int = WIDTH) -> Table:
    """Base and payload parameters; groupings are cut at a whole term to what `width` leaves."""
    parameters = list(result.parameters)
    columns = [
        Column("parameter", [one.name for one in parameters]),
        *_quantity_columns(parameters),
        Column("unit", [pretty_unit(one.unit) for one in parameters]),
        *_truth_columns(parameters, [one.name for one in parameters], truth),
    ]
    fit = fit_columns(columns, width)
    room = fit.room - fit.gap
    terms = [other_terms(one.name, one.grouping) for one in parameters]
    if room >= NARROWEST_GROUPING and any(terms):
        columns.append(Column("together with", [_shortened(one, room) for one in terms], style="dim"))
    return table_of(columns, width, row_styles=_styles(parameters))


def effects_table(result: Identification, truth: Truth | None = None, *, width: int = WIDTH) -> Table:
    """Parameters of the physical effects, by effect and joint."""
    entries = flat_effects(result)
    quantities = [quantity for *_, quantity in entries]
    effects = [effect for effect, *_ in entries]
    first = [i == 0 or effect != effects[i - 1] for i, effect in enumerate(effects)]
    keys = [effect_key(effect, joint, name) for effect, joint, name, _ in entries]
    return table_of(
        [
            Column("effect", [name if new else "" for name, new in zip(effects, first, strict=True)]),
            Column("joint", [joint for _, joint, _, _ in entries]),
            Column("", [name for _, _, name, _ in entries]),
            *_quantity_columns(quantities),
            Column("unit", [pretty_unit(quantity.unit) for quantity in quantities]),
            *_truth_columns(quantities, keys, truth),
        ],
        width,
        row_styles=_styles(quantities),
    )


def errors_table(series: Sequence[CurrentSeries], joints: Sequence[str], *, width: int = WIDTH) -> Table:
    """Length and errors of the modelled current by recording and motor, fitted and not fitted, with totals.

    Motors that do not fit into `width` are left out all together; `motor_errors_table` has them.
    """
    uses = [use for use in USES if any(one.use == use for one in series)]
    groups: list[tuple[str, str, str, list[CurrentSeries]]] = []
    ends = []
    for use in uses:
        chosen = [one for one in series if one.use == use]
        groups += [(one.name, USES[use], one.payload or "–", [one]) for one in chosen]
        if len(chosen) > 1:
            groups.append((f"all {USES[use]}", "", "", chosen))
        ends.append(len(groups) - 1)
    columns = [
        Column("recording", [name for name, *_ in groups]),
        Column("use", [use for _, use, *_ in groups]),
        Column("payload", [payload for _, _, payload, _ in groups]),
        Column("length", [f"{sum(map(_seconds, chosen)):.3g} s" for *_, chosen in groups], "right", rank=2),
        Column("rows", [str(sum(len(one.time) for one in chosen)) for *_, chosen in groups], "right", rank=3),
        *(
            Column(joint, [percent(relative_error(chosen, j)) for *_, chosen in groups], "right", rank=1)
            for j, joint in enumerate(joints)
            if len(joints) > 1
        ),
        Column(
            "all" if len(joints) > 1 else "error",
            [percent(relative_error(chosen)) for *_, chosen in groups],
            "right",
        ),
    ]
    styles = ["bold" if len(chosen) > 1 else "" for *_, chosen in groups]
    return table_of(columns, width, row_styles=styles, section_ends=ends[:-1])


def motor_errors_table(
    series: Sequence[CurrentSeries], joints: Sequence[str], *, width: int = WIDTH
) -> Table:
    """Errors of the modelled current by motor, fitted and not fitted."""
    uses = [use for use in USES if any(one.use == use for one in series)]
    by_use = [[one for one in series if one.use == use] for use in uses]
    columns = [
        Column(USES[use], [percent(relative_error(chosen, j)) for j in range(len(joints))], "right")
        for use, chosen in zip(uses, by_use, strict=True)
    ]
    return table_of([Column("joint", joints), *columns], width)


def groupings_table(result: Identification) -> Table:
    """What every base and payload parameter stands for, in full."""
    table = Table.grid(padding=(0, 2, 0, 0))
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold", style="dim")
    for one in result.parameters:
        table.add_row(one.name, one.grouping)
    return table


def notes_list(notes: Sequence[str]) -> Table:
    """Notes as bullets that wrap under themselves."""
    grid = Table.grid(padding=(0, 1, 0, 0))
    grid.add_column(style=POOR_STYLE)
    grid.add_column()
    for note in notes:
        grid.add_row("•", note)
    return grid


def _section(console: Console, title: str, part: RenderableType) -> None:
    console.print()
    console.print(Text(title, "bold"))
    console.print(part)


def _errors_section(console: Console, series: Sequence[CurrentSeries], joints: Sequence[str]) -> None:
    table = errors_table(series, joints, width=console.width)
    _section(console, "Error of the modelled current, RMS(error) / RMS(measured)", table)
    if len(joints) > 1 and len(table.columns) <= 4:
        _section(console, "The same by motor", motor_errors_table(series, joints, width=console.width))


def _seconds(series: CurrentSeries) -> float:
    """How long a recording is, s."""
    return float(np.ptp(series.time))


def _poor_line(console: Console, quantities: Sequence[Quantity]) -> None:
    poor = sum(is_poor(one) for one in quantities)
    if poor:
        share = f"deviation above {100 * POOR:.0f} % of the value"
        text = f"! {poor} of {len(quantities)} poorly determined: {share}"
        console.print(Text(text, POOR_STYLE))


def _quantity_columns(quantities: Sequence[Quantity]) -> list[Column]:
    pairs = [value_and_deviation(one.value, one.std) for one in quantities]
    given = all(std == GIVEN for _, std in pairs)
    values = [value for value, _ in pairs]
    both = aligned_pair(values, [std for _, std in pairs], " ± ")
    both = [text.replace(f"± {GIVEN}", f"  {GIVEN}") for text in both]
    both = [ABSORBED if math.isinf(one.std) else text for text, one in zip(both, quantities, strict=True)]
    relative = [
        f"{'! ' if is_poor(one) else ''}{percent(one.relative_std)}"
        if one.std and math.isfinite(one.std)
        else "–"
        for one in quantities
    ]
    if given:
        return [Column("value", values, "right")]
    return [Column("value ± std", both), Column("rel. std", relative, "right", rank=1)]


def _truth_columns(quantities: Sequence[Quantity], keys: Sequence[str], truth: Truth | None) -> list[Column]:
    """The true values and how far the estimates lie from them; none where no truth is known."""
    if truth is None or not any(key in truth for key in keys):
        return []
    rows = []
    for quantity, key in zip(quantities, keys, strict=True):
        value = truth.get(key)
        if value is None:
            rows.append(("", "", ""))
            continue
        text = value_and_deviation(value, quantity.std)[0]
        rows.append((text, relative_error_to(quantity, value), deviations_away(quantity, value)))
    headers = ("truth", "off by", "in std")
    return [
        Column(header, cells, "right") for header, cells in zip(headers, zip(*rows, strict=True), strict=True)
    ]


def _styles(quantities: Sequence[Quantity]) -> list[str]:
    return [POOR_STYLE if is_poor(one) else "" for one in quantities]


def _shortened(terms: Sequence[str], room: int) -> str:
    """As many whole terms as fit into `room`, and how many are left out."""
    terms = rounded_terms(list(terms))
    for count in range(len(terms), 0, -1):
        rest = len(terms) - count
        for ending in (f" … {rest} more", " …") if rest else ("",):
            text = " ".join(terms[:count]) + ending
            if len(text) <= room:
                return text
    return f"{len(terms)} more term{'s' if len(terms) > 1 else ''}" if terms else ""
