"""The time column: its faults, and resampling of nearly uniform samples to a uniform grid.

Positions are differentiated twice, so a recording must lie on a uniform grid. Real logs nearly do so:

- stamps within a thousandth of a step of a uniform grid are on it (rounded stamps);
- stamps that jitter more may be the times of sampling, or only those of writing. The positions decide, since a joint
  moves smoothly. If a cubic spline through the stamps, evaluated on the grid, is smoother than the samples
  themselves, the stamps are correct and positions and currents are interpolated (other columns: the nearest sample);
  otherwise the samples stay and only the time column becomes uniform;
- stamps half a step or more away from the grid (a clock that drifts, a late sample) always count as correct;
- a lost sample is a gap and an error: no samples are invented.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import ceil, log10

import numpy as np
import numpy.typing as npt

from bench.basics.files.recording_fault import Remedy
from bench.basics.interpolation import cubic_spline
from bench.basics.plural import and_more, plural

FEWEST = 100  # samples: filters and decimation need them to settle
SLOWEST_STEP = 0.1  # s: a robot's controller logs faster than 10 Hz
FASTEST_USUAL = 0.25e-3  # s: a step of 0.1 means 10 Hz in seconds rather than 10 kHz in milliseconds
FASTEST_STEP = 5e-6  # s: no controller logs at 200 kHz or faster
UNIFORM = 1e-3  # of a step: stamps this close to a uniform grid count as on it
SMOOTHER = 0.9  # ratio of roughness that shows correct stamps; a spline alone smooths noise a little
HELD = 1e-2  # of the rows: a smaller share of repeated rows is chance, from coarse encoders and currents
LONGEST_HELD = 10  # consecutive rows: more are a robot at rest rather than rows held by the logger
TINY = 1e-300
TOGETHER = 10  # steps that are averaged: stamps rounded to 1 ms alternate between 2 and 3 for a step of 2.5
GAP = 1.5  # steps: a longer one is a gap, unless a neighbouring step compensates for it
LIKE = {
    1e3: ("milliseconds", Remedy.FROM_MILLISECONDS),
    1e6: ("microseconds", Remedy.FROM_MICROSECONDS),
    1e9: ("nanoseconds", Remedy.FROM_NANOSECONDS),
}
"""Number in a second -> name of the unit, and remedy."""

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TimeFault:
    """A fault of a time column; `row` is None for a fault of the whole column. remedy: its cure, if known."""

    row: int | None
    what: str
    remedy: Remedy | None = None


def time_fault(time: Array) -> TimeFault | None:
    """The first fault of the time stamps (N,) in s, in the order count, order, unit, gaps; None if there is none."""
    if time.size < FEWEST:
        return TimeFault(None, f"has only {plural(time.size, 'sample')}, at least {FEWEST} are needed")
    steps = np.diff(time)
    return _order_fault(time, steps) or _unit_fault(steps) or _gap_fault(time, steps)


def _order_fault(time: Array, steps: Array) -> TimeFault | None:
    wrong = np.flatnonzero(steps <= 0.0)
    if not wrong.size:
        return None
    row = int(wrong[0]) + 1
    what = "repeats" if steps[row - 1] == 0.0 else "goes back: it follows"
    text = f"{_stamp(time[row])} s {what} {_stamp(time[row - 1])} s{and_more(wrong.size)}"
    if wrong.size > 1 and not (steps < 0.0).any():
        text = f"{text}: are the stamps rounded more coarsely than a step?"
        if time[-1] > time[0]:
            rate = (time.size - 1) / (time[-1] - time[0])
            text += f" If samples were taken regularly, bench import --rate {rate:.5g} replaces them"
        return TimeFault(row, text)
    longest = int(np.diff([0, *cut_rows(time).tolist(), time.size]).max())
    return TimeFault(row, text, Remedy.CUT_WHERE_BACK if longest >= FEWEST else None)


def _unit_fault(steps: Array) -> TimeFault | None:
    step = float(np.median(steps))
    if step >= SLOWEST_STEP * (1 - 1e-9):
        for factor, (unit, remedy) in LIKE.items():
            if FASTEST_USUAL < step / factor < 0.05:
                counted = ", or counts samples (then give --rate HZ)" if np.all(steps == 1.0) else ""
                what = f"steps by {step:g}, which is not seconds: it looks like {unit}{counted}"
                return TimeFault(None, what, remedy)
        what = f"steps by {step:g} s, {1 / step:.3g} Hz: too slow for what a robot's motors need to be fitted"
        return TimeFault(None, what)
    if step <= FASTEST_STEP:
        what = f"steps by {step:g} s, {1 / step:.3g} Hz, which no controller logs: is its unit longer (ms, hours)"
        return TimeFault(None, what, Remedy.FROM_LONGER_UNIT)
    return None


def _usual_step(time: Array) -> float:
    """The step of stamps (N,), also of coarsely rounded ones: the median of means over several steps."""
    return float(np.median(time[TOGETHER:] - time[:-TOGETHER])) / TOGETHER


def gap_rows(time: Array) -> npt.NDArray[np.intp]:
    """The rows of time stamps (N,) in s that follow a gap; empty if there are too few stamps to judge."""
    if time.size < FEWEST:
        return np.empty(0, dtype=np.intp)
    steps, step = np.diff(time), _usual_step(time)
    # A late sample makes one step long and the next short; a lost one makes each pair of steps long.
    pairs = steps[:-1] + steps[1:]
    before = np.concatenate([pairs[:1], pairs])
    after = np.concatenate([pairs, pairs[-1:]])
    return np.flatnonzero((steps > GAP * step) & (np.minimum(before, after) > (1 + GAP) * step)) + 1


def cut_rows(time: Array) -> npt.NDArray[np.intp]:
    """The rows of time stamps (N,) in s before which time does not rise or has a gap."""
    back = (np.flatnonzero(np.diff(time) <= 0.0) + 1).tolist()
    gaps = [gap_rows(time[start:end]) + start for start, end in pairwise([0, *back, time.size])]
    return np.unique(np.concatenate([np.array(back, dtype=np.intp), *gaps]))


def _gap_fault(time: Array, steps: Array) -> TimeFault | None:
    rows = gap_rows(time)
    if not rows.size:
        return None
    row, step = int(rows[0]), _usual_step(time)
    gap = f"a gap of {steps[row - 1]:.6g} s before {_stamp(time[row])} s"
    what = f"{gap}, where samples are {step:.6g} s apart{and_more(rows.size)}"
    return TimeFault(row, what, Remedy.CUT_AT_GAPS)


def stamp_to(value: float, resolution: float, outward: int = 0) -> str:
    """A time in s as text, rounded to at most `resolution` s. outward: -1 never rounds up, 1 never down."""
    decimals = max(0, ceil(-log10(resolution)))
    rounded = round(value, decimals)
    if outward * (rounded - value) < 0.0:
        rounded = round(rounded + outward * 10.0**-decimals, decimals)
    return np.format_float_positional(rounded, trim="-")


def _stamp(value: float) -> str:
    """A time stamp to twelve digits, without the digits of its binary representation."""
    return f"{float(value):.12g}"


def repeated_rows(position: Array, current: Array) -> npt.NDArray[np.bool_]:
    """Mask (N,) of the rows of a moving robot that repeat the previous one in all positions (N, n) and currents (N,
    n), because the logger had no new values. All False if hardly any row does.
    """
    values = np.hstack([position, current])
    repeated = np.append(False, np.all(values[1:] == values[:-1], axis=1))
    repeated[-1] = False  # the grid ends with a measurement
    fresh = np.flatnonzero(~repeated)
    following = np.diff(fresh, append=len(values)) - 1  # rows that repeat each fresh one
    moves = np.append(np.any(np.diff(position[fresh], axis=0) != 0.0, axis=1), False)
    held = repeated & np.repeat(moves & (following <= LONGEST_HELD), following + 1)
    return held if held.mean() > HELD else np.zeros_like(held)


def on_uniform_grid(
    time: Array, position: Array, current: Array, extra: Mapping[str, Array], held: npt.NDArray[np.bool_]
) -> tuple[Array, Array, Array, dict[str, Array]]:
    """A recording's time (N,), position (N, n), current (N, n) and other columns (N,) on a uniform grid, without the
    rows that are held (N,), see `repeated_rows`.
    """
    grid, fresh = np.linspace(time[0], time[-1], time.size), ~held
    away, whole = np.abs(time - grid).max() / (grid[1] - grid[0]), bool(fresh.all())
    if whole and away <= UNIFORM:
        return time, position, current, dict(extra)
    signals = np.hstack([position, current])
    read = cubic_spline(time[fresh], signals[fresh])(grid)
    n = position.shape[1]
    if whole and away < 0.5 and _roughness(read[:, :n]) > SMOOTHER * _roughness(position):
        return grid, position, current, dict(extra)
    chosen = nearest(time, grid)
    return grid, read[:, :n], read[:, n:], {name: values[chosen] for name, values in extra.items()}


def _roughness(signals: Array) -> float:
    """Geometric mean over the columns of the RMS of their fourth differences, relative to their range."""
    rough = np.sqrt(np.mean(np.diff(signals, 4, axis=0) ** 2, axis=0))
    return float(np.exp(np.mean(np.log(rough / np.maximum(np.ptp(signals, axis=0), TINY) + TINY))))


def nearest(time: Array, grid: Array) -> npt.NDArray[np.intp]:
    """For each instant of `grid` (M,) the index of the nearest of the stamps `time` (N,): (M,)."""
    after = np.clip(np.searchsorted(time, grid), 1, time.size - 1)
    return np.where(grid - time[after - 1] <= time[after] - grid, after - 1, after)
