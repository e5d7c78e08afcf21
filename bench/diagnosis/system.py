"""Sets of effects about one model, in one system of inner products, so that any set is solved quickly.

The system is formed once. It is relative to the present model's solution, so that forming squares loses no digits; base
columns are orthonormal, and every candidate's column is orthogonal to them and of unit length, so that squares keep the
conditioning. A set then costs a Cholesky factorisation of its number of unknowns, whatever the number of samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from bench.diagnosis.evidence import Samples
from bench.diagnosis.motor_products import MotorProducts
from bench.effects import EffectInstance
from bench.identification.bilinear import errors_by, independent_of, squares_of
from bench.identification.decision import RULE
from bench.identification.solution import Solution


@dataclass(frozen=True)
class Candidate:
    """An effect at all its possible places; columns: its indices among the system's. lengths (k,): of its weighted
    columns, which have unit length in the system; zero if the model's columns span it.
    """

    instances: tuple[EffectInstance, ...]
    columns: np.ndarray
    lengths: np.ndarray


@dataclass(frozen=True)
class SetFit:
    """A set of candidates, solved on the fitted recordings; weighted squares of residuals there and on held-out ones.

    values (k,): coefficients of the system's columns, base first, relative to the present solution; gains (n,).
    by_motor (2, n): squares of each motor's error, of fitted and of judged recordings.
    """

    chosen: tuple[int, ...]
    columns: np.ndarray
    values: np.ndarray
    gains: np.ndarray
    fitted: float
    held_out: float
    by_motor: np.ndarray


@dataclass(frozen=True)
class System:
    """The equations of fitted and judged recordings, with the columns of all candidates.

    base: number of independent columns of the present model. start: its solution, whose weights are one over each
    motor's current error. autocorrelation_time: rows that count as one, since neighbouring errors correlate. priors:
    nats that each candidate must bring beyond those of all, zero if empty. by_log: products of every log, by use.
    excess: log(error / floor) at which samples count, see `ErrorFloor`. solved: cache of solved sets.
    """

    candidates: tuple[Candidate, ...]
    base: int
    start: Solution
    fitted: MotorProducts
    held_out: MotorProducts
    autocorrelation_time: float
    repeats: float = 1.0
    excess: float = 0.0
    priors: tuple[float, ...] = ()
    by_log: Mapping[str, Mapping[str, MotorProducts]] = field(default_factory=dict)
    solved: dict[tuple[int, ...], SetFit] = field(default_factory=dict, compare=False, repr=False)

    def prior_of(self, chosen: Sequence[int]) -> float:
        """Nats that the chosen candidates together must bring."""
        return RULE.prior * len(chosen) + (sum(self.priors[i] for i in chosen) if self.priors else 0.0)

    @cached_property
    def samples(self) -> Samples:
        """The independent samples; periods of a motion count together as far as errors return with it."""
        together = self.autocorrelation_time * self.repeats
        fitted, held_out = (part.rows_of_motor / together for part in (self.fitted, self.held_out))
        return Samples(fitted, held_out).beyond(self.excess)

    def columns_of(self, chosen: Sequence[int]) -> np.ndarray:
        """Indices of the base columns and those of the chosen candidates."""
        return np.concatenate([np.arange(self.base), *(self.candidates[i].columns for i in chosen)])

    def independent(self, chosen: Sequence[int]) -> np.ndarray:
        """Indices of `columns_of` that span them all: one effect may contain another."""
        added = self.columns_of(chosen)[self.base :] - self.base
        kept = independent_of(self._among_candidates[np.ix_(added, added)])
        return np.concatenate((np.arange(self.base), self.base + kept))

    @cached_property
    def _among_candidates(self) -> np.ndarray:
        """Inner products of the candidates' columns, weighted as in the present model's solution."""
        share = (self.start.weights / self.start.gains) ** 2
        inner = self.fitted.inner[:, self.base : -2, self.base : -2]
        return np.asarray(np.einsum("j,jrc->rc", share, inner))


def squared_errors(products: MotorProducts, fit: SetFit, start: Solution) -> np.ndarray:
    """Sum of squares (n,) of every motor's current error with a set's solution."""
    return squares_of(inner_of(products, fit.columns), errors_by(fit.values, fit.gains, start.gains))


def start_of(system: System, chosen: tuple[int, ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A set's independent columns (k,), and values (k,) and gains (n,) to start from: the best known of a smaller
    set.
    """
    columns = system.columns_of(chosen)
    columns = columns[system.independent(chosen)]
    values, gains = np.zeros(len(columns)), system.start.gains
    smaller = (system.solved.get(chosen[:i] + chosen[i + 1 :]) for i in range(len(chosen)))
    near = min((fit for fit in smaller if fit is not None), key=lambda fit: fit.fitted, default=None)
    if near is not None:
        every = np.zeros(system.fitted.inner.shape[1])
        every[near.columns] = near.values
        values, gains = every[columns], near.gains
    return columns, values, gains


def inner_of(products: MotorProducts, columns: np.ndarray) -> np.ndarray:
    """Inner products (n, k + 2, k + 2) of some columns (k,), torque and error."""
    size = products.inner.shape[1]
    picked = np.append(columns, [size - 2, size - 1])
    return products.inner[:, picked[:, None], picked]


def fit_of(
    system: System,
    chosen: tuple[int, ...],
    columns: np.ndarray,
    values: np.ndarray,
    gains: np.ndarray,
    cost: float,
    by_motor: np.ndarray,
) -> SetFit:
    """A set with the solution in its independent columns (k,), and the squares (2, n) of its error."""
    every = system.columns_of(chosen)
    whole = np.zeros(system.fitted.inner.shape[1])
    whole[columns] = values
    held_out = float(by_motor[1] @ system.start.weights**2)
    return SetFit(chosen, every, whole[every], gains, cost, held_out, by_motor)
