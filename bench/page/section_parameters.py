"""Sections on the parameters: values, standard errors, groupings, conditioning, and excitation."""

from collections.abc import Mapping

import numpy as np

from bench.basics.joint_units import drive_unit, units_of_gain
from bench.basics.plural import plural
from bench.document.charts.chart import Axis, Chart, Line, Panel, Role, Rule, Spans
from bench.document.identification import effects_table, parameters_table
from bench.document.numbers import flat_effects, is_poor, settings_lines
from bench.document.typeset import effect_name, share, short, typeset
from bench.identification.decision import RULE
from bench.identification.finding import Unknown
from bench.identification.result import BandPoint, CurrentSeries, Identification
from bench.page.chart_spec import chart_figure
from bench.page.parts import Items, Kind, PageTable, Part, Section, on_page, page_table

ROLES: tuple[Role, ...] = ("three", "four", "five", "six", "seven")  # errors have the first two colours
HEIGHT = 330  # px
ALIKE = 0.95  # correlation above which two estimates are hardly distinguishable
MOST_PAIRS = 10
REVERSALS = 3  # fewer in all recordings show little of friction


def band_figure(result: Identification) -> list[Part]:
    """Errors, and the values that change most, against the band; empty if only one band was fitted."""
    points = sorted(result.bandwidths, key=lambda point: point.band)
    if len(points) < 2:
        return []
    bands = np.array([point.band for point in points])
    chosen_point = min(points, key=lambda point: abs(point.position_cutoff - result.settings.position_cutoff))
    fitted, held_out = (
        np.array([np.nan if error is None else error for error in errors])
        for errors in zip(*((point.error_identify, point.error_validate) for point in points), strict=True)
    )
    errors = [Line("fitted", "before", bands, fitted, markers=True)]
    if np.isfinite(held_out).any():
        errors.append(Line("not fitted", "after", bands, held_out, markers=True))
    moves = {unknown: _moves(points, chosen_point, unknown) for unknown in chosen_point.values}
    largest = sorted(moves, key=lambda unknown: -float(np.nanmax(np.abs(moves[unknown]))))[: len(ROLES)]
    values = [
        Line(name_of(unknown), role, bands, moves[unknown], markers=True)
        for unknown, role in zip(largest, ROLES, strict=False)
    ]
    chosen = Rule("this answer", "noise", "x", chosen_point.band, dashed=True)
    x = Axis("highest frequency of the fit", "Hz", "log", room=True)
    chart = Chart(
        "The same model in other bands",
        x,
        (
            Panel(Axis("error", "%", include=(0.0,)), (*errors, chosen)),
            Panel(Axis("change", "standard errors", room=True), (*values, chosen)),
        ),
        "A value that changes by more than about two standard errors in half of the band is biased by what filters let "
        "through; the standard errors of this answer include it. The values that change most are shown.",
    )
    return [chart_figure(chart, HEIGHT, name=f"The band, {short(chosen_point.band, 3)} Hz, against others")]


def _moves(points: list[BandPoint], chosen_point: BandPoint, unknown: Unknown) -> np.ndarray:
    """Change of a value from that in the chosen band, in combined standard errors of both; NaN if it is absent."""
    value, std = chosen_point.values[unknown]
    moves = []
    for point in points:
        other, spread = point.values.get(unknown, (np.nan, np.nan))
        moves.append((other - value) / np.hypot(std, spread) if point is not chosen_point else 0.0)
    return np.array(moves)


def name_of(unknown: Unknown) -> str:
    """The name of an unknown: a gain, a parameter, or a value of an effect at its place."""
    if unknown.kind == "gain":
        return f"gain of {unknown.place}"
    if unknown.kind == "parameter":
        return unknown.name
    return f"{unknown.name} of {effect_name(unknown.effect)} at {unknown.place}"


def parameters_section(
    after: Identification, before: Identification | None, *, diagnosed: bool = False
) -> Section:
    """Base, payload and effect parameters with their relative standard errors and groupings.

    diagnosed: whether the parameters of effects are omitted, as a diagnosis shows them with its verdicts.
    """
    aid = (
        "A base parameter is what the motion can show: its own term and those named under “together with”. Marked "
        f"where the standard error is above {RULE.loose:.0%} of the value: then it says little."
    ).replace("%", " %")
    parts: list[Part] = [_deviations_figure(after)] if len(after.parameters) > 1 else []
    table = parameters_table(after, before=before)
    parts.append(on_page(table, "Base and payload parameters", aid))
    if after.effect_parameters and not diagnosed:
        aid = "What their letters mean: the handbook's atlas of effects, a page for each."
        parts.append(on_page(effects_table(after), "Parameters of the effects", aid))
    if after.left_out:
        parts.append(Items("Left out, as the data do not need them", "", after.left_out))
    scale = "" if after.gains_fitted else " They scale with the nominal gains."
    count = plural(len(after.parameters), "parameter")
    lead = f"All that the rigid bodies do in these recordings, in {count}.{scale}"
    return Section("parameters", "Dynamic parameters", lead, tuple(parts), "Parameters")


def _deviations_figure(result: Identification) -> Part:
    parameters = result.parameters
    deviations = np.array([parameter.relative_std if parameter.std else np.nan for parameter in parameters])
    none, at = np.full(len(parameters), np.nan), np.arange(len(parameters))
    points = Spans("relative standard error", "after", at, deviations, none, none)
    rule = Rule(f"{100 * RULE.loose:.0f} %: says little", "before", "x", RULE.loose, dashed=True)
    names = Axis("", scale="band", categories=tuple(parameter.name for parameter in parameters))
    x = Axis("standard error relative to the value, logarithmic", "%", "log")
    aid = "The farther left, the better known."
    chart = Chart("Relative standard errors", x, (Panel(names, (rule, points)),), aid)
    return chart_figure(chart, 66 + 18 * len(parameters), name="How well each is determined")


