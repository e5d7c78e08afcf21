"""Many sets of effects solved side by side, where they are small: what Python adds to each is then shared."""

from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np

from bench.diagnosis.normal_equations import (
    CONVERGED,
    MOST_STEPS,
    SetFit,
    System,
    fit_of,
    inner_of,
    solve_set,
    start_of,
)
from bench.identification.bilinear import COLLINEAR, errors_by, normal_equations, squares_of
from bench.identification.solution import Solution

TOGETHER = 4_000_000  # bytes of inner products
FEWEST = 4  # sets: fewer are solved one by one
ROUNDING = 1e-13  # added to a unit diagonal, so that dependent unknowns do not end the work of all


def solve_sets(system: System, sets: Iterable[Sequence[int]]) -> list[SetFit]:
    """As `solve_set` for each, in their order."""
    keys = [tuple(sorted(one)) for one in sets]
    unknown = dict.fromkeys(key for key in keys if key not in system.solved)
    new = sorted((len(system.independent(key)), key) for key in unknown)
    for size, group in groupby(new, key=lambda one: one[0]):
        same = [key for _, key in group]
        most = max(1, TOGETHER // (8 * len(system.start.gains) * (size + 2) ** 2))
        for at in range(0, len(same), most):
            chunk = same[at : at + most]
            if len(chunk) >= FEWEST:
                system.solved.update(_together(system, chunk))
    return [solve_set(system, key) for key in keys]


def _together(system: System, keys: Sequence[tuple[int, ...]]) -> dict[tuple[int, ...], SetFit]:
    """Sets of as many independent columns each by steps of Gauss and Newton; those that need care are left out."""
    start, squares = system.start, system.start.weights**2
    begun = [start_of(system, key) for key in keys]
    columns = [one[0] for one in begun]
    values, gains = (np.array([one[i] for one in begun]) for i in (1, 2))
    inner = np.stack([inner_of(system.fitted, one) for one in columns])
    cost = squares_of(inner, errors_by(values, gains, start.gains)) @ squares
    found: dict[tuple[int, ...], SetFit] = {}
    left = np.arange(len(keys))  # which of them are not settled yet
    for _ in range(MOST_STEPS):
        try:
            step, by_gain, sound = _steps(inner, values, gains, start)
        except np.linalg.LinAlgError:  # one of them is beyond what rounding allows: each alone is told which
            break
        share = 1.0 / np.maximum(1.0, 2.0 * np.abs(by_gain / gains).max(axis=1))
        values, gains = values + share[:, None] * step, gains + share[:, None] * by_gain
        new = squares_of(inner, errors_by(values, gains, start.gains)) @ squares
        regular = sound & (new <= cost * (1.0 + 1e-12))
        settled = regular & (cost - new <= CONVERGED * cost) & (share == 1.0)
        for i in np.flatnonzero(settled):
            which = int(left[i])
            key = keys[which]
            found[key] = fit_of(system, key, columns[which], values[i], gains[i], float(new[i]))
        on = regular & ~settled
        if not on.any():
            break
        if not on.all():
            inner, values, gains, new, left = inner[on], values[on], gains[on], new[on], left[on]
        cost = new
    return found


def _steps(
    inner: np.ndarray, values: np.ndarray, gains: np.ndarray, start: Solution
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps of values (B, k) and gains (B, n), and whether the unknowns of a set are independent (B,)."""
    k = values.shape[1]
    normal, right = normal_equations(inner, values, gains, start.weights, start.gains, start.gains_fitted)
    diagonal = np.einsum("brr->br", normal)
    lengths = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = normal / (lengths[:, :, None] * lengths[:, None, :])
    scaled += ROUNDING * np.eye(scaled.shape[1])
    sound = np.einsum("brr->br", np.linalg.cholesky(scaled)).min(axis=1) > COLLINEAR
    step = np.linalg.solve(scaled, (right / lengths)[..., None])[..., 0] / lengths
    return step[:, :k], step[:, k:] if start.gains_fitted else np.zeros_like(gains), sound
