"""Many small sets of effects solved together, which share the overhead of Python."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg.lapack import dposv

from bench.diagnosis.motor_products import SetProducts, products_of_sets, squares_of_sets
from bench.diagnosis.normal_equations import SetFit, System, fit_of, has_converged, solve_set, start_of
from bench.identification.bilinear import errors_by, moved_gains, share_within_reach
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES


def solve_sets(system: System, sets: Iterable[Sequence[int]]) -> list[SetFit]:
    """As `solve_set` for each, in their order."""
    keys = [tuple(sorted(members)) for members in sets]
    unknown = dict.fromkeys(key for key in keys if key not in system.solved)
    for chunk in _alike(system, sorted((len(system.independent(key)), key) for key in unknown)):
        if len(chunk) >= TOLERANCES.search.together:
            system.solved.update(_together(system, chunk))
    return [solve_set(system, key) for key in keys]


def enlarged(chosen: Sequence[int], others: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen ones with each of the others added."""
    return [(*chosen, i) for i in others]


def reduced(chosen: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen without each of them."""
    return [tuple(c for c in chosen if c != k) for k in chosen]


def swapped(chosen: Sequence[int], others: Sequence[int]) -> list[tuple[int, ...]]:
    """The chosen with each of the others in the place of each."""
    return [(*(c for c in chosen if c != k), i) for i in others for k in chosen]


@dataclass(frozen=True)
class _Sets:
    """Sets during iteration: products; values (S, k), gains (S, n) and the coefficients (S, n, k + 2) of their errors,
    all columns' products with these (S, n, k + 2), every motor's squares (S, n), and cost (S,).
    """

    products: SetProducts
    values: np.ndarray
    gains: np.ndarray
    errors: np.ndarray
    by_error: np.ndarray
    squares: np.ndarray
    cost: np.ndarray

    def some(self, which: np.ndarray) -> "_Sets":
        """Some of them (S,) True or False."""
        parts = (self.values, self.gains, self.errors, self.by_error, self.squares, self.cost)
        return _Sets(self.products.some(which), *(part[which] for part in parts))


def _alike(system: System, sized: Sequence[tuple[int, tuple[int, ...]]]) -> Iterator[list[tuple[int, ...]]]:
    """Groups of sets with similar numbers of unknowns, the fewest first, that fit into the cache."""
    chunk: list[tuple[int, ...]] = []
    fewest = 0
    for size, key in sized:
        added = size - system.base + 2
        room = TOLERANCES.memory.set_bytes // (
            8 * (len(system.start.gains) * (size + 2) * added + (size + 2) ** 2)
        )
        if chunk and (size > TOLERANCES.search.together_unknowns * fewest or len(chunk) >= room):
            yield chunk
            chunk = []
        if not chunk:
            fewest = size
        chunk.append(key)
    if chunk:
        yield chunk


def _together(system: System, keys: Sequence[tuple[int, ...]]) -> dict[tuple[int, ...], SetFit]:
    """Sets by Gauss-Newton steps, the smaller ones padded with zero columns; difficult ones are omitted."""
    start = system.start
    begun = [start_of(system, key) for key in keys]
    columns = [pair[0] for pair in begun]
    values = np.zeros((len(keys), max(map(len, columns))))
    for start_values, (_, begun_values, _) in zip(values, begun, strict=True):
        start_values[: len(begun_values)] = begun_values
    added = [column[system.base :] for column in columns]
    wide = values.shape[1] - system.base
    products = products_of_sets(system.fitted, system.base, added, wide)
    now = _at(products, values, np.array([pair[2] for pair in begun]), start)
    results: dict[int, tuple[np.ndarray, np.ndarray, np.ndarray, float]] = {}
    unconverged = np.arange(len(keys))  # which of them are not converged yet
    for _ in range(TOLERANCES.steps.most):
        step, by_gain, sound = _steps(now, start)
        share = share_within_reach(now.gains, by_gain)
        new = _moved(now, (step, by_gain, share), start)
        lower = sound & (new.cost <= now.cost * (1.0 + 1e-12))
        converged = lower & has_converged(now.cost, new.cost, share, new.gains / start.gains)
        for i in np.flatnonzero(converged):
            results[int(unconverged[i])] = new.values[i], new.gains[i], new.squares[i], float(new.cost[i])
        on = lower & ~converged
        if not on.any():
            break
        now, unconverged = (new, unconverged) if on.all() else (new.some(on), unconverged[on])
    if not results:
        return {}
    which = list(results)
    last = _at(
        products_of_sets(system.held_out, system.base, [added[i] for i in which], wide),
        np.array([results[i][0] for i in which]),
        np.array([results[i][1] for i in which]),
        start,
    )
    return {
        keys[i]: fit_of(
            system,
            keys[i],
            columns[i],
            set_values[: len(columns[i])],
            gains,
            cost,
            np.stack((fitted, held_out)),
        )
        for (i, (set_values, gains, fitted, cost)), held_out in zip(
            results.items(), last.squares, strict=True
        )
    }


def _at(products: SetProducts, values: np.ndarray, gains: np.ndarray, start: Solution) -> _Sets:
    errors = errors_by(values, gains, start.gains)
    by_error = products.combined(errors)
    squares = squares_of_sets(errors, by_error)
    return _Sets(products, values, gains, errors, by_error, squares, squares @ start.weights**2)


def _moved(now: _Sets, steps: tuple[np.ndarray, np.ndarray, np.ndarray], start: Solution) -> _Sets:
    """The sets after steps of values and gains, and the shares (S,) of these: halved in place until they make no set
    worse.
    """
    step, by_gain, share = steps
    for _ in range(TOLERANCES.steps.halvings):
        new_gains = moved_gains(now.gains, share[:, None] * by_gain)
        new = _at(now.products, now.values + share[:, None] * step, new_gains, start)
        worse = new.cost > now.cost * (1.0 + 1e-12)
        if not worse.any():
            break
        share[worse] /= 2.0
    return new


def _steps(now: _Sets, start: Solution) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Steps of values (S, k) and gains (S, n), and whether the unknowns of a set are independent (S,).

    The equations are those of `bench.identification.bilinear.normal_equations`.
    """
    k, n = now.values.shape[1], len(start.gains)
    share = start.weights**2 / now.gains
    any_gain = bool(np.any(start.gains_fitted))
    size = k + (n if any_gain else 0)
    normal, right = np.zeros((len(now.cost), size, size)), np.empty((len(now.cost), size))
    normal[:, :k, :k] = now.products.weighted(share / now.gains)
    right[:, :k] = (share[:, None] @ now.by_error[..., :k])[:, 0]
    if any_gain:
        by_torque = now.products.of_torque(start.gains) - now.by_error
        torque = -now.errors[..., : k + 1]
        torque[..., k] = 1.0 / now.gains
        by_torque *= np.reshape(start.gains_fitted, (-1, 1))
        torque *= np.reshape(start.gains_fitted, (-1, 1))
        normal[:, k:, :k] = -(share / now.gains)[..., None] * by_torque[..., :k]
        normal[:, :k, k:] = normal[:, k:, :k].swapaxes(1, 2)
        vector = share / now.gains * np.einsum("snk,snk->sn", torque, by_torque[..., : k + 1])
        normal[:, k + np.arange(n), k + np.arange(n)] = vector
        right[:, k:] = -share * np.einsum("snk,snk->sn", torque, now.by_error[..., : k + 1])
    diagonal = np.einsum("brr->br", normal)
    there = diagonal > 0.0
    lengths = np.sqrt(np.where(there, diagonal, 1.0))
    normal /= lengths[:, :, None]
    normal /= lengths[:, None, :]
    diagonal += np.where(there, TOLERANCES.rank.ridge_of_sets, 1.0)
    right /= lengths
    sound = np.zeros(len(right), dtype=bool)
    for i, (matrix, vector) in enumerate(zip(normal, right, strict=True)):
        factor, solved, wrong = dposv(matrix.T, vector, overwrite_a=True)
        sound[i] = wrong == 0 and np.diag(factor).min() > TOLERANCES.rank.pivot
        vector[:] = solved if sound[i] else 0.0
    right /= lengths
    return right[:, :k], right[:, k:] if any_gain else np.zeros_like(now.gains), sound
