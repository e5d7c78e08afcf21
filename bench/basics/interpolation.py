"""Piecewise polynomials through samples, as in scipy.interpolate, which takes half a second to import."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.lapack import dgtsv, dgttrf, dgttrs

FloatArray = NDArray[np.float64]
Given = NDArray[np.floating]

FEWEST = 4  # knots of a "not-a-knot" cubic spline, whose two outermost pieces at each end are one polynomial


@dataclass(frozen=True)
class PiecewisePolynomial:
    """Between knots k and k + 1 the sum of coefficients[d - j, k] * (t - knots[k])**j over j = 0 ... d.

    coefficients: (d + 1, K - 1, ...); knots: (K,), rising.
    """

    coefficients: FloatArray
    knots: Given

    def __call__(self, t: Given) -> FloatArray:
        """Values (N, ...) at t (N,); outside the knots, the outermost pieces are extrapolated."""
        if np.any(t[1:] < t[:-1]):
            order = np.argsort(t, kind="stable")
            values = np.empty((len(t), *self.coefficients.shape[2:]))
            values[order] = self(t[order])
            return values
        # With rising t, the samples of a piece are adjacent: its coefficients are repeated along them, column by
        # column.
        first, last = np.searchsorted(self.knots[1:-1], t[[0, -1]], side="right") if len(t) else (0, 0)
        asked = slice(int(first), int(last) + 1)
        counts = np.diff(
            np.searchsorted(t, self.knots[asked.start + 1 : asked.stop]), prepend=0, append=len(t)
        )
        distance = t - np.repeat(self.knots[asked], counts)
        pieces = self.coefficients[:, asked]
        pieces = pieces.reshape(*pieces.shape[:2], -1).transpose(0, 2, 1)
        values = np.repeat(pieces[0], counts, axis=1)
        for coefficient in pieces[1:]:
            values *= distance
            values += np.repeat(coefficient, counts, axis=1)
        return np.ascontiguousarray(values.T).reshape(len(t), *self.coefficients.shape[2:])


def cubic_spline(t: Given, values: Given) -> PiecewisePolynomial:
    """The cubic spline through values (K, ...) at t (K,), rising, K >= 4, with "not-a-knot" ends.

    Its slopes s solve h[k] s[k-1] + 2 (h[k-1] + h[k]) s[k] + h[k-1] s[k+1] = 3 (h[k] m[k-1] + h[k-1] m[k]), with
    steps h and m the slopes of the chords (C. de Boor, "A Practical Guide to Splines", 1978, chapter IV).
    """
    if len(t) < FEWEST:
        raise ValueError(f"a cubic spline through {len(t)} samples: it needs at least {FEWEST}")
    step = np.diff(t)
    wide = step.reshape(-1, *(1,) * (values.ndim - 1))
    chord = np.diff(values, axis=0) / wide
    right = np.empty(values.shape)
    right[1:-1] = 3.0 * (wide[1:] * chord[:-1] + wide[:-1] * chord[1:])
    first, last = t[2] - t[0], t[-1] - t[-3]
    right[0] = ((step[0] + 2.0 * first) * step[1] * chord[0] + step[0] ** 2 * chord[1]) / first
    right[-1] = (step[-1] ** 2 * chord[-2] + (2.0 * last + step[-1]) * step[-2] * chord[-1]) / last
    slope = dgtsv(*_equations(step), right.reshape(len(t), -1))[3].reshape(values.shape)
    bend = (slope[:-1] + slope[1:] - 2.0 * chord) / wide
    return PiecewisePolynomial(
        np.stack((bend / wide, (chord - slope[:-1]) / wide - bend, slope[:-1], values[:-1])), t
    )


def spline_at_every(values: FloatArray, every: int, count: int) -> FloatArray:
    """The same spline through values (K, ...) that are `every` samples apart, evaluated at the samples 0 to `count` -
    1.

    Returns (count, ...); samples after the last value are extrapolated as in `PiecewisePolynomial`.
    """
    if len(values) < FEWEST:
        raise ValueError(f"a cubic spline through {len(values)} samples: it needs at least {FEWEST}")
    given = np.ascontiguousarray(values, dtype=float).reshape(len(values), -1)
    chord = np.diff(given, axis=0)
    right = np.empty(given.shape)
    np.add(chord[:-1], chord[1:], out=right[1:-1])
    right[1:-1] *= 3.0
    right[0], right[-1] = 2.5 * chord[0] + 0.5 * chord[1], 0.5 * chord[-2] + 2.5 * chord[-1]
    slope = np.ascontiguousarray(dgttrs(*_even(len(values)), right)[0])
    ends = np.stack((given[:-1], given[1:], slope[:-1], slope[1:]))
    whole = (len(values) - 1) * every
    out = np.empty((count, given.shape[1]))
    inside = hermite_weights(np.arange(every) / every) @ ends.reshape(4, -1)
    pieces = inside.reshape(every, len(chord), -1).transpose(1, 0, 2)
    out[:whole].reshape(len(chord), every, -1)[:] = pieces
    out[whole:] = hermite_weights(1.0 + np.arange(count - whole) / every) @ ends[:, -1]
    return out.reshape(count, *values.shape[1:])


def hermite_weights(share: FloatArray) -> FloatArray:
    """Weights (N, 4) of a cubic's values at 0 and 1 and its slopes at 0 and 1, at positions (N,) between 0 and 1."""
    square = share * share
    rise = square * (3.0 - 2.0 * share)
    return np.stack((1.0 - rise, rise, share * (1.0 - share) ** 2, square * (share - 1.0)), axis=1)


def _equations(step: Given) -> tuple[Given, Given, Given]:
    """Lower, main and upper diagonal of the equations for a spline's slopes, from steps (K - 1,)."""
    diagonal = np.concatenate((step[1:2], 2.0 * (step[:-1] + step[1:]), step[-2:-1]))
    below = np.append(step[1:], step[-1] + step[-2])
    above = np.concatenate(([step[0] + step[1]], step[:-1]))
    return below, diagonal, above


@lru_cache(maxsize=64)
def _even(count: int) -> tuple[FloatArray, ...]:
    """The LU factors of these equations for `count` values with unit steps."""
    return tuple(dgttrf(*_equations(np.ones(count - 1)))[:5])
