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
# x'' = sum c_k (x[i + k] - 2 x[i] + x[i - k]) / dt^2.
SECOND = {2: (1.0,), 4: (4 / 3, -1 / 12), 6: (3 / 2, -3 / 20, 1 / 90), 8: (8 / 5, -1 / 5, 8 / 315, -1 / 560)}


def central_difference(x: FloatArray, dt: float, order: int = 8) -> FloatArray:
    """Return the first derivative along axis 0.

    The error of a sine of angular frequency w is about (w dt)^order / c, with c = 6, 30, 140, 630 for the
    orders 2, 4, 6, 8. The order / 2 samples at each end use one-sided formulas: two points for order 2
    (as Gautier's `diffcent`), order + 1 points for the others.

    Args:
        x: samples at a uniform interval, shape (N, ...).
        dt: sampling interval [s].
        order: 2, 4, 6 or 8.

    Raises:
        BenchError: another order, a dt that is not positive, or a record shorter than order + 1 samples.
    """
    coefficients = _coefficients(FIRST, x, dt, order, "central difference")
    x = np.asarray(x, dtype=float)
    half, n = order // 2, len(x)
    out = np.empty_like(x)
    inner = out[half : n - half]
    np.subtract(x[half + 1 : n - half + 1], x[half - 1 : n - half - 1], out=inner)
    inner *= coefficients[0]
    for k, c in enumerate(coefficients[1:], start=2):
        inner += c * (x[half + k : n - half + k] - x[half - k : n - half - k])
    _borders(x, out, half, 1, points=2 if order == 2 else order + 1)
    out /= dt
    return out


def second_difference(x: FloatArray, dt: float, order: int = 8) -> FloatArray:
    """Return the second derivative along axis 0 from the compact symmetric formula.

    It keeps more of what lies near half the sampling rate than `central_difference` applied twice, so use
    it on filtered signals. The order / 2 samples at each end use one-sided formulas of order + 2 points.

    Args, errors: as `central_difference`; the record needs order + 2 samples.
    """
    coefficients = _coefficients(SECOND, x, dt, order, "second difference")
    x = np.asarray(x, dtype=float)
    half, n = order // 2, len(x)
    out = np.empty_like(x)
    inner = out[half : n - half]
    middle = x[half : n - half]
    inner[...] = 0
    for k, c in enumerate(coefficients, start=1):
        # Differences of neighbours first: x itself may be large against its second difference.
        ahead = x[half + k : n - half + k] - middle
        ahead -= middle - x[half - k : n - half - k]
        inner += c * ahead
    _borders(x, out, half, 2, points=order + 2)
    out /= dt * dt
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


def _borders(x: FloatArray, out: FloatArray, half: int, derivative: int, points: int) -> None:
    sign = (-1) ** derivative
    weights = _border_coefficients(half, points, derivative)
    out[:half] = np.tensordot(weights, x[:points], axes=1)
    out[::-1][:half] = sign * np.tensordot(weights, x[::-1][:points], axes=1)


@lru_cache(maxsize=16)
def _border_coefficients(half: int, points: int, derivative: int) -> FloatArray:
    """Weights (half, points) of the first samples for derivatives at the first few."""
    return np.array([one_sided_coefficients(i, points, derivative) for i in range(half)])


def _coefficients(
    table: dict[int, tuple[float, ...]], x: FloatArray, dt: float, order: int, what: str
) -> tuple[float, ...]:
    if order not in table:
        raise BenchError(f"{what}: order {order} is not one of 2, 4, 6, 8")
    if not dt > 0:
        raise BenchError(f"{what}: sampling interval {dt:g} s must be positive")
    needed = order + (1 if table is FIRST else 2)
    if len(x) < needed:
        raise BenchError(f"{what}: {len(x)} samples are too few, order {order} needs at least {needed}")
    return table[order]
