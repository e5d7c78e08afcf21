"""Columns that depend on each other, combined so that few digits tell them apart."""

import numpy as np

HARDLY = 1e-8  # of the largest singular value: what shows less is not made larger
NEAR, TOO_NEAR = (
    0.1,
    1e-4,
)  # of an effect's column: what the model's columns leave, where that is carried alone


def set_apart(
    columns: np.ndarray, reference: np.ndarray, weighted: np.ndarray, base_count: int
) -> np.ndarray:
    """Combine columns (M, n, C), the model's `base_count` first, and what a model is by them, `reference` (C,), in
    place.

    weighted (F, n, C): their fitted rows, weighted. The model's columns become orthogonal and of the same size, but
    what the recordings do not show stays small. Of an effect's column near to them only what they leave of it is kept.
    Gives (base_count, C): the model's parameters are this @ coordinates by the new columns; all others are as they
    were.
    """
    rows = weighted.reshape(-1, columns.shape[2])
    _, singular, right = np.linalg.svd(np.linalg.qr(rows[:, :base_count], mode="r"), full_matrices=False)
    sizes = np.maximum(singular, HARDLY * singular[0]) if singular[0] > 0.0 else np.ones(len(singular))
    basis = np.zeros((base_count, columns.shape[2]))
    basis[:, :base_count] = right.T / sizes
    columns[:, :, :base_count] = columns[:, :, :base_count] @ basis[:, :base_count]
    reference[:base_count] = (sizes[:, None] * right) @ reference[:base_count]
    shares = (rows[:, :base_count] @ basis[:, :base_count]).T @ rows[:, base_count:]
    squares = (rows[:, base_count:] ** 2).sum(axis=0)
    remaining = np.maximum(squares - (shares**2).sum(axis=0), 0.0)
    near = np.flatnonzero((remaining < NEAR**2 * squares) & (remaining > TOO_NEAR**2 * squares))
    shares, near = shares[:, near], base_count + near
    columns[:, :, near] -= columns[:, :, :base_count] @ shares
    reference[:base_count] += shares @ reference[near]
    basis[:, near] = -basis[:, :base_count] @ shares
    return basis
