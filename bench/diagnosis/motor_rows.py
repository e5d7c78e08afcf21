"""Equations motor by motor, without the columns that are zero there: most effects have theirs at one motor alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import orth


@dataclass(frozen=True)
class MotorRows:
    """Rows of one motor in one recording: M rows of some of C columns, and of the torque and the error that go with
    them.

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
    """The rows without what some of the columns, in any size, account for."""
    selected = rows.values[:, np.isin(rows.filled, columns)]
    basis = orth(selected) if selected.any() else np.zeros((len(selected), 0))
    values, ends = (part - basis @ (basis.T @ part) for part in (rows.values, rows.ends))
    return MotorRows(rows.filled, values, ends)


def folded(triangle: np.ndarray, rows: MotorRows, weight: float) -> np.ndarray:
    """Triangular factor of all columns (C, C) with one motor's rows, weighted, under those that it has already."""
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
