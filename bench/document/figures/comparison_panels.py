"""Panels of a page on one motor's errors: against a variable, around reversals, by recording, spectra."""

from collections.abc import Mapping, Sequence

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FuncFormatter, MaxNLocator

from bench.basics.chi_squared import WITHIN_95
from bench.document.colours import ON_WHITE
from bench.residuals.autocorrelation import Autocorrelation
from bench.residuals.error_breakdown import Branch, Direction, ErrorBreakdown, RecordingError, RegionShares
from bench.residuals.opposing_motion import Opposing
from bench.residuals.periods import PositionSpectrum, Spectrum
from bench.residuals.profile import Profile, Variable

COLOURS: Mapping[Direction, str] = {"forwards": "#0072B2", "backwards": "#D55E00"}  # after Okabe and Ito
NOISE = "#9AA0A6"
ZERO = "#8A929C"
PLAIN = FuncFormatter(lambda value, _: f"{value:g}".replace("-", "−"))
MOST_POINTS = 2400  # drawn behind the means, and those far off beside; all rows count in the means
FAR = 3.0  # deviations of its bin from which on a row is always drawn
OUTSIDE = 1.6  # times what most errors are: axes reach no farther
BINS = 24
LIMIT = 99.5  # percentile that stands for most errors


def worth_drawing(x: np.ndarray, errors: np.ndarray, bins: Profile, most: int) -> np.ndarray:
    """Indices of rows to draw as points: a regular choice of about `most`, and every row far from its bin's mean."""
    size = len(bins.mean)
    index = np.clip(np.searchsorted(bins.edges, x, side="right") - 1, 0, size - 1)
    far = np.abs(errors - np.nan_to_num(bins.mean)[index]) > FAR * np.nan_to_num(bins.spread)[index]
    far |= (errors == errors.max()) | (errors == errors.min())
    every = max(1, -(-len(x) // most))
    return np.flatnonzero(far | (np.arange(len(x)) % every == 0))


def draw_against(axes: Axes, errors: ErrorBreakdown, variable: Variable, scale: float = 1.0) -> None:
    """Errors against a variable: points, means of bins and their spread, apart for either direction.

    scale: of lines and marks.
    """
    draw_noise_band(axes, errors.noise)
    draw_branches(axes, errors.against(variable, BINS), scale)


def draw_around_reversals(axes: Axes, errors: ErrorBreakdown, scale: float = 1.0) -> None:
    """Mean error before and after a change of direction, apart for what the direction is afterwards."""
    draw_noise_band(axes, errors.noise)
    axes.axvline(0.0, color=ZERO, linewidth=0.8 * scale)
    draw_branches(axes, errors.around_reversals, scale)
    if not errors.around_reversals:
        axes.text(0.5, 0.5, "never reverses while it moves", transform=axes.transAxes, ha="center")
    small_title(axes, "colour: the direction afterwards")


def draw_branches(axes: Axes, found: Sequence[Branch], scale: float = 1.0) -> None:
    """Points, means of bins, and their spread as a band."""
    for branch in found:
        colour, drawn = COLOURS[branch.direction], points_of(branch)
        axes.plot(
            branch.x[drawn],
            branch.error[drawn],
            ".",
            color=colour,
            markersize=1.8 * scale,
            alpha=0.3,
            rasterized=True,
        )
        axes.fill_between(
            branch.bins.center,
            branch.bins.mean - branch.bins.spread,
            branch.bins.mean + branch.bins.spread,
            color=colour,
            alpha=0.16,
            linewidth=0.0,
        )
        axes.plot(
            branch.bins.center,
            branch.bins.mean,
            color=colour,
            linewidth=1.6 * scale,
            marker="o",
            markersize=3.2 * scale,
            label=branch.direction,
        )
    if found:
        _set_limits(axes, found, scale)


def points_of(branch: Branch) -> np.ndarray:
    """Which rows of one direction are drawn as points."""
    return worth_drawing(branch.x, branch.error, branch.bins, MOST_POINTS // 2)


def small_title(axes: Axes, text: str) -> None:
    """What grey and the like stand for, above a panel without a legend."""
    size = 0.85 * float(mpl.rcParams["font.size"])
    axes.set_title(text, fontsize=size, color="#4A525C", loc="right")


def draw_noise_band(axes: Axes, noise: float, label: str = "± noise of the current") -> None:
    """Plus and minus the noise of the current."""
    axes.axhspan(-noise, noise, color=NOISE, alpha=0.45, linewidth=0.0, label=label)


def _set_limits(axes: Axes, found: Sequence[Branch], scale: float) -> None:
    """All errors in view, unless single ones far off would hide the others: those are marked at the border."""
    drawn = [points_of(branch) for branch in found]
    errors = np.abs(np.concatenate([branch.error[rows] for branch, rows in zip(found, drawn, strict=True)]))
    most, largest = float(np.percentile(errors, LIMIT)), float(errors.max())
    reach = 1.08 * min(largest, OUTSIDE * most) or 1.0
    axes.set_ylim(-reach, reach)
    for branch, rows in zip(found, drawn, strict=True):
        for sign, marker in ((1.0, 6), (-1.0, 7)):  # carets that point out of the axes
            out = sign * branch.error[rows] > reach
            if out.any():
                axes.plot(
                    branch.x[rows][out],
                    np.full(int(out.sum()), sign * 0.99 * reach),
                    linestyle="none",
                    marker=marker,
                    color=COLOURS[branch.direction],
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


def draw_recordings(axes: Axes, found: Sequence[RecordingError]) -> None:
    """Error of every recording beside the noise of its current, both relative to the current."""
    names = [
        f"{shortened(recording.recording)}\n{shortened(recording.payload or 'no payload')}"
        for recording in found
    ]
    at = np.arange(len(found))
    axes.barh(at, [100.0 * recording.error for recording in found], 0.55, color=ON_WHITE.error)
    axes.barh(at, [100.0 * recording.noise for recording in found], 0.8, color=NOISE, alpha=0.75)
    axes.set_yticks(at, names)
    axes.invert_yaxis()
    small_title(axes, "grey: noise of the current")


def shortened(name: str, most: int = 16) -> str:
    """A name that fits beside a bar; its middle gives way."""
    half = (most - 1) // 2
    return name if len(name) <= most else f"{name[: most - 1 - half]}…{name[-half:]}"


def draw_opposing(axes: Axes, known: Sequence[tuple[str, Opposing]]) -> None:
    """Mean error that opposes the motion, early and late and by payload, with its 95 % interval."""
    at = np.arange(len(known))
    axes.axvline(0.0, color=ZERO, linewidth=0.8)
    axes.errorbar(
        [opposing.mean for _, opposing in known],
        at,
        xerr=[WITHIN_95 * opposing.std for _, opposing in known],
        fmt="o",
        color=ON_WHITE.error,
        markersize=4.0,
        capsize=3,
    )
    axes.set_yticks(at, [name for name, _ in known])
    axes.set_ylim(len(known) - 0.5, -0.5)
    axes.xaxis.set_major_locator(MaxNLocator(3))
    axes.xaxis.set_major_formatter(PLAIN)


def draw_shares(axes: Axes, found: Sequence[RegionShares]) -> None:
    """Share of the squared error that lies in every region, beside its share of the time."""
    at = np.arange(len(found))
    axes.barh(at, [100.0 * region.error for region in found], 0.55, color=ON_WHITE.error)
    axes.barh(at, [100.0 * region.time for region in found], 0.85, color=NOISE, alpha=0.75)
    axes.set_yticks(at, [region.region for region in found])
    axes.set_ylim(len(found) - 0.4, -0.6)
    small_title(axes, "grey: share of the time")
