"""Panels of a page on one motor's errors: against a variable, around reversals, by recording, spectra."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from bench.compare.concentration import shares
from bench.compare.memory import autocorrelation
from bench.compare.motor import MotorSeries, relative_error_of, relative_noise
from bench.compare.opposing import by_load, over_warm_up
from bench.compare.periods import position_spectrum, time_spectrum
from bench.compare.profile import Variable, binned, profile, values_of
from bench.compare.regions import Region
from bench.show.colours import ON_WHITE

FORWARDS, BACKWARDS, NOISE = "#0072B2", "#D55E00", "#9AA0A6"  # after Okabe and Ito
MOST_POINTS = 2500  # drawn behind the means; all rows count in these
BINS = 24
AROUND = 8  # rows before and after a reversal
LIMIT = 99.5  # percentile of the errors that the axes hold


def draw_against(axes: Axes, series: Sequence[MotorSeries], variable: Variable) -> None:
    """Errors against a variable: points, means of bins and their spread, apart for either direction."""
    x = np.concatenate([values_of(one, variable) for one in series])
    errors = np.concatenate([one.error for one in series])
    forwards = np.concatenate([one.forwards for one in series])
    draw_noise_band(axes, series)
    every = max(1, -(-len(x) // MOST_POINTS))
    for way, colour, label in ((forwards, FORWARDS, "forwards"), (~forwards, BACKWARDS, "backwards")):
        if not way.any():
            continue
        axes.plot(
            x[way][::every],
            errors[way][::every],
            ".",
            color=colour,
            markersize=1.6,
            alpha=0.3,
            rasterized=True,
        )
        bins = profile(x[way], errors[way], BINS)
        axes.fill_between(
            bins.center,
            bins.mean - bins.spread,
            bins.mean + bins.spread,
            color=colour,
            alpha=0.16,
            linewidth=0.0,
        )
        axes.plot(
            bins.center, bins.mean, color=colour, linewidth=1.6, marker="o", markersize=3.0, label=label
        )
    _set_limits(axes, errors)


def draw_around_reversals(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Mean error before and after a change of direction, apart for what the direction is afterwards."""
    rate = series[0].rate or 1.0
    rows = np.concatenate([one.to_reversal for one in series])
    errors = np.concatenate([one.error for one in series])
    # a row before a reversal to forwards moves backwards
    into = np.concatenate([one.forwards ^ (one.to_reversal < 0) for one in series])
    draw_noise_band(axes, series)
    axes.axvline(0.0, color="#8A929C", linewidth=0.8)
    near = np.abs(rows) <= AROUND
    every = max(1, -(-int(near.sum()) // MOST_POINTS))
    for way, colour in ((near & into, FORWARDS), (near & ~into, BACKWARDS)):
        if not way.any():
            continue
        axes.plot(
            rows[way][::every] / rate,
            errors[way][::every],
            ".",
            color=colour,
            markersize=1.6,
            alpha=0.3,
            rasterized=True,
        )
        bins = binned(rows[way], errors[way], np.arange(-AROUND, AROUND + 1.0))
        center = bins.center / rate
        axes.fill_between(
            center, bins.mean - bins.spread, bins.mean + bins.spread, color=colour, alpha=0.16, linewidth=0.0
        )
        axes.plot(center, bins.mean, color=colour, linewidth=1.6, marker="o", markersize=3.0)
    if near.any():
        _set_limits(axes, errors[near])
    else:
        axes.text(0.5, 0.5, "never reverses while it moves", transform=axes.transAxes, ha="center")
    _small_title(axes, "colour: the direction afterwards")


def _small_title(axes: Axes, text: str) -> None:
    axes.set_title(text, fontsize=8, color="#4A525C", loc="right")


def draw_noise_band(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Plus and minus the noise of the current, all recordings together."""
    rows = [len(one.time) for one in series]
    noise = float(np.sqrt(np.average([one.noise**2 for one in series], weights=rows)))
    axes.axhspan(-noise, noise, color=NOISE, alpha=0.45, linewidth=0.0, label="± noise of the current")


def _set_limits(axes: Axes, errors: np.ndarray) -> None:
    """Nearly all errors in view: single ones far off would hide the others."""
    reach = 1.15 * float(np.percentile(np.abs(errors), LIMIT)) or 1.0
    axes.set_ylim(-reach, reach)


def draw_time_spectrum(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Density of the error over frequency, and that of the current's noise."""
    found = time_spectrum(series)
    axes.axhline(found.noise, color=NOISE, linewidth=3.0, alpha=0.6)
    axes.semilogy(found.frequency[1:], found.density[1:], color=ON_WHITE.error, linewidth=1.0)
    if found.noise > 0:
        axes.set_ylim(bottom=found.noise / 30.0)
    _small_title(axes, "grey: noise of the current")


def draw_position_spectrum(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Amplitude of the sinusoid over position that suits the error best, by its wave number."""
    found = position_spectrum(series)
    axes.plot(found.cycles, found.amplitude, color=ON_WHITE.error, linewidth=0.9, marker=".", markersize=2.5)
    axes.set_ylim(bottom=0.0)


def draw_autocorrelation(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Autocorrelation of the error, and what chance gives."""
    found = autocorrelation(series)
    axes.axhspan(-found.band, found.band, color=NOISE, alpha=0.45, linewidth=0.0)
    axes.vlines(found.lag, 0.0, found.value, color=ON_WHITE.error, linewidth=1.0)
    axes.plot(found.lag, found.value, "o", color=ON_WHITE.error, markersize=2.5)
    _small_title(axes, "grey: 95 % of what is there by chance")
    axes.set_ylim(min(-0.25, float(found.value.min()) - 0.05), 1.05)


def draw_recordings(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Error of every recording beside the noise of its current, both relative to the current."""
    names = [f"{one.recording}\n{one.payload or 'no payload'}" for one in series]
    at = np.arange(len(series))
    axes.barh(at, [100.0 * (relative_error_of([one]) or 0.0) for one in series], 0.55, color=ON_WHITE.error)
    axes.barh(at, [100.0 * relative_noise([one]) for one in series], 0.8, color=NOISE, alpha=0.75)
    axes.set_yticks(at, names, fontsize=7.5)
    axes.invert_yaxis()
    _small_title(axes, "grey: noise of the current")


def draw_opposing(axes: Axes, series: Sequence[MotorSeries]) -> None:
    """Mean error that opposes the motion, early and late and by payload, with its 95 % interval."""
    parts = [*over_warm_up(series), *by_load(series)]
    names = ["first third", "last third", *(one.part for one in parts[2:])]
    known = [(name, one) for name, one in zip(names, parts, strict=True) if np.isfinite(one.std)]
    at = np.arange(len(known))
    axes.axvline(0.0, color="#8A929C", linewidth=0.8)
    axes.errorbar(
        [one.mean for _, one in known],
        at,
        xerr=[1.96 * one.std for _, one in known],
        fmt="o",
        color=ON_WHITE.error,
        markersize=4.0,
        capsize=3,
    )
    axes.set_yticks(at, [name for name, _ in known], fontsize=7.5)
    axes.set_ylim(len(known) - 0.5, -0.5)
    axes.xaxis.set_major_locator(MaxNLocator(4))


def draw_shares(axes: Axes, series: Sequence[MotorSeries], found: Sequence[Region]) -> None:
    """Share of the squared error that lies in every region, beside its share of the time."""
    at = np.arange(len(found))
    both = [shares(series, one) for one in found]
    axes.barh(at, [100.0 * error for error, _ in both], 0.55, color=ON_WHITE.error)
    axes.barh(at, [100.0 * time for _, time in both], 0.85, color=NOISE, alpha=0.75)
    axes.set_yticks(at, [one.name for one in found], fontsize=7)
    axes.set_ylim(len(found) - 0.4, -0.6)
    _small_title(axes, "grey: share of the time")
