"""Columns of effects that the model's parameters take up, so that no fit can tell them apart."""

from collections.abc import Callable

import numpy as np

from bench.identification.compressed import Stack
from bench.identification.layout import ParameterLayout
from bench.identification.solution import NominalGains
from bench.identification.tolerances import TOLERANCES


def identifiable_columns(
    stack: Stack,
    layout: ParameterLayout,
    gains: NominalGains,
    span: Callable[[np.ndarray], np.ndarray] | None = None,
) -> np.ndarray:
    """Indices of the columns of phi without those of effects that depend on the columns before them.

    Those of redundant motors' gains are omitted where gains are known. With unknown gains the torque of the known
    payload, which gives their scale, counts among the columns before: an effect that can imitate it, such as a wrong
    mass of the only payload, would leave none. span: gives an orthonormal basis (n, r, b) of these columns (k,) of the
    motors' factors where it is known.
    """
    p, first = layout.size, layout.size - layout.effects
    kept = list(range(first if np.any(gains.fitted) else first - layout.redundant))
    if not layout.effects:
        return np.array(kept, dtype=int)
    rows = stack.factors.reshape(-1, p + 2)
    base_columns = np.array([*kept, p] if np.any(gains.fitted) else kept, dtype=int)
    basis = orthonormal(rows[:, base_columns]) if span is None else span(base_columns).reshape(len(rows), -1)
    scale = np.linalg.norm(rows[:, :first], axis=0).max(initial=0.0)
    if _all_independent(rows[:, first:p], basis, TOLERANCES.rank.torque * scale):
        return np.array([*kept, *range(first, p)])
    for index in range(first, p):
        column = rows[:, index]
        size = float(np.linalg.norm(column))
        if size <= TOLERANCES.rank.torque * scale:
            continue
        orthogonal = column / size
        for _ in range(2):
            orthogonal = orthogonal - basis @ (basis.T @ orthogonal)
        remainder = float(np.linalg.norm(orthogonal))
        if remainder > TOLERANCES.rank.independent:
            kept.append(index)
            basis = np.column_stack((basis, orthogonal / remainder))
    return np.array(kept)


def _all_independent(columns: np.ndarray, basis: np.ndarray, nothing: float) -> bool:
    """Whether every column (R, e) is more than nothing, and leaves enough outside a basis (R, r) and those before it.

    All at once, as the diagonal of their triangular factor has what each leaves.
    """
    sizes = np.linalg.norm(columns, axis=0)
    if sizes.min(initial=np.inf) <= nothing:
        return False
    orthogonal = columns / sizes
    for _ in range(2):
        orthogonal = orthogonal - basis @ (basis.T @ orthogonal)
    triangle = np.asarray(np.linalg.qr(orthogonal, mode="r"))
    return len(triangle) == len(sizes) and bool(
        np.all(np.abs(triangle.diagonal()) > TOLERANCES.rank.independent)
    )


def orthonormal(columns: np.ndarray) -> np.ndarray:
    """An orthonormal basis (R, r) of the span of columns (R, p)."""
    norms = np.linalg.norm(columns, axis=0)
    norms[norms == 0.0] = 1.0
    vectors, singular, _ = np.linalg.svd(columns / norms, full_matrices=False)
    return np.asarray(vectors[:, singular > 1e-12 * singular[0]])
