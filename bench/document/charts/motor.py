"""Charts of one motor's errors: against variables, by part of the motion, and in distribution."""

from collections.abc import Mapping

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.document.charts.chart import (
    Axis,
    Band,
    Bars,
    Binned,
    Chart,
    Histogram,
    Line,
    Panel,
    Rule,
    Series,
    Spans,
    Stems,
)
from bench.document.layout import SCREEN
from bench.residuals.autocorrelation import autocorrelation
from bench.residuals.bounds import ERROR_GRID
from bench.residuals.error_breakdown import Branch, ErrorBreakdown
from bench.residuals.periods import position_spectrum, time_spectrum
from bench.residuals.profile import Variable

VARIABLES: tuple[Variable, ...] = ("velocity", "position", "acceleration", "current", "time")
NOISE_BAND = "± noise of the current"


def motor_charts(errors: ErrorBreakdown) -> Mapping[str, Chart]:
    """Charts by name: the five VARIABLES, reversals, recordings, opposing, shares, spectrum, positions,
    autocorrelation, histogram; all recordings together.
    """
    return {
        **{variable: against_chart(errors, variable) for variable in VARIABLES},
        "reversals": reversals_chart(errors),
        "recordings": recordings_chart(errors),
        "opposing": opposing_chart(errors),
        "shares": shares_chart(errors),
        "spectrum": spectrum_chart(errors),
        "positions": positions_chart(errors),
        "autocorrelation": autocorrelation_chart(errors),
        "histogram": histogram_chart(errors),
    }


def against_chart(errors: ErrorBreakdown, variable: Variable) -> Chart:
    """Errors against a variable in bins with equally many rows, separately for each direction of motion."""
    label, unit = errors.axes[variable]
    series: tuple[Series, ...] = (_noise_band(errors), *map(_binned, errors.against(variable, SCREEN.bins)))
    return Chart(
        f"Against {'modelled current' if variable == 'current' else variable}",
        Axis(label, unit),
        (Panel(Axis("error", errors.current), series),),
        aid="If level with the band, nothing depends on it.",
        legend="shared",
    )


def reversals_chart(errors: ErrorBreakdown) -> Chart:
    """Errors before and after a change of direction, separately by the direction afterwards."""
    branches = errors.around_reversals
    reach = ERROR_GRID.around_reversal / (errors.series[0].rate or 1.0)
    series: tuple[Series, ...] = (
        _noise_band(errors),
        Rule("", "noise", "x", 0.0, dashed=True),
        *map(_binned, branches),
    )
    aid = "A step or spike at zero is friction or play. Colour: the direction afterwards."
    return Chart(
        "Around reversals",
        Axis("time from the nearest reversal", "s", include=(-reach, reach)),
        (Panel(Axis("error", errors.current), series),),
        aid=aid if branches else "The motor never reverses while it moves: nothing to show.",
        key="colour: the direction afterwards" if branches else "it never reverses while it moves",
        legend="shared",
    )


def recordings_chart(errors: ErrorBreakdown) -> Chart:
    """Error of every recording, and noise of its current, both relative to the current."""
    names = tuple(
        trace.recording.removesuffix(".csv").removesuffix(".parquet")
        + (f", {trace.payload}" if trace.payload else "")
        for trace in errors.series
    )
    return _bars(
        ("By recording and payload", "error of the current", "grey: noise of the current"),
        names,
        ("error", [error for error, _ in errors.by_recording]),
        ("noise of the current", [noise for _, noise in errors.by_recording]),
        "A prominent recording or payload differs from the others.",
    )


def opposing_chart(errors: ErrorBreakdown) -> Chart:
    """Mean error that opposes the motion, early and late and by payload, with its 95 % interval."""
    known = errors.opposing
    mean = np.array([opposing.mean for _, opposing in known])
    half = WITHIN_95 * np.array([opposing.std for _, opposing in known])
    at = np.arange(len(known))
    points = Spans("mean with 95 % interval", "error", at, mean, mean - half, mean + half)
    names = tuple(name for name, _ in known)
    return Chart(
        "Error that opposes the motion",
        Axis("mean of error · direction", errors.current, room=True),
        (Panel(Axis("", scale="band", categories=names), (Rule("", "noise", "x", 0.0), points)),),
        aid="Right of zero: more friction than modelled. Thirds that differ: warming up.",
    )


def shares_chart(errors: ErrorBreakdown) -> Chart:
    """Share of the squared error in each part of the motion, and that part's share of the time."""
    return _bars(
        ("Where the squared error lies", "share", "grey: share of the time"),
        tuple(errors.shares),
        ("of the squared error", [error for error, _ in errors.shares.values()]),
        ("of the time", [time for _, time in errors.shares.values()]),
        "A bar far longer than the grey one: the error is concentrated there.",
    )


