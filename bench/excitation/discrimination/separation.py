"""The part of one model's prediction that another, fitted to old and new data together, cannot imitate."""

from dataclasses import dataclass, replace

import numpy as np

from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.predicted_currents import PlannedMotion, rows_with, tangents
from bench.excitation.discrimination.rival_models import Rival, RivalNoise
from bench.identification.compressed import Stack, stack_observations
from bench.identification.solution import Solution
from bench.identification.standard_errors import jacobian_series, residual_series


@dataclass(frozen=True)
class Question:
    """Would data of a machine like `truth` contradict `other`?

    given (p + 1, p + 1): triangular factor of [Jacobian of `other`, its error for `truth`] on the given data, whitened,
    so that half its squares are nats.
    """

    truth: Rival
    other: Rival
    noise: RivalNoise
    given: np.ndarray

    @property
    def given_nats(self) -> float:
        """Expected log-likelihood difference on the given data alone."""
        return 0.5 * float(np.sum(_remainder(self.given) ** 2))


@dataclass(frozen=True)
class Separation:
    """An answer to a question, for one motion.

    nats: expected log-likelihood difference of given and new data together. residual (M, n): part of the new motion
    that `other` cannot imitate, in deviations of a row's noise, at the times (M,) s. count: equations of the new
    motion, for its duration in a fit to the given data; autocorrelation_time: how many of them count as one.
    """

    nats: float
    residual: np.ndarray
    time: np.ndarray
    count: float
    autocorrelation_time: float


def question(truth: Rival, other: Rival, noise: RivalNoise) -> Question:
    """Ask it; both models were fitted to the same rows."""
    modelled = (truth.stack.phi @ truth.solution.theta + truth.stack.kappa) / truth.solution.gains
    stack = replace(other.stack, current=modelled * other.stack.moving)
    curved = tangents(other, other.prepared.signals, other.prepared.settings.decimation)
    rows = _rows(stack, other.solution, curved, noise.weights)
    rows_as_one = max(1.0, noise.autocorrelation_time * noise.row_rate)
    return Question(truth, other, noise, np.asarray(np.linalg.qr(rows / np.sqrt(rows_as_one), mode="r")))


def separation(asked: Question, plan: PlannedMotion, current: np.ndarray) -> Separation:
    """What the planned motion adds; current (N, n): predicted by the truth."""
    other = asked.other
    observation, curved = rows_with(other, plan, current)
    stack = stack_observations([observation], other.prepared.layout, other.prepared.dataset.payloads)
    rows_as_one = max(1.0, asked.noise.autocorrelation_time * plan.row_rate)
    rows = _rows(stack, other.solution, curved, _weights(asked, plan)) / np.sqrt(rows_as_one)
    remainder = _remainder(np.concatenate((asked.given, rows)))
    new = remainder[len(asked.given) :].reshape(stack.current.shape)
    nats = 0.5 * float(np.sum(remainder**2))
    share = asked.noise.row_rate / plan.row_rate
    count = float(stack.moving.sum()) * share
    return Separation(
        nats, new * np.sqrt(rows_as_one), observation.time, count, max(1.0, rows_as_one * share)
    )


def residual_share(asked: Question, plan: PlannedMotion, current: np.ndarray, answer: Separation) -> float:
    """The part that the other model cannot imitate, as a share of the current of the truth's effect."""
    observation, _ = rows_with(asked.truth, plan, current)
    count = sum(len(instance.effect.parameters) for instance in asked.truth.instances)
    columns = observation.effects[:, :, observation.effects.shape[2] - count :]
    values = asked.truth.values[len(asked.truth.values) - count :]
    effect_current = columns @ values / asked.truth.present.gains * observation.moving
    size = float(np.linalg.norm(effect_current * _weights(asked, plan)))
    return float(np.linalg.norm(answer.residual)) / size if size > 0.0 else 0.0


def _weights(asked: Question, plan: PlannedMotion) -> np.ndarray:
    """Inverse noise (n,) of a row: white noise is less in a narrower band."""
    return np.asarray(asked.noise.weights * np.sqrt(asked.noise.row_rate / plan.row_rate))


def _rows(stack: Stack, solution: Solution, curved: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """Weighted rows (M n, p + 1): the Jacobian of the modelled current, and the error."""
    phi = np.concatenate((stack.phi, curved * stack.moving[:, :, None]), axis=2)
    theta = np.append(solution.theta, np.zeros(curved.shape[2]))
    stack, solution = replace(stack, phi=phi), replace(solution, theta=theta)
    columns = (jacobian_series(stack, solution), residual_series(stack, solution)[:, :, None])
    rows = np.concatenate(columns, axis=2) * weights[:, None]
    return np.asarray(rows.reshape(-1, rows.shape[2]))


def _remainder(rows: np.ndarray) -> np.ndarray:
    """Residual (R,) of the last column after the others."""
    columns, right = rows[:, :-1], rows[:, -1]
    norms = np.linalg.norm(columns, axis=0)
    norms[norms == 0.0] = 1.0
    scaled = columns / norms
    return np.asarray(right - scaled @ np.linalg.lstsq(scaled, right, rcond=DISCRIMINATION.dependent)[0])
