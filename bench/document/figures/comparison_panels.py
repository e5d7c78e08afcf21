"""Panels of a page on one motor's errors: against a variable, around reversals, by recording, spectra."""

from collections.abc import Sequence
from dataclasses import dataclass

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from bench.basics.chi_squared import WITHIN_95
from bench.document.colours import ON_WHITE
from bench.residuals.autocorrelation import Autocorrelation
from bench.residuals.concentration import shares
from bench.residuals.motor import MotorSeries, relative_error_of, relative_noise
from bench.residuals.opposing_motion import by_load, over_warm_up
from bench.residuals.periods import PositionSpectrum, Spectrum
from bench.residuals.profile import Profile, Variable, binned, profile, values_of
from bench.residuals.regions import Region

FORWARDS, BACKWARDS, NOISE = "#0072B2", "#D55E00", "#9AA0A6"  # after Okabe and Ito
ZERO = "#8A929C"
PLAIN = FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−"))
MOST_POINTS = 2400  # drawn behind the means, and those far off beside; all rows count in the means
FAR = 3.0  # deviations of its bin from which on a row is always drawn
OUTSIDE = 1.6  # times what most errors are: axes reach no farther
BINS = 24
AROUND = 8  # rows before and after a reversal
LIMIT = 99.5  # percentile that stands for most errors


@dataclass(frozen=True, eq=False)
class Cloud:
    """Errors in one direction of motion: bins of all rows, and the single rows (K,) that are drawn behind them."""

    direction: str
    colour: str
    bins: Profile
    x: np.ndarray
    error: np.ndarray


