"""Probability of a model given all recordings: one coarsened posterior, for sets of effects and converged models.

No model is exact, so evidence does not grow without bound with the length of a log (Miller and Dunson, "Robust Bayesian
inference via coarsening", Journal of the American Statistical Association 114, 2019): few independent samples of a
motor count in full, many never for more than `DecisionRule.coarsening` samples.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import log

import numpy as np

from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.gauss_newton import run_away
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries, Identification
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import modelled_current


@dataclass(frozen=True)
class Samples:
    """Number of independent samples of each motor, fitted (n,) and judged (n,); and their maximum weight."""

    fitted: np.ndarray
    held_out: np.ndarray
    coarsening: float = field(default_factory=lambda: RULE.coarsening)

    def beyond(self, excess: float) -> "Samples":
        """The samples that count for a model with log(error / noise) = `excess`."""
        return replace(self, coarsening=RULE.coarsening_beyond(excess))

    def log_posterior(
        self, squares: np.ndarray, unknowns: np.ndarray | int, prior: np.ndarray | float
    ) -> np.ndarray:
        """Log weight (...,) of models, from squares (..., 2, n) of motors' errors, fitted and judged.

        With N samples of motor j, fitted, and N' judged, squares R and R', and k unknowns: -1/2 sum_j z_j (N_j log R_j
        + N'_j log R'_j) - 1/2 k log(sum_j z_j N_j) - prior, where z_j = coarsening / (coarsening + N_j + N'_j).
        unknowns, prior (...,): nats that the effects must bring.
        """
        logs = np.log(squares + np.finfo(float).tiny)
        fit = logs[..., 0, :] @ (self._share * self.fitted) + logs[..., 1, :] @ (self._share * self.held_out)
        return np.asarray(-0.5 * fit - self.cost_of_unknowns(unknowns) - prior)

    def cost_of_unknowns(self, unknowns: np.ndarray | int) -> np.ndarray | float:
        """Nats that unknowns (...,) of a model must bring."""
        return 0.5 * unknowns * log(max(float(self._share @ self.fitted), 1.0))

    @cached_property
    def _share(self) -> np.ndarray:
        """Weight of a sample of each motor, z_j."""
        return np.asarray(self.coarsening / (self.coarsening + self.fitted + self.held_out))


@dataclass(frozen=True)
class ResidualSumOfSquares:
    """Squares (2, n) of every motor's error in a converged model, of fitted and judged recordings, drive units squared;
    number of unknowns of its effects, and nats that these must bring; away: whether a gain has run away.
    """

    squares: np.ndarray
    unknowns: int
    prior: float
    away: bool = False

    def weight(self, samples: Samples) -> float:
        """See `Samples.log_posterior`."""
        return float(samples.log_posterior(self.squares, self.unknowns, self.prior))


def residual_squares(model: Prepared, prior: float) -> ResidualSumOfSquares:
    """Residual squares of a converged model; prior: nats that its effects must bring."""
    _, solution = solved_quickly(model)
    squares = _squares(
        (seen.use, (seen.current - modelled_current(model, seen, solution)) * seen.moving)
        for seen in model.observations
    )
    away = bool(run_away(solution.gains / model.dataset.robot.nominal_gains))
    return ResidualSumOfSquares(squares, effects_unknowns(model.effects), prior, away)


def answer_squares(
    effects: Sequence[EffectInstance], series: Sequence[CurrentSeries], prior: float | None = None
) -> ResidualSumOfSquares:
    """Residual squares of a model with these effects, from the currents of its answer. prior: by default the
    catalogue's.
    """
    squares = _squares((trace.use, trace.error * trace.moving) for trace in series)
    return ResidualSumOfSquares(
        squares, effects_unknowns(effects), effects_prior(effects) if prior is None else prior
    )


def _squares(errors: Iterable[tuple[str, np.ndarray]]) -> np.ndarray:
    """Sums of squares (2, n) of errors (M, n) of recordings, each with its use: fitted and judged."""
    parts = [(use, (error**2).sum(axis=0)) for use, error in errors]
    nothing = np.zeros_like(parts[0][1])
    return np.stack(
        [
            sum((products for use, products in parts if use == which), nothing)
            for which in ("identify", "validate")
        ]
    )


def answer_weight(samples: Samples, model: Prepared, answer: Identification) -> float:
    """Log weight of a model with its answer: see `Samples.log_posterior`."""
    return answer_squares(model.effects, answer.recordings).weight(samples)


def effects_unknowns(effects: Iterable[EffectInstance]) -> int:
    """Number of parameters of effects, linear and shape."""
    return sum(len(instance.effect.parameters) + len(instance.effect.shape) for instance in effects)


def effects_prior(effects: Iterable[EffectInstance]) -> float:
    """Nats that effects must bring, each once for all places."""
    return RULE.prior * len({instance.name for instance in effects})
