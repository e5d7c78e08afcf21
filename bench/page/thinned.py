"""Fewer numbers that draw the same picture: extremes kept, digits that no eye sees omitted."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

DIGITS = 1.0 / 4000.0  # of a curve's extent: finer than a pixel


def rounded(values: np.ndarray, extent: float | None = None) -> list[float | None]:
    """Values (N,) to the digits that are seen in a figure of this extent (that of the values); None for NaN."""
    values = np.asarray(values, dtype=float)
    known = values[np.isfinite(values)]
    if extent is None:
        extent = float(np.ptp(known)) if len(known) else 0.0
    extent = extent or float(np.abs(known).max(initial=0.0)) or 1.0
    decimals = int(np.ceil(-np.log10(extent * DIGITS)))
    if decimals > 15:  # tiny: by significant digits
        return [float(f"{v:.5g}") if np.isfinite(v) else None for v in values.tolist()]
    short = np.round(values, decimals)
    return [None if not np.isfinite(v) else int(v) if decimals <= 0 else v for v in (short + 0.0).tolist()]


def significant(values: npt.ArrayLike, digits: int = 5) -> list[float | None]:
    """Values (N,) to some significant digits, for logarithmic axes; None for NaN."""
    return [
        float(f"{v:.{digits}g}") if np.isfinite(v) else None for v in np.asarray(values, dtype=float).tolist()
    ]


def thinned(
    row: np.ndarray, period: float, curves: Mapping[str, np.ndarray], most: int
) -> tuple[dict[str, float], dict[str, list[Any]], int]:
    """Curves over evenly spaced rows, with at most about `most` points each; gaps where rows are missing.

    row (M,): number of each row, rising; period: s between rows; curves: (M,) each. Returns x as {start, step} in
    seconds, the curves' values, and how many rows lie behind two points (one: nothing is omitted). Of every
    stretch of rows the smallest and the largest value are kept, in their order: no outlier is lost.
    """
    count = int(row[-1] - row[0]) + 1
    start = float(row[0]) * period
    filled = {name: np.full(count, np.nan) for name in curves}
    for name, values in curves.items():
        filled[name][row - row[0]] = values
    if count <= most:
        every = {name: rounded(values) for name, values in filled.items()}
        return {"start": _short(start), "step": _short(period)}, every, 1
    width = -(-2 * count // most)
    kept = {name: rounded(extremes(values, width)) for name, values in filled.items()}
    at = start + period * (width / 4.0 - 0.5)
    return {"start": _short(at), "step": _short(period * width / 2.0)}, kept, width


def extremes(values: np.ndarray, width: int) -> np.ndarray:
    """The smallest and the largest value of every stretch of `width` values, in the order in which they come.

    Two values a stretch, (2 ceil(N / width),); NaN where it holds nothing else.
    """
    stretches = -(-len(values) // width)
    padded = np.full(stretches * width, np.nan)
    padded[: len(values)] = values
    blocks = padded.reshape(stretches, width)
    empty = np.isnan(blocks).all(axis=1)
    low_at = np.argmin(np.where(np.isnan(blocks), np.inf, blocks), axis=1)
    high_at = np.argmax(np.where(np.isnan(blocks), -np.inf, blocks), axis=1)
    index = np.arange(stretches)
    first, last = np.minimum(low_at, high_at), np.maximum(low_at, high_at)
    pairs = np.column_stack((blocks[index, first], blocks[index, last]))
    pairs[empty] = np.nan
    return pairs.reshape(-1)


def _short(value: float) -> float:
    return float(f"{value:.9g}")