def spectrum_chart(errors: ErrorBreakdown) -> Chart:
    """Spectral density of the error, and of the current's noise."""
    spectrum = time_spectrum(errors.series)
    density = spectrum.density[1:]
    series: tuple[Series, ...] = (Line("error", "error", spectrum.frequency[1:], density),)
    domain = None
    if spectrum.noise > 0:
        series = (Rule("noise of the current", "noise", "y", spectrum.noise), *series)
        domain = (spectrum.noise / 30.0, 2.0 * float(max(density.max(), spectrum.noise)))
    return Chart(
        "Spectrum over time",
        Axis("frequency", "Hz"),
        (Panel(Axis("density of the error", f"{errors.current}²/Hz", "log", domain), series),),
        aid="Above the grey line: more than noise. A peak is a vibration or a ripple.",
        key="grey: noise of the current",
    )


def positions_chart(errors: ErrorBreakdown) -> Chart:
    """Amplitude of the sinusoid over position that fits the error best, against its wave number."""
    lines = position_spectrum(errors.series)
    curve = Line("error", "error", np.asarray(lines.cycles), np.asarray(lines.amplitude))
    return Chart(
        "Spectrum over position",
        Axis(f"cycles per {errors.unit}"),
        (Panel(Axis("amplitude of the error", errors.current, include=(0.0,)), (curve,)),),
        aid="A peak repeats with position: cogging, gears, geometry.",
    )


def autocorrelation_chart(errors: ErrorBreakdown) -> Chart:
    """Autocorrelation of the error, with the 95 % band of chance."""
    known = autocorrelation(errors.series)
    band = Band("95 % of what chance gives", "noise", -known.band, known.band)
    stems = Stems("error", "error", known.lag, known.value)
    return Chart(
        "Autocorrelation",
        Axis("lag", "s"),
        (Panel(Axis("autocorrelation of the error", include=(-0.2, 1.0)), (band, stems)),),
        aid="Outside the band: errors follow each other. The first few come from the fit's low-pass.",
        key="grey: 95 % of what chance gives",
    )


def histogram_chart(errors: ErrorBreakdown) -> Chart:
    """The distribution of the errors, as shares of the rows, and that of the noise alone."""
    count_all = len(errors.errors)
    reach = max(float(np.abs(errors.errors).max()), SCREEN.histogram * errors.noise)
    edges = np.linspace(-reach, reach, SCREEN.histogram_bins + 1)
    share = np.histogram(errors.errors, edges)[0] / count_all
    series: tuple[Series, ...] = (Histogram("error", "error", edges, share),)
    if errors.noise > 0:
        x = np.linspace(-reach, reach, 10 * SCREEN.histogram_bins)
        density = np.exp(-0.5 * (x / errors.noise) ** 2) / (errors.noise * np.sqrt(2.0 * np.pi))
        alone = density * float(edges[1] - edges[0])
        series = (*series, Line("noise of the current alone", "noise", x, alone))
    domain = (0.7 / count_all, 1.5 * float(share.max()))
    return Chart(
        "Histogram",
        Axis("error", errors.current),
        (Panel(Axis("share of the rows", "%", "log", domain), series),),
        aid="All errors, the largest included. Wider than the grey curve: more than noise.",
    )


def _noise_band(errors: ErrorBreakdown) -> Band:
    return Band(NOISE_BAND, "noise", -errors.noise, errors.noise)


def _binned(branch: Branch) -> Binned:
    bins, way = branch.bins, branch.direction
    means = (bins.edges, bins.center, bins.mean, bins.spread)
    return Binned(way, way, branch.x, branch.error, *means, *_extremes(branch), bins.count)


def _extremes(branch: Branch) -> tuple[np.ndarray, np.ndarray]:
    """Smallest and largest error in every bin, NaN in empty ones; bins as those of `binned`."""
    values, errors, edges = branch.x, branch.error, branch.bins.edges
    size = len(edges) - 1
    inside = (values >= edges[0]) & (values <= edges[-1])
    index = np.clip(np.searchsorted(edges, values[inside], side="right") - 1, 0, size - 1)
    low, high = np.full(size, np.inf), np.full(size, -np.inf)
    np.minimum.at(low, index, errors[inside])
    np.maximum.at(high, index, errors[inside])
    return np.where(np.isfinite(low), low, np.nan), np.where(np.isfinite(high), high, np.nan)


def _bars(
    words: tuple[str, str, str],
    names: tuple[str, ...],
    thick: tuple[str, list[float]],
    thin: tuple[str, list[float]],
    aid: str,
) -> Chart:
    """Two bars for each category, one thin. words: title, axis and key; thick, thin: name and lengths of each."""
    title, axis, key = words
    bars = (Bars(thick[0], "error", np.array(thick[1])), Bars(thin[0], "noise", np.array(thin[1]), thin=True))
    panel = Panel(Axis("", scale="band", categories=names), bars)
    return Chart(title, Axis(axis, "%", include=(0.0,)), (panel,), aid, key)
