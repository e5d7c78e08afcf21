"""Piecewise polynomials through samples. scipy.interpolate has the same, and takes half a second to import."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_banded

FloatArray = NDArray[np.float64]
Given = NDArray[np.floating]

FEWEST = 4  # knots of a cubic spline whose two outermost pieces at either end are one polynomial


@dataclass(frozen=True)
class PiecewisePolynomial:
    """Between knots k and k + 1 the sum of coefficients[d - j, k] * (t - knots[k])**j over j = 0 ... d.

    coefficients: (d + 1, K - 1, ...); knots: (K,), rising.
    """

    coefficients: FloatArray
    knots: Given

    def __call__(self, t: Given) -> FloatArray:
        """Values (N, ...) at t (N,); outside the knots the outermost pieces go on."""
        if np.any(t[1:] < t[:-1]):
            order = np.argsort(t, kind="stable")
            values = np.empty((len(t), *self.coefficients.shape[2:]))
            values[order] = self(t[order])
            return values
        # In rising order a piece's samples follow each other: it is repeated along them, column by column.
        counts = np.diff(np.concatenate(([0], np.searchsorted(t, self.knots[1:-1]), [len(t)])))
        distance = t - np.repeat(self.knots[:-1], counts)
        pieces = self.coefficients.reshape(*self.coefficients.shape[:2], -1).transpose(0, 2, 1)
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
    band = np.zeros((3, len(t)))
    band[0, 2:], band[1, 1:-1], band[2, :-2] = step[:-1], 2.0 * (step[:-1] + step[1:]), step[1:]
    band[0, 1], band[1, 0] = t[2] - t[0], step[1]
    band[2, -2], band[1, -1] = t[-1] - t[-3], step[-2]
    right = np.empty(values.shape)
    right[1:-1] = 3.0 * (wide[1:] * chord[:-1] + wide[:-1] * chord[1:])
    first, last = t[2] - t[0], t[-1] - t[-3]
    right[0] = ((step[0] + 2.0 * first) * step[1] * chord[0] + step[0] ** 2 * chord[1]) / first
    right[-1] = (step[-1] ** 2 * chord[-2] + (2.0 * last + step[-1]) * step[-2] * chord[-1]) / last
    slope = solve_banded((1, 1), band, right.reshape(len(t), -1)).reshape(values.shape)
    bend = (slope[:-1] + slope[1:] - 2.0 * chord) / wide
    return PiecewisePolynomial(
        np.stack((bend / wide, (chord - slope[:-1]) / wide - bend, slope[:-1], values[:-1])), t
    )
