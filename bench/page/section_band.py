"""The curve by which the band of the fit is checked: the same model in other bands."""

import numpy as np

from bench.document.charts.chart import Axis, Chart, Line, Panel, Role, Rule
from bench.document.typeset import short
from bench.identification.finding import Unknown
from bench.identification.result import BandPoint, Identification
from bench.page.chart_spec import chart_figure
from bench.page.parts import Part
from bench.page.unknown_names import name_of

ROLES: tuple[Role, ...] = ("three", "four", "five", "six", "seven")  # errors have the first two colours
HEIGHT = 330  # px


def band_figure(result: Identification) -> list[Part]:
    """Errors, and the values that change most, against the band; nothing where one band alone was looked at."""
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
    """How many of the standard errors of both a value differs from that in this band; NaN where it is not there."""
    value, std = chosen_point.values[unknown]
    moves = []
    for point in points:
        other, spread = point.values.get(unknown, (np.nan, np.nan))
        moves.append((other - value) / np.hypot(std, spread) if point is not chosen_point else 0.0)
    return np.array(moves)
