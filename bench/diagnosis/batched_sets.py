"""Many sets of effects solved side by side, where they are small: what Python adds to each is then shared."""

from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from bench.diagnosis.normal_equations import (
    MOST_STEPS,
    SetFit,
    System,
    fit_of,
    has_converged,
    solve_set,
    start_of,
)
from bench.identification.bilinear import (
    COLLINEAR,
    errors_by,
    moved_gains,
    normal_equations,
    share_within_reach,
    squares_of,
)
from bench.identification.solution import Solution

TOGETHER = 4_000_000  # bytes of inner products
FEWEST = 2  # sets: fewer are solved one by one
WIDER = 1.2  # times the unknowns of the smallest set: as many have the largest that is solved beside it
HALVINGS = 8  # of a step: a set that is worse then is solved alone
ROUNDING = 1e-13  # added to a unit diagonal, so that dependent unknowns do not end the work of all


def solve_sets(system: System, sets: Iterable[Sequence[int]]) -> list[SetFit]:
    """As `solve_set` for each, in their order."""
    keys = [tuple(sorted(members)) for members in sets]
    unknown = dict.fromkeys(key for key in keys if key not in system.solved)
    for chunk in _alike(system, sorted((len(system.independent(key)), key) for key in unknown)):
        if len(chunk) >= FEWEST:
            system.solved.update(_together(system, chunk))
    return [solve_set(system, key) for key in keys]


def swapped(chosen: Sequence[int], others: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen with each of the others in the place of each."""
    return [(*(c for c in chosen if c != k), i) for i in others for k in chosen]


def _alike(system: System, sized: Sequence[tuple[int, tuple[int, ...]]]) -> Iterator[list[tuple[int, ...]]]:
    """Sets with about as many unknowns each, the fewest first, and no more than fit into the cache."""
    chunk: list[tuple[int, ...]] = []
    fewest = 0
    for size, key in sized:
        room = TOGETHER // (8 * len(system.start.gains) * (size + 2) ** 2)
        if chunk and (size > WIDER * fewest or len(chunk) >= room):
            yield chunk
            chunk = []
        if not chunk:
            fewest = size
        chunk.append(key)
    if chunk:
        yield chunk


def _together(system: System, keys: Sequence[tuple[int, ...]]) -> dict[tuple[int, ...], SetFit]:
    """Sets by steps of Gauss and Newton, the smaller ones with columns of zeros; those that need care are left out."""
    start, squares = system.start, system.start.weights**2
    begun = [start_of(system, key) for key in keys]
    columns = [pair[0] for pair in begun]
    gains = np.array([pair[2] for pair in begun])
    values = np.zeros((len(keys), max(map(len, columns))))
    for own, (_, found_before, _) in zip(values, begun, strict=True):
        own[: len(found_before)] = found_before
    inner = np.stack([system.fitted.padded(column, values.shape[1]) for column in columns])
    cost = squares_of(inner, errors_by(values, gains, start.gains)) @ squares
    found: dict[tuple[int, ...], SetFit] = {}
    left = np.arange(len(keys))  # which of them are not converged yet
    for _ in range(MOST_STEPS):
        try:
            step, by_gain, sound = _steps(inner, values, gains, start)
        except np.linalg.LinAlgError:  # one of them is beyond what rounding allows: each alone is told which
            break
        share = share_within_reach(gains, by_gain)
        new_values, new_gains, new = _moved(inner, values, gains, cost, (step, by_gain, share), start)
        lower = sound & (new <= cost * (1.0 + 1e-12))
        converged = lower & has_converged(cost, new, share, new_gains / start.gains)
        for i in np.flatnonzero(converged):
            which = int(left[i])
            key, own = keys[which], columns[which]
            found[key] = fit_of(system, key, own, new_values[i, : len(own)], new_gains[i], float(new[i]))
        on = lower & ~converged
        if not on.any():
            break
        inner, values, gains = (
            column if on.all() else column[on] for column in (inner, new_values, new_gains)
        )
        cost, left = new[on], left[on]
    return found


def _moved(
    inner: np.ndarray,
    values: np.ndarray,
    gains: np.ndarray,
    cost: np.ndarray,
    steps: tuple[np.ndarray, np.ndarray, np.ndarray],
    start: Solution,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values, gains and cost (B,) after steps of values, of gains, and the shares (B,) of them that are taken: halved
    in place until no set is worse for it.
    """
    step, by_gain, share = steps
    squares = start.weights**2
    for _ in range(HALVINGS):
        new_values = values + share[:, None] * step
        new_gains = moved_gains(gains, share[:, None] * by_gain)
        new = squares_of(inner, errors_by(new_values, new_gains, start.gains)) @ squares
        worse = new > cost * (1.0 + 1e-12)
        if not worse.any():
            break
        share[worse] /= 2.0
    return new_values, new_gains, new


def _steps(
    inner: np.ndarray, values: np.ndarray, gains: np.ndarray, start: Solution
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps of values (B, k) and gains (B, n), and whether the unknowns of a set are independent (B,)."""
    k = values.shape[1]
    normal, right = normal_equations(inner, values, gains, start.weights, start.gains, start.gains_fitted)
    diagonal = np.einsum("brr->br", normal)
    there = diagonal > 0.0
    lengths = np.sqrt(np.where(there, diagonal, 1.0))
    scaled = normal / (lengths[:, :, None] * lengths[:, None, :])
    scaled += np.where(there, ROUNDING, 1.0)[:, :, None] * np.eye(scaled.shape[1])
    sound = np.einsum("brr->br", np.linalg.cholesky(scaled)).min(axis=1) > COLLINEAR
    step = np.linalg.solve(scaled, (right / lengths)[..., None])[..., 0] / lengths
    return step[:, :k], step[:, k:] if start.gains_fitted else np.zeros_like(gains), sound
