"""Inner products of many sets of columns that have their first ones in common: these stand in them once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.diagnosis.motor_products import MotorProducts
from bench.identification.bilinear import TINY


@dataclass(frozen=True)
class SetProducts:
    """Products of S sets with every motor's [base, added, torque, error]: b columns that all have, c that each has.

    base (n, b, b); across (S, n, b, c + 2): base by a set's added columns; within (S, n, c + 2, c + 2).
    """

    base: np.ndarray
    across: np.ndarray
    within: np.ndarray

    def combined(self, errors: np.ndarray) -> np.ndarray:
        """Inner products (S, n, b + c + 2) of all columns with what errors (S, n, b + c + 2) combine of them."""
        b = self.base.shape[1]
        shared, single = errors[..., :b], errors[..., b:, None]
        result = np.empty(errors.shape)
        result[..., :b] = np.matmul(shared.swapaxes(0, 1), self.base).swapaxes(0, 1)
        result[..., :b] += (self.across @ single)[..., 0]
        result[..., b:] = (shared[..., None, :] @ self.across)[..., 0, :]
        result[..., b:] += (self.within @ single)[..., 0]
        return result

    def weighted(self, shares: np.ndarray) -> np.ndarray:
        """The products of columns (S, b + c, b + c), all motors by their shares (S, n)."""
        sets, n, b, c = self.across.shape
        c -= 2
        result = np.empty((sets, b + c, b + c))
        result[:, :b, :b] = (shares @ self.base.reshape(n, -1)).reshape(sets, b, b)
        cross = (shares[:, None] @ self.across.reshape(sets, n, -1)).reshape(sets, b, c + 2)[..., :c]
        result[:, :b, b:], result[:, b:, :b] = cross, cross.swapaxes(1, 2)
        among = shares[:, None] @ self.within.reshape(sets, n, -1)
        result[:, b:, b:] = among.reshape(sets, c + 2, c + 2)[:, :c, :c]
        return result

    def of_torque(self, start: np.ndarray) -> np.ndarray:
        """Products (S, n, b + c + 2) of all columns with the current that was measured, as torque / start + error."""
        every = np.concatenate((self.across, self.within), axis=2)
        return np.asarray(every[..., -2] / start[:, None] + every[..., -1])

    def some(self, which: np.ndarray) -> "SetProducts":
        """The products of some of the sets, (S,) True or False."""
        return SetProducts(self.base, self.across[which], self.within[which])


def products_of_sets(products: MotorProducts, b: int, added: Sequence[np.ndarray], c: int) -> SetProducts:
    """Products of the first b columns and of each set's added ones (indices), c of them with zeros to fill up."""
    size = products.inner.shape[1]
    picked = np.full((len(added), c + 2), size)  # the column of zeros
    picked[:, -2:] = size - 2, size - 1
    for row, block in zip(picked, added, strict=True):
        row[: len(block)] = block
    inner = products.with_zeros
    across = np.moveaxis(inner[:, :b][:, :, picked], 2, 0)
    block = np.moveaxis(inner[:, picked[:, :, None], picked[:, None, :]], 1, 0)
    base = np.ascontiguousarray(inner[:, :b, :b])
    return SetProducts(base, np.ascontiguousarray(across), np.ascontiguousarray(block))


def squares_of_sets(errors: np.ndarray, combined: np.ndarray) -> np.ndarray:
    """Sums of squares (S, n) of what errors combine, never below what rounding leaves of nothing."""
    return np.asarray(np.maximum(np.einsum("snk,snk->sn", errors, combined), TINY))
