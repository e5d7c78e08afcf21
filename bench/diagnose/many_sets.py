"""Many sets of effects solved side by side, where they are small: what Python adds to each is then shared."""

from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np

from bench.diagnose.system import COLLINEAR, CONVERGED, SetFit, System, solve_set, start_of, with_checked

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
    cost = _costs(inner, values, gains, start.gains) @ squares
    regular, settled = np.ones(len(keys), dtype=bool), np.zeros(len(keys), dtype=bool)
    for _ in range(MOST_STEPS):
        try:
            step, by_gain, sound = _steps(inner, values, gains, start.gains, squares, start.gains_fitted)
        except np.linalg.LinAlgError:  # one of them is beyond what rounding allows: each alone is told which
            return {}
        share = 1.0 / np.maximum(1.0, 2.0 * np.abs(by_gain / gains).max(axis=1))
        share[settled | ~regular] = 0.0
        values, gains = values + share[:, None] * step, gains + share[:, None] * by_gain
        new = _costs(inner, values, gains, start.gains) @ squares
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
    inner: np.ndarray,
    values: np.ndarray,
    gains: np.ndarray,
    before: np.ndarray,
    squares: np.ndarray,
    fit_gains: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps of values (B, k) and gains (B, n), and whether the unknowns of a set are independent (B,)."""
    k = values.shape[1]
    share = squares / gains
    by_error = (inner @ _errors(values, gains, before)[..., None])[..., 0]
    right = (share[:, None, :] @ by_error[:, :, :k])[:, 0]
    normal = np.einsum("bj,bjrc->brc", share / gains, inner[:, :, :k, :k])
    if fit_gains:
        torque = np.concatenate(
            (np.repeat(values[:, None], gains.shape[1], axis=1), np.zeros((*gains.shape, 2))), axis=2
        )
        torque[:, :, k] = 1.0
        torque /= gains[:, :, None]
        by_torque = (inner @ torque[..., None])[..., 0]
        across = -(share / gains)[:, :, None] * by_torque[:, :, :k]
        own = np.zeros((*gains.shape, gains.shape[1]))
        own[:, np.arange(gains.shape[1]), np.arange(gains.shape[1])] = (
            share / gains * (torque * by_torque).sum(axis=2)
        )
        normal = np.block([[normal, across.swapaxes(1, 2)], [across, own]])
        right = np.concatenate((right, -share * (torque * by_error).sum(axis=2)), axis=1)
    diagonal = np.einsum("brr->br", normal)
    lengths = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    scaled = normal / (lengths[:, :, None] * lengths[:, None, :])
    scaled += ROUNDING * np.eye(scaled.shape[1])
    sound = np.einsum("brr->br", np.linalg.cholesky(scaled)).min(axis=1) > COLLINEAR
    step = np.linalg.solve(scaled, (right / lengths)[..., None])[..., 0] / lengths
    return step[:, :k], step[:, k:] if fit_gains else np.zeros_like(gains), sound


def _errors(values: np.ndarray, gains: np.ndarray, before: np.ndarray) -> np.ndarray:
    """By what errors are combined from [columns, torque, error]: (B, n, k + 2)."""
    errors = np.ones((*gains.shape, values.shape[1] + 2))
    errors[:, :, :-2] = -values[:, None, :] / gains[:, :, None]
    errors[:, :, -2] = 1.0 / before - 1.0 / gains
    return errors


def _costs(inner: np.ndarray, values: np.ndarray, gains: np.ndarray, before: np.ndarray) -> np.ndarray:
    """Sum of squares (B, n) of every motor's error."""
    errors = _errors(values, gains, before)
    return np.asarray(np.maximum((errors * (inner @ errors[..., None])[..., 0]).sum(axis=2), 0.0))
