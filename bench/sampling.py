"""The time column: what is wrong with it, and how samples that are not quite uniform become uniform.

Positions are differentiated twice, so a recording must lie on a uniform grid. Real logs nearly do:

- time stamps within a thousandth of a step of a uniform grid are taken as they are (rounded stamps);
- stamps that jitter more are believed: every signal is read off at the grid's instants by a cubic spline
  through the samples (other columns: the nearest sample);
- a sample that was lost is a gap and an error: nothing is invented between two samples.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.interpolate import make_interp_spline

FEWEST = 100  # samples: filters and decimation need some to settle
SLOWEST_STEP = 0.1  # s: a robot's controller logs faster than 10 Hz
FASTEST_STEP = 5e-6  # s: and slower than 200 kHz
UNIFORM = 1e-3  # of a step: stamps this near to a uniform grid are on it
GAP = 1.5  # steps: a longer one is a gap, unless a neighbouring step makes good for it

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class TimeFault:
    """What is wrong with a time column; `row` is None where it is all of it."""

    row: int | None
    what: str


def time_fault(time: Array) -> TimeFault | None:
    """The first fault of the time stamps (N,) in s: order, count, unit, gaps. None when there is none."""
    if time.size < FEWEST:
        return TimeFault(None, f"has only {time.size} samples, at least {FEWEST} are needed")
    steps = np.diff(time)
    return _order_fault(time, steps) or _unit_fault(steps) or _gap_fault(time, steps)


def _order_fault(time: Array, steps: Array) -> TimeFault | None:
    wrong = np.flatnonzero(steps <= 0.0)
    if not wrong.size:
        return None
    row = int(wrong[0]) + 1
    what = "repeats" if steps[row - 1] == 0.0 else "goes back: it follows"
    text = f"{float(time[row])!r} s {what} {float(time[row - 1])!r} s{_more(wrong.size)}"
    if wrong.size > 0.1 * time.size and not (steps < 0.0).any():
        text += ": are the stamps rounded more coarsely than a step?"
    return TimeFault(row, text)


def _unit_fault(steps: Array) -> TimeFault | None:
    step = float(np.median(steps))
    if step >= SLOWEST_STEP * (1 - 1e-9):
        factors = {1e3: "milliseconds", 1e6: "microseconds", 1e9: "nanoseconds"}
        fitting = [unit for factor, unit in factors.items() if 20e-6 < step / factor < 0.05]
        unit = f"it looks like {fitting[0]}" if fitting else "too slow for a robot's controller"
        return TimeFault(None, f"steps by {step:g}, which is not seconds: {unit}")
    if step <= FASTEST_STEP:
        return TimeFault(None, f"steps by {step:g} s, {1 / step:.3g} Hz: is it in minutes or hours?")
    return None


def _gap_fault(time: Array, steps: Array) -> TimeFault | None:
    step = float(np.median(steps))
    # A late sample makes one step long and the next short; a lost one makes each pair of steps long.
    pairs = steps[:-1] + steps[1:]
    before = np.concatenate([pairs[:1], pairs])
    after = np.concatenate([pairs, pairs[-1:]])
    gaps = np.flatnonzero((steps > GAP * step) & (np.minimum(before, after) > (1 + GAP) * step))
    if not gaps.size:
        return None
    row = int(gaps[0]) + 1
    return TimeFault(
        row,
        f"a gap of {steps[row - 1]:.6g} s before {float(time[row])!r} s, where samples are {step:.6g} s apart"
        f"{_more(gaps.size)}",
    )


def _more(count: int) -> str:
    return f" (and {count - 1} more)" if count > 1 else ""


def uniform_grid(time: Array) -> Array | None:
    """The uniform grid (N,) from the first stamp to the last, None when the stamps already lie on it."""
    grid = np.linspace(time[0], time[-1], time.size)
    step = (time[-1] - time[0]) / (time.size - 1)
    return None if np.abs(time - grid).max() <= UNIFORM * step else grid


def resample(time: Array, signals: Array, grid: Array) -> Array:
    """Signals (N, m) sampled at the stamps `time` (N,), read off at `grid` (N,) by a cubic spline: (N, m)."""
    return np.asarray(make_interp_spline(time, signals, k=3)(grid))


def nearest(time: Array, values: Array, grid: Array) -> Array:
    """Values (N,) sampled at the stamps `time` (N,): for each instant of `grid` that of the nearest stamp."""
    after = np.clip(np.searchsorted(time, grid), 1, time.size - 1)
    return values[np.where(grid - time[after - 1] <= time[after] - grid, after - 1, after)]
