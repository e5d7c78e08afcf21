"""Many sets of effects solved side by side, where they are small: what Python adds to each is then shared."""

from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np

from bench.diagnosis.normal_equations import (
    COLLINEAR,
    CONVERGED,
    SetFit,
    System,
    errors_by,
    normal_equations,
    solve_set,
    squares_of,
    start_of,
    with_checked,
)
from bench.identification.solution import Solution

TOGETHER = 4_000_000  # bytes of inner products
FEWEST = 4  # sets: fewer are solved one by one
MOST_STEPS = 10  # of Gauss and Newton: what needs more is solved alone
ROUNDING = 1e-13  # added to a unit diagonal, so that dependent unknowns do not end the work of all


def solve_sets(system: System, sets: Iterable[Sequence[int]]) -> list[SetFit]:
    """As `solve_set` for each, in their order."""
    keys = [tuple(sorted(one)) for one in sets]
    new = sorted({key for key in keys if key not in system.solved}, key=lambda key: (_size(system, key), key))
    for size, group in groupby(new, key=lambda key: _size(system, key)):
        same = list(group)
        most = max(1, TOGETHER // (8 * len(system.start.gains) * (size + 2) ** 2))
        for at in range(0, len(same), most):
            chunk = same[at : at + most]
            if len(chunk) >= FEWEST:
                system.solved.update(_together(system, chunk))
    return [solve_set(system, key) for key in keys]


def _size(system: System, key: tuple[int, ...]) -> int:
    return len(system.columns_of(key))


def _together(system: System, keys: Sequence[tuple[int, ...]]) -> dict[tuple[int, ...], SetFit]:
    """Sets (B of them) of as many columns each by steps of Gauss and Newton; those that need care are left out."""
    start, squares = system.start, system.start.weights**2
    begun = [start_of(system, key) for key in keys]
    columns = np.array([one[0] for one in begun])
    values, gains = (np.array([one[i] for one in begun]) for i in (1, 2))
    size = system.fitted.inner.shape[1]
    picked = np.concatenate((columns, np.full((len(keys), 2), [size - 2, size - 1])), axis=1)
    inner = system.fitted.inner[:, picked[:, :, None], picked[:, None, :]].swapaxes(0, 1)
    cost = squares_of(inner, errors_by(values, gains, start.gains)) @ squares
    regular, settled = np.ones(len(keys), dtype=bool), np.zeros(len(keys), dtype=bool)
    for _ in range(MOST_STEPS):
        try:
            step, by_gain, sound = _steps(inner, values, gains, start)
        except np.linalg.LinAlgError:  # one of them is beyond what rounding allows: each alone is told which
            return {}
        share = 1.0 / np.maximum(1.0, 2.0 * np.abs(by_gain / gains).max(axis=1))
        share[settled | ~regular] = 0.0
        values, gains = values + share[:, None] * step, gains + share[:, None] * by_gain
        new = squares_of(inner, errors_by(values, gains, start.gains)) @ squares
        regular &= (sound | settled) & (new <= cost * (1.0 + 1e-12))
        values[~regular], gains[~regular] = 0.0, start.gains  # left to be solved alone
        settled |= (cost - new <= CONVERGED * cost) & (share == 1.0)
        cost = new
        if np.all(settled | ~regular):
            break
    return {
        key: with_checked(system, SetFit(key, columns[i], values[i], gains[i], float(cost[i]), 0.0))
        for i, key in enumerate(keys)
        if settled[i] and regular[i]
    }


def _steps(
    inner: np.ndarray, values: np.ndarray, gains: np.ndarray, start: Solution
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps of values (B, k) and gains (B, n), and whether the unknowns of a set are independent (B,)."""
    k = values.shape[1]
    normal, right = normal_equations(inner, values, gains, start)
    diagonal = np.einsum("brr->br", normal)
    lengths = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = normal / (lengths[:, :, None] * lengths[:, None, :])
    scaled += ROUNDING * np.eye(scaled.shape[1])
    sound = np.einsum("brr->br", np.linalg.cholesky(scaled)).min(axis=1) > COLLINEAR
    step = np.linalg.solve(scaled, (right / lengths)[..., None])[..., 0] / lengths
    return step[:, :k], step[:, k:] if start.gains_fitted else np.zeros_like(gains), sound
