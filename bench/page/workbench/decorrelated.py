"""Columns that depend on each other, combined so that few digits tell them apart."""

import numpy as np

HARDLY = 1e-8  # of the largest singular value: what shows less is not made larger
NEAR, TOO_NEAR = (
    0.1,
    1e-4,
)  # of an effect's column: what the model's own ones leave, where that is carried alone


def set_apart(columns: np.ndarray, reference: np.ndarray, weighted: np.ndarray, own: int) -> np.ndarray:
    """Combine columns (M, n, C), the model's `own` first, and what a model is by them, `reference` (C,), in place.

    weighted (F, n, C): their fitted rows, weighted. The model's own columns become orthogonal and of the same size, but
    what the recordings do not show stays small. Of an effect's column near to them only what they leave of it is kept.
    Gives (own, C): the model's parameters are this @ coordinates by the new columns; all others are as they were.
    """
    rows = weighted.reshape(-1, columns.shape[2])
    _, singular, right = np.linalg.svd(np.linalg.qr(rows[:, :own], mode="r"), full_matrices=False)
    sizes = np.maximum(singular, HARDLY * singular[0]) if singular[0] > 0.0 else np.ones(len(singular))
    basis = np.zeros((own, columns.shape[2]))
    basis[:, :own] = right.T / sizes
    columns[:, :, :own] = columns[:, :, :own] @ basis[:, :own]
    reference[:own] = (sizes[:, None] * right) @ reference[:own]
    shares = (rows[:, :own] @ basis[:, :own]).T @ rows[:, own:]
    squares = (rows[:, own:] ** 2).sum(axis=0)
    left = np.maximum(squares - (shares**2).sum(axis=0), 0.0)
    near = np.flatnonzero((left < NEAR**2 * squares) & (left > TOO_NEAR**2 * squares))
    shares, near = shares[:, near], own + near
    columns[:, :, near] -= columns[:, :, :own] @ shares
    reference[:own] += shares @ reference[near]
    basis[:, near] = -basis[:, :own] @ shares
    return basis
