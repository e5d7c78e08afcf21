"""Numbers known only to lie in an interval: a middle and a radius, for all samples at once.

A result of balls contains that of every choice of numbers in them (midpoint-radius interval arithmetic, Rump,
"Verification methods: rigorous results using floating-point arithmetic", Acta Numerica 19, 2010). Rounding is part of
the radius. They take the place of the arrays of bench.model.scalars, so that the model's kinematics serve for them.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from bench.model.scalars import Scalar

ROUNDING = 2.0**-50  # of a result: exceeds the error of an operation on floats


@dataclass(frozen=True, eq=False)
class Ball(NDArrayOperatorsMixin):
    """All numbers within `radius` (N,) of `middle` (N,)."""

    middle: np.ndarray
    radius: np.ndarray

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **_: Any) -> Any:
        """Called by the arithmetic of `scalars` and numpy's functions; `out` is ignored: balls are new."""
        law = _LAWS.get(ufunc)
        if law is None or method != "__call__":
            return NotImplemented
        return law(
            *(value if isinstance(value, Ball) else Ball(np.asarray(value), np.zeros(())) for value in inputs)
        )


def _sum(a: Ball, b: Ball) -> Ball:
    middle = a.middle + b.middle
    return Ball(middle, a.radius + b.radius + ROUNDING * np.abs(middle))


def _difference(a: Ball, b: Ball) -> Ball:
    middle = a.middle - b.middle
    return Ball(middle, a.radius + b.radius + ROUNDING * np.abs(middle))


def _product(a: Ball, b: Ball) -> Ball:
    middle = a.middle * b.middle
    if not b.radius.ndim:
        a, b = b, a
    if not a.radius.ndim:  # exact
        return Ball(middle, np.abs(a.middle) * b.radius + ROUNDING * np.abs(middle))
    radius = (np.abs(a.middle) + a.radius) * b.radius + a.radius * np.abs(b.middle)
    return Ball(middle, radius + ROUNDING * np.abs(middle))


def _bent(value: np.ndarray, slope: np.ndarray, radius: np.ndarray) -> Ball:
    """Taylor's polynomial of first order, with a second derivative of at most 1."""
    return Ball(value, np.abs(slope) * radius + 0.5 * radius**2 + ROUNDING)


_LAWS: dict[np.ufunc, Callable[..., Ball]] = {
    np.add: _sum,
    np.subtract: _difference,
    np.multiply: _product,
    np.negative: lambda a: Ball(-a.middle, a.radius),
    np.sin: lambda a: _bent(np.sin(a.middle), np.cos(a.middle), a.radius),
    np.cos: lambda a: _bent(np.cos(a.middle), np.sin(a.middle), a.radius),
}


def balls(middle: np.ndarray, radius: np.ndarray) -> list[Scalar]:
    """Rows (k, N) as scalars: rows of zeros fold away."""
    return [
        0.0 if not (row.any() or size.any()) else Ball(row, size)  # type: ignore[misc]
        for row, size in zip(np.ascontiguousarray(middle), np.ascontiguousarray(radius), strict=True)
    ]


def dense_balls(scalars: Sequence[Scalar], samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Scalars as middles and radii, (count, samples) each."""
    middle, radius = np.zeros((2, len(scalars), samples))
    for k, scalar in enumerate(scalars):
        if isinstance(scalar, Ball):
            middle[k], radius[k] = scalar.middle, scalar.radius
        else:
            middle[k] = scalar
    return middle, radius