def conditioning_section(result: Identification) -> Section:
    """Rank and conditioning, the motors' motion, and what it did not excite sufficiently."""
    facts = [typeset(f"{line[:1].upper()}{line[1:]}.") for line in settings_lines(result)[:-1]]
    parts: list[Part] = [
        Items(
            "The equations",
            "A condition number with columns of unit length below about 100 is comfortable, above 1000 it is not.",
            tuple(facts),
        ),
        _motion_table(result),
        *band_figure(result),
    ]
    pairs = _alike(result)
    if pairs:
        heads: Mapping[str, Kind] = {"one": "keep", "other": "keep", "correlation": "right"}
        rows = [(a, b, short(value, 3)) for a, b, value in pairs[:MOST_PAIRS]]
        more = f" {len(pairs) - MOST_PAIRS} more pairs are not shown." if len(pairs) > MOST_PAIRS else ""
        aid = f"Estimates that only their sum or difference is well known of.{more}"
        parts.append(page_table("Pairs that the data hardly tell apart", aid, heads, rows))
    parts.append(Items("Not excited", "", tuple(_not_excited(result))))
    lead = "Whether the movements were rich enough to tell the unknowns apart."
    return Section("conditioning", "Conditioning and excitation", lead, tuple(parts), "Conditioning")


def _fitted(result: Identification) -> list[CurrentSeries]:
    return [trace for trace in result.recordings if trace.use == "identify"] or list(result.recordings)


def _reversals(series: CurrentSeries, j: int) -> int:
    """How often a motor reverses, counted over the rows in which it moves."""
    signs = np.sign(series.velocity[:, j][series.moving[:, j]])
    return int((signs[1:] * signs[:-1] < 0).sum())


def _motion_table(result: Identification) -> PageTable:
    fitted = _fitted(result)
    right = ("position", "speed, RMS and largest", "acceleration, RMS", "current, RMS", "reversals", "moves")
    heads: dict[str, Kind] = {"motor": "", **dict.fromkeys(right, "right")}
    rows = []
    for j, joint in enumerate(result.joints):
        gain = result.drive_gains[joint]
        position, velocity, acceleration, measured, moving = (
            np.concatenate([getattr(trace, name)[:, j] for trace in fitted])
            for name in ("position", "velocity", "acceleration", "measured", "moving")
        )
        unit = units_of_gain(gain.unit).position
        rows.append(
            (
                joint,
                f"{_at(position.min(), position)} to {_at(position.max(), position)} {unit}",
                f"{short(_rms(velocity), 3)} and {short(np.abs(velocity).max(), 3)} {unit}/s",
                f"{short(_rms(acceleration), 3)} {unit}/s²",
                f"{short(_rms(measured), 3)} {drive_unit(gain.unit)}",
                str(sum(_reversals(trace, j) for trace in fitted)),
                share(float(moving.mean())),
            )
        )
    aid = (
        "Over the fitted recordings, after the filters of the fit. moves: share of the rows in which it does."
    )
    return page_table("What the motors did", aid, heads, rows)


def _at(value: float, values: np.ndarray) -> str:
    """A position, to a thousandth of the range of `values`."""
    extent = float(np.ptp(values)) or 1.0
    return typeset(f"{value:z.{max(0, 3 - int(np.ceil(np.log10(extent))))}f}")


def _rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _not_excited(result: Identification) -> list[str]:
    said = []
    fitted = _fitted(result)
    for j, joint in enumerate(result.joints):
        if (count := sum(_reversals(trace, j) for trace in fitted)) < REVERSALS:
            said.append(
                f"{joint} reverses {count} times: friction and offset can hardly be told apart there."
            )
    if poor := [parameter.name for parameter in result.parameters if is_poor(parameter)]:
        share_of = f"standard error above {100 * RULE.loose:.0f} % of the value"
        said.append(f"Poorly determined ({share_of}): {', '.join(poor)}.")
    unknown = [
        f"{name} of {effect.replace('_', ' ')} at {joint}"
        for effect, joint, name, quantity in flat_effects(result)
        if not np.isfinite(quantity.std)
    ]
    if unknown:
        said.append(f"Taken up by other parameters: {', '.join(unknown)}.")
    if result.rank < result.unknowns:
        said.append(f"{result.unknowns - result.rank} of {result.unknowns} unknowns are open.")
    return said or ["Nothing: every motor reverses, and every parameter is determined."]


def _alike(result: Identification) -> list[tuple[str, str, float]]:
    """Pairs of estimates with a correlation above ALIKE in size, the highest first."""
    names = [name_of(unknown) for unknown in result.covariance_rows]
    if not names:  # a model file of an earlier version lacks them
        return []
    std = np.sqrt(np.maximum(np.diag(result.covariance), 0.0))
    safe = np.where(std > 0, std, np.inf)
    correlation = result.covariance / np.outer(safe, safe)
    pairs = [
        (names[i], names[j], float(correlation[i, j]))
        for i, j in zip(*np.nonzero(np.triu(np.abs(correlation) > ALIKE, 1)), strict=True)
    ]
    return sorted(pairs, key=lambda pair: -abs(pair[2]))
