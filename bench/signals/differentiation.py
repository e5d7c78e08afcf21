"""Derivatives of sampled signals by central differences.

Source of the coefficients: B. Fornberg, "Generation of finite difference formulas on arbitrarily spaced
grids", Mathematics of Computation 51, 1988. `central_difference` of order 2 is the `diffcent` of
M. Gautier (1994), used with the published EMPS data; there the acceleration is the central difference of
the velocity.
"""

from functools import lru_cache
from math import factorial

import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError

FloatArray = NDArray[np.float64]

# Coefficients at distance 1, 2, ... from the sample: x' = sum c_k (x[i + k] - x[i - k]) / dt.
FIRST = {2: (1 / 2,), 4: (2 / 3, -1 / 12), 6: (3 / 4, -3 / 20, 1 / 60), 8: (4 / 5, -1 / 5, 4 / 105, -1 / 280)}


def central_difference(x: FloatArray, dt: float, order: int = 8) -> FloatArray:
    """Return the first derivative along axis 0.

    The error of a sine of angular frequency w is about (w dt)^order / c, with c = 6, 30, 140, 630 for the
    orders 2, 4, 6, 8. The order / 2 samples at each end use one-sided formulas: two points for order 2
    (as Gautier's `diffcent`), order + 1 points for the others.

    x: samples at a uniform interval, shape (N, ...). dt: sampling interval [s]. order: 2, 4, 6 or 8. Raises BenchError:
    another order, a dt that is not positive, or a record shorter than order + 1 samples.
    """
    if order not in FIRST:
        raise BenchError(f"central difference: order {order} is not one of 2, 4, 6, 8")
    if not dt > 0:
        raise BenchError(f"central difference: sampling interval {dt:g} s must be positive")
    if len(x) < order + 1:
        raise BenchError(
            f"central difference: {len(x)} samples are too few, order {order} needs at least {order + 1}"
        )
    coefficients, x = FIRST[order], np.asarray(x, dtype=float)
    half, n = order // 2, len(x)
    out = np.empty_like(x)
    inner = out[half : n - half]
    np.subtract(x[half + 1 : n - half + 1], x[half - 1 : n - half - 1], out=inner)
    inner *= coefficients[0]
    for k, c in enumerate(coefficients[1:], start=2):
        inner += c * (x[half + k : n - half + k] - x[half - k : n - half - k])
    points = 2 if order == 2 else order + 1
    weights = _border_coefficients(half, points)
    out[:half] = np.tensordot(weights, x[:points], axes=1)
    out[::-1][:half] = -1 * np.tensordot(weights, x[::-1][:points], axes=1)
    out /= dt
    return out


def one_sided_coefficients(at: int, points: int, derivative: int) -> FloatArray:
    """Return the weights, shape (points,), of samples 0, 1, ... for a derivative at sample `at`, dt = 1.

    They are exact for polynomials of degree below `points`.
    """
    offsets = np.arange(points, dtype=float) - at
    powers = np.vander(offsets, increasing=True).T
    target = np.zeros(points)
    target[derivative] = factorial(derivative)
    return np.asarray(np.linalg.solve(powers, target), dtype=float)


@lru_cache(maxsize=16)
def _border_coefficients(half: int, points: int) -> FloatArray:
    """Weights (half, points) of the first samples for derivatives at the first few."""
    return np.array([one_sided_coefficients(i, points, 1) for i in range(half)])