def clouds(series: Sequence[MotorSeries], variable: Variable) -> list[Cloud]:
    """Errors of one motor against a variable, apart for either direction; all recordings together."""
    x = np.concatenate([values_of(one, variable) for one in series])
    errors = np.concatenate([one.error for one in series])
    forwards = np.concatenate([one.forwards for one in series])
    found = []
    for way, colour, label in ((forwards, FORWARDS, "forwards"), (~forwards, BACKWARDS, "backwards")):
        if way.any():
            bins = profile(x[way], errors[way], BINS)
            drawn = worth_drawing(x[way], errors[way], bins, MOST_POINTS // 2)
            found.append(Cloud(label, colour, bins, x[way][drawn], errors[way][drawn]))
    return found


def clouds_at_reversals(series: Sequence[MotorSeries]) -> list[Cloud]:
    """Errors before and after a change of direction, apart for what the direction is afterwards; x in s."""
    rate = series[0].rate or 1.0
    rows = np.concatenate([one.to_reversal for one in series])
    errors = np.concatenate([one.error for one in series])
    # a row before a reversal to forwards moves backwards
    into = np.concatenate([one.forwards ^ (one.to_reversal < 0) for one in series])
    near = np.abs(rows) <= AROUND
    found = []
    for way, colour, label in (
        (near & into, FORWARDS, "forwards"),
        (near & ~into, BACKWARDS, "backwards"),
    ):
        if way.any():
            bins = binned(rows[way] / rate, errors[way], np.arange(-AROUND, AROUND + 1.0) / rate)
            drawn = worth_drawing(rows[way] / rate, errors[way], bins, MOST_POINTS // 2)
            found.append(Cloud(label, colour, bins, rows[way][drawn] / rate, errors[way][drawn]))
    return found


def worth_drawing(x: np.ndarray, errors: np.ndarray, bins: Profile, most: int) -> np.ndarray:
    """Indices of rows to draw as points: a regular choice of about `most`, and every row far from its bin's mean."""
    size = len(bins.mean)
    index = np.clip(np.searchsorted(bins.edges, x, side="right") - 1, 0, size - 1)
    far = np.abs(errors - np.nan_to_num(bins.mean)[index]) > FAR * np.nan_to_num(bins.spread)[index]
    far |= (errors == errors.max()) | (errors == errors.min())
    every = max(1, -(-len(x) // most))
    return np.flatnonzero(far | (np.arange(len(x)) % every == 0))


def draw_against(axes: Axes, series: Sequence[MotorSeries], variable: Variable, scale: float = 1.0) -> None:
    """Errors against a variable: points, means of bins and their spread, apart for either direction.

    scale: of lines and marks.
    """
    draw_noise_band(axes, series)
    draw_clouds(axes, clouds(series, variable), scale)


def draw_around_reversals(axes: Axes, series: Sequence[MotorSeries], scale: float = 1.0) -> None:
    """Mean error before and after a change of direction, apart for what the direction is afterwards."""
    draw_noise_band(axes, series)
    axes.axvline(0.0, color=ZERO, linewidth=0.8 * scale)
    found = clouds_at_reversals(series)
    draw_clouds(axes, found, scale)
    if not found:
        axes.text(0.5, 0.5, "never reverses while it moves", transform=axes.transAxes, ha="center")
    small_title(axes, "colour: the direction afterwards")


def draw_clouds(axes: Axes, found: Sequence[Cloud], scale: float = 1.0) -> None:
    """Points, means of bins, and their spread as a band."""
    for one in found:
        axes.plot(one.x, one.error, ".", color=one.colour, markersize=1.8 * scale, alpha=0.3, rasterized=True)
        axes.fill_between(
            one.bins.center,
            one.bins.mean - one.bins.spread,
            one.bins.mean + one.bins.spread,
            color=one.colour,
            alpha=0.16,
            linewidth=0.0,
        )
        axes.plot(
            one.bins.center,
            one.bins.mean,
            color=one.colour,
            linewidth=1.6 * scale,
            marker="o",
            markersize=3.2 * scale,
            label=one.direction,
        )
    if found:
        _set_limits(axes, found, scale)


def small_title(axes: Axes, text: str) -> None:
    """What grey and the like stand for, above a panel without a legend."""
    size = 0.85 * float(mpl.rcParams["font.size"])
    axes.set_title(text, fontsize=size, color="#4A525C", loc="right")


def draw_noise_band(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Plus and minus the noise of the current, all recordings together."""
    rows = [len(one.time) for one in series]
    noise = float(np.sqrt(np.average([one.noise**2 for one in series], weights=rows)))
    axes.axhspan(-noise, noise, color=NOISE, alpha=0.45, linewidth=0.0, label="± noise of the current")


def _set_limits(axes: Axes, found: Sequence[Cloud], scale: float) -> None:
    """All errors in view, unless single ones far off would hide the others: those are marked at the border."""
    errors = np.abs(np.concatenate([one.error for one in found]))
    most, largest = float(np.percentile(errors, LIMIT)), float(errors.max())
    reach = 1.08 * min(largest, OUTSIDE * most) or 1.0
    axes.set_ylim(-reach, reach)
    for one in found:
        for sign, marker in ((1.0, 6), (-1.0, 7)):  # carets that point out of the axes
            out = sign * one.error > reach
            if out.any():
                axes.plot(
                    one.x[out],
                    np.full(int(out.sum()), sign * 0.99 * reach),
                    linestyle="none",
                    marker=marker,
                    color=one.colour,
                    markersize=4.0 * scale,
                    clip_on=False,
                )


def draw_time_spectrum(axes: Axes, found: Spectrum, scale: float = 1.0) -> None:
    """Density of the error over frequency, and that of the current's noise."""
    axes.axhline(found.noise, color=NOISE, linewidth=3.0 * scale, alpha=0.6, label="noise of the current")
    axes.semilogy(
        found.frequency[1:], found.density[1:], color=ON_WHITE.error, linewidth=scale, label="error"
    )
    if found.noise > 0:
        axes.set_ylim(bottom=found.noise / 30.0)


def draw_position_spectrum(axes: Axes, found: PositionSpectrum, scale: float = 1.0) -> None:
    """Amplitude of the sinusoid over position that suits the error best, by its wave number."""
    (line,) = axes.plot(found.cycles, found.amplitude, color=ON_WHITE.error, linewidth=0.9 * scale)
    line.set(marker=".", markersize=2.5 * scale)
    axes.set_ylim(bottom=0.0)


def draw_autocorrelation(axes: Axes, found: Autocorrelation, scale: float = 1.0) -> None:
    """Autocorrelation of the error, and what chance gives."""
    chance = axes.axhspan(-found.band, found.band, color=NOISE, alpha=0.45, linewidth=0.0)
    chance.set_label("95 % of what chance gives")
    axes.vlines(found.lag, 0.0, found.value, color=ON_WHITE.error, linewidth=scale)
    axes.plot(found.lag, found.value, "o", color=ON_WHITE.error, markersize=2.5 * scale, label="error")
    axes.set_ylim(min(-0.25, float(np.min(found.value)) - 0.05), 1.05)


def draw_recordings(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Error of every recording beside the noise of its current, both relative to the current."""
    names = [f"{shortened(one.recording)}\n{shortened(one.payload or 'no payload')}" for one in series]
    at = np.arange(len(series))
    axes.barh(at, [100.0 * (relative_error_of([one]) or 0.0) for one in series], 0.55, color=ON_WHITE.error)
    axes.barh(at, [100.0 * relative_noise([one]) for one in series], 0.8, color=NOISE, alpha=0.75)
    axes.set_yticks(at, names)
    axes.invert_yaxis()
    small_title(axes, "grey: noise of the current")


def shortened(name: str, most: int = 16) -> str:
    """A name that fits beside a bar; its middle gives way."""
    half = (most - 1) // 2
    return name if len(name) <= most else f"{name[: most - 1 - half]}…{name[-half:]}"


def draw_opposing(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Mean error that opposes the motion, early and late and by payload, with its 95 % interval."""
    parts = [*over_warm_up(series), *by_load(series)]
    names = ["first third", "last third", *(one.part for one in parts[2:])]
    known = [(name, one) for name, one in zip(names, parts, strict=True) if np.isfinite(one.std)]
    at = np.arange(len(known))
    axes.axvline(0.0, color=ZERO, linewidth=0.8)
    axes.errorbar(
        [one.mean for _, one in known],
        at,
        xerr=[WITHIN_95 * one.std for _, one in known],
        fmt="o",
        color=ON_WHITE.error,
        markersize=4.0,
        capsize=3,
    )
    axes.set_yticks(at, [name for name, _ in known])
    axes.set_ylim(len(known) - 0.5, -0.5)
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.xaxis.set_major_formatter(PLAIN)


def draw_shares(axes: Axes, series: Sequence[MotorSeries], found: Sequence[Region]) -> None:
    """Share of the squared error that lies in every region, beside its share of the time."""
    at = np.arange(len(found))
    both = [shares(series, one) for one in found]
    axes.barh(at, [100.0 * error for error, _ in both], 0.55, color=ON_WHITE.error)
    axes.barh(at, [100.0 * time for _, time in both], 0.85, color=NOISE, alpha=0.75)
    axes.set_yticks(at, [one.name for one in found])
    axes.set_ylim(len(found) - 0.4, -0.6)
    small_title(axes, "grey: share of the time")
