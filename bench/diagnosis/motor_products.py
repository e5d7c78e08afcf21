"""Inner products of all columns, motor by motor."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class MotorProducts:
    """Inner products of every motor's [columns, torque, error] over so many rows.

    torque and error: what the present model's solution needs, and leaves of the current. with_zeros
    (n, C + 3, C + 3): with one more column, of zeros, for sets of different size that are solved side by side.
    measured: sum of squares of all currents. rows_of_motor (n,): how many of the rows are each motor's.
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
