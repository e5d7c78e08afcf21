"""Inner products of all columns, motor by motor; many sets share those of their first columns."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import orth

from bench.identification.bilinear import SharedProducts


@dataclass(frozen=True)
class MotorProducts:
    """Inner products of every motor's [columns, torque, error].

    torque and error: of the present model's solution, and of its current. with_zeros (n, C + 3, C + 3): with one more
    column, of zeros, for sets of different size that are solved together. measured: sum of squares of all currents.
    rows_of_motor (n,): number of rows of each motor.
    """

    with_zeros: np.ndarray
    rows: int
    measured: float
    rows_of_motor: np.ndarray

    @property
    def inner(self) -> np.ndarray:
        """The inner products (n, C + 2, C + 2), without the zeros."""
        return self.with_zeros[:, :-1, :-1]


def summed(parts: Sequence[MotorProducts], size: int, motors: int) -> MotorProducts:
    """The products (motors, size, size) of several recordings; zero without any."""
    return MotorProducts(
        sum((part.with_zeros for part in parts), np.zeros((motors, size, size))),
        sum(part.rows for part in parts),
        sum(part.measured for part in parts),
        sum((part.rows_of_motor for part in parts), np.zeros(motors)),
    )


def products_of_sets(products: MotorProducts, b: int, added: Sequence[np.ndarray], c: int) -> SharedProducts:
    """Products of the first b columns and of each set's added ones (indices), padded to c with zeros."""
    size = products.inner.shape[1]
    picked = np.full((len(added), c + 2), size)  # the column of zeros
    picked[:, -2:] = size - 2, size - 1
    for row, block in zip(picked, added, strict=True):
        row[: len(block)] = block
    inner = products.with_zeros
    across = np.moveaxis(inner[:, :b][:, :, picked], 2, 0)
    block = np.moveaxis(inner[:, picked[:, :, None], picked[:, None, :]], 1, 0)
    base = np.ascontiguousarray(inner[:, :b, :b])
    return SharedProducts(base, np.ascontiguousarray(across), np.ascontiguousarray(block))


@dataclass(frozen=True)
class MotorRows:
    """Rows of one motor in one recording: M rows of some of C columns, and of the torque and error.

    filled (c,): the columns that are not zero there; values (M, c): these; ends (M, 2): torque and error.
    """

    filled: np.ndarray
    values: np.ndarray
    ends: np.ndarray


def motor_rows(columns: Sequence[np.ndarray], ends: np.ndarray) -> MotorRows:
    """The rows of a motor, from columns (M, ...) side by side, and torque and error (M, 2)."""
    every = np.concatenate(columns, axis=1)
    filled = np.flatnonzero(every.any(axis=0))
    return MotorRows(filled, every[:, filled], ends)


def apart_from(rows: MotorRows, columns: Sequence[int]) -> MotorRows:
    """The rows after projecting out some of the columns."""
    selected = rows.values[:, np.isin(rows.filled, columns)]
    basis = orth(selected) if selected.any() else np.zeros((len(selected), 0))
    values, ends = (part - basis @ (basis.T @ part) for part in (rows.values, rows.ends))
    return MotorRows(rows.filled, values, ends)


def folded(triangle: np.ndarray, rows: MotorRows, weight: float) -> np.ndarray:
    """Triangular factor of all columns (C, C), updated with one motor's weighted rows."""
    reduced = weight * np.asarray(np.linalg.qr(rows.values, mode="r"))
    under = np.zeros((len(reduced), triangle.shape[1]))
    under[:, rows.filled] = reduced
    return np.asarray(np.linalg.qr(np.concatenate((triangle, under)), mode="r"))


def products(rows: MotorRows, change: np.ndarray) -> np.ndarray:
    """Inner products (k + 2, k + 2) of columns combined by `change` (C, k), torque and error."""
    changed = np.concatenate((rows.values @ change[rows.filled], rows.ends), axis=1)
    return np.asarray(changed.T @ changed)


def combined(rows: MotorRows, values: np.ndarray) -> np.ndarray:
    """Sum (M,) of columns, torque and error, each by its value (C + 2,)."""
    return np.asarray(rows.values @ values[rows.filled] + rows.ends @ values[-2:])
