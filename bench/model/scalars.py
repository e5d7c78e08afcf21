"""Arithmetic on scalars: floats if all samples are equal, arrays (N,) if they differ.

A structural zero or one (an axis along z, a planar mechanism, a leg that another leg's motor does not move) is a float
and folds away (0 x = 0, 1 x = x, 0 + x = x): structure costs no time and needs no bookkeeping. Arrays are never changed
once they are returned, so that results may share them.
"""

from collections.abc import Iterable

import numpy as np

from bench.model.bounds import BODIES

Scalar = float | np.ndarray
Rows = np.ndarray | list[Scalar]  # a scalar for each coordinate: an array (k, N), or k scalars
Vector = tuple[Scalar, Scalar, Scalar]
Matrix = tuple[Vector, Vector, Vector]  # by columns: the directions of a frame's axes


def constants(values: Iterable[float]) -> tuple[float, ...]:
    """Constants as floats, with zeros and ones freed of rounding."""
    return tuple(_tidy(float(value)) for value in values)


def constant_vector(values: np.ndarray) -> Vector:
    """A constant (3,)."""
    x, y, z = constants(values)
    return x, y, z


def constant_matrix(values: np.ndarray) -> Matrix:
    """A constant (3, 3), by columns."""
    return constant_vector(values[:, 0]), constant_vector(values[:, 1]), constant_vector(values[:, 2])


def times(a: Scalar, b: Scalar) -> Scalar:
    """Product a b."""
    if isinstance(a, float):
        if a == 0.0:
            return 0.0
        if a == 1.0:
            return b
    if isinstance(b, float):
        if b == 0.0:
            return 0.0
        if b == 1.0:
            return a
    return a * b


def plus(a: Scalar, b: Scalar) -> Scalar:
    """Sum a + b."""
    if isinstance(a, float) and a == 0.0:
        return b
    if isinstance(b, float) and b == 0.0:
        return a
    return a + b


def minus(a: Scalar, b: Scalar) -> Scalar:
    """Difference a - b."""
    if isinstance(b, float) and b == 0.0:
        return a
    if isinstance(a, float) and a == 0.0:
        return -b
    return a - b


def plus_product(c: Scalar, a: Scalar, b: Scalar) -> Scalar:
    """c + a b, in the memory of the product if that is new."""
    product = times(a, b)
    if isinstance(product, float):
        return plus(c, product)
    if isinstance(c, float) and c == 0.0:
        return product
    if product is a or product is b:
        return c + product
    return np.add(c, product, out=product)


def minus_product(c: Scalar, a: Scalar, b: Scalar) -> Scalar:
    """c - a b, in the memory of the product if that is new."""
    product = times(a, b)
    if isinstance(product, float):
        return minus(c, product)
    if product is a or product is b:
        return minus(c, product)
    if isinstance(c, float) and c == 0.0:
        return np.negative(product, out=product)
    return np.subtract(c, product, out=product)


def dot(a: Iterable[Scalar], b: Iterable[Scalar]) -> Scalar:
    """Sum of the products of two sequences of the same length."""
    total: Scalar = 0.0
    for x, y in zip(a, b, strict=True):
        total = plus_product(total, x, y)
    return total


def add(a: Vector, b: Vector) -> Vector:
    """Vector a + b."""
    return plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2])


def subtract(a: Vector, b: Vector) -> Vector:
    """Vector a - b."""
    return minus(a[0], b[0]), minus(a[1], b[1]), minus(a[2], b[2])


def scaled(a: Vector, s: Scalar) -> Vector:
    """Vector s a."""
    return times(a[0], s), times(a[1], s), times(a[2], s)


def cross(a: Vector, b: Vector) -> Vector:
    """Vector a x b."""
    return (
        minus_product(times(a[1], b[2]), a[2], b[1]),
        minus_product(times(a[2], b[0]), a[0], b[2]),
        minus_product(times(a[0], b[1]), a[1], b[0]),
    )


def turned(rotation: Matrix, vector: Vector) -> Vector:
    """Matrix times vector."""
    x, y, z = rotation
    a, b, c = vector
    return (
        _three(x[0], y[0], z[0], a, b, c),
        _three(x[1], y[1], z[1], a, b, c),
        _three(x[2], y[2], z[2], a, b, c),
    )


def turned_back(rotation: Matrix, vector: Vector) -> Vector:
    """Transposed matrix times vector."""
    x, y, z = rotation
    return _three(*x, *vector), _three(*y, *vector), _three(*z, *vector)


def _three(x: Scalar, y: Scalar, z: Scalar, a: Scalar, b: Scalar, c: Scalar) -> Scalar:
    """x a + y b + z c."""
    return plus_product(plus_product(times(x, a), y, b), z, c)


def product(first: Matrix, second: Matrix) -> Matrix:
    """Matrix times matrix."""
    return turned(first, second[0]), turned(first, second[1]), turned(first, second[2])


def dense(scalars: Iterable[Scalar], samples: int) -> np.ndarray:
    """Scalars as an array (count, samples)."""
    listed = list(scalars)
    rows = np.empty((len(listed), samples))
    for row, scalar in zip(rows, listed, strict=True):
        row[:] = scalar
    return rows


def _tidy(value: float) -> float:
    for exact in (0.0, 1.0, -1.0):
        if abs(value - exact) < BODIES.tidy:
            return exact
    return value
