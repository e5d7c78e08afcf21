"""All candidate columns in one system, so that any set of effects is solved in well under a millisecond."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects import EffectInstance
from bench.estimate.current_error import minimised, squared_errors
from bench.estimate.layout import known_rows, regressor_rows
from bench.estimate.observation import Observation, effect_rows
from bench.estimate.prepare import Prepared
from bench.estimate.solution import Solution
from bench.estimate.stack import compress

LONGEST_MEMORY = 60  # rows over which errors may be alike
CONVERGED = 1e-7


@dataclass(frozen=True)
class Candidate:
    """An effect at all the places where it can sit; columns: its places among the system's."""

    name: str
    instances: tuple[EffectInstance, ...]
    columns: np.ndarray


@dataclass(frozen=True)
class Products:
    """Triangular factors (n, r, C + 2) of every motor's [columns, kappa, current]; rows: how many there are."""

    factors: np.ndarray
    rows: int


@dataclass(frozen=True)
class System:
    """The equations of the fitted and of the checked recordings, with the columns of all candidates.

    base: how many columns the present model has. start: its solution, whose weights are one over each motor's
    current error. memory: rows that count as one, since neighbouring errors are alike.
    """

    candidates: tuple[Candidate, ...]
    base: int
    start: Solution
    fitted: Products
    checked: Products
    memory: float

    def columns_of(self, chosen: Sequence[int]) -> np.ndarray:
        """Indices of the base columns and those of the chosen candidates."""
        return np.concatenate([np.arange(self.base), *(self.candidates[i].columns for i in chosen)])


@dataclass(frozen=True)
class SetFit:
    """A set of candidates, solved on the fitted recordings; weighted squares left there and on the checked ones.

    values (k,): coefficients of the set's columns, base first; gains (n,).
    """

    chosen: tuple[int, ...]
    columns: np.ndarray
    values: np.ndarray
    gains: np.ndarray
    fitted: float
    checked: float


def build_system(
    prepared: Prepared, candidates: Sequence[tuple[EffectInstance, ...]], start: Solution
) -> System:
    """Columns of all recordings, compressed; start: the current-domain solution of the present model."""
    listed: list[Candidate] = []
    base = at = prepared.layout.size
    for instances in candidates:
        count = sum(len(one.effect.parameters) for one in instances)
        listed.append(Candidate(instances[0].effect.name, tuple(instances), np.arange(at, at + count)))
        at += count
    every = [one for instances in candidates for one in instances]
    blocks: dict[str, list[np.ndarray]] = {"identify": [], "validate": []}
    for signals, observation in zip(prepared.signals, prepared.observations, strict=True):
        added = effect_rows(signals, prepared.settings.decimation, every)
        blocks[observation.use].append(_rows(prepared, observation, added))
    fitted, checked = (_products(blocks[use]) for use in ("identify", "validate"))
    system = System(tuple(listed), base, start, fitted, checked, 1.0)
    largest = solve_set(system, [i for i, one in enumerate(listed) if not one.instances[0].effect.shape])
    memory = memory_in_rows([_errors(rows, largest, start.weights) for rows in blocks["identify"]])
    return System(system.candidates, base, start, fitted, checked, memory)


def solve_set(system: System, chosen: Sequence[int]) -> SetFit:
    """Least squares of the current's error with the base columns and the chosen candidates."""
    columns = system.columns_of(chosen)
    start, size = system.start, system.fitted.factors.shape[2]
    picked = np.append(columns, [size - 2, size - 1])
    theta = np.concatenate((start.theta, np.zeros(len(columns) - system.base)))
    theta, gains = minimised(
        system.fitted.factors[:, :, picked], theta, start.gains, start.weights, start.gains_fitted, CONVERGED
    )
    squares = start.weights**2
    fitted = squared_errors(system.fitted.factors[:, :, picked], theta, gains) @ squares
    checked = squared_errors(system.checked.factors[:, :, picked], theta, gains) @ squares
    return SetFit(tuple(chosen), columns, theta, gains, float(fitted), float(checked))


def _rows(prepared: Prepared, observation: Observation, added: np.ndarray) -> np.ndarray:
    """[phi, candidates, kappa, current] of one recording, (M, n, C + 2), zero where a joint stands still."""
    phi = regressor_rows(observation, prepared.layout)
    known = known_rows(observation, prepared.dataset.payloads)
    parts = (phi, added, known[:, :, None], observation.current[:, :, None])
    return np.concatenate(parts, axis=2) * observation.moving[:, :, None]


def _products(blocks: Sequence[np.ndarray]) -> Products:
    rows = np.concatenate(blocks)
    factors = compress(rows[:, :, :-2], rows[:, :, -2], rows[:, :, -1])
    return Products(factors, int(np.any(rows != 0.0, axis=2).sum()))


def _errors(rows: np.ndarray, fit: SetFit, weights: np.ndarray) -> np.ndarray:
    """Weighted current errors (M, n) of one recording."""
    modelled = (rows[:, :, fit.columns] @ fit.values + rows[:, :, -2]) / fit.gains
    return np.asarray((rows[:, :, -1] - modelled) * weights)


def memory_in_rows(errors: Sequence[np.ndarray]) -> float:
    """Integrated autocorrelation time of the errors (M, n) of all recordings, in rows, at least one.

    Lags are summed until the correlation is lost in its own noise (Geyer 1992, initial positive pairs).
    """
    length = min(len(one) for one in errors)
    lags = min(LONGEST_MEMORY, length // 4)
    values = np.array(
        [sum(float((one[: len(one) - lag] * one[lag:]).sum()) for one in errors) for lag in range(lags + 1)]
    )
    correlation = values / values[0]
    total = 1.0
    for lag in range(1, lags, 2):
        pair = correlation[lag] + correlation[lag + 1]
        if pair <= 0.0:
            break
        total += 2.0 * pair
    return max(float(total), 1.0)
