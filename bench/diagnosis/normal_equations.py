"""All candidate columns in one system of inner products, so that any set of effects is solved quickly.

The system is formed once. It is relative to the present model's solution, so that forming squares loses no digits; base
columns are orthonormal, and every candidate's column is orthogonal to them and of unit length, so that squares keep the
conditioning. A set then costs a Cholesky factorisation of its number of unknowns, whatever the number of samples.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.evidence import Samples
from bench.diagnosis.motor_products import (
    MotorProducts,
    MotorRows,
    apart_from,
    combined,
    folded,
    motor_rows,
    products,
    summed,
)
from bench.effects import EffectInstance, RobotSignals
from bench.identification.autocorrelation_time import autocorrelation_time, repeats_of
from bench.identification.bilinear import (
    errors_by,
    independent_of,
    least,
    moved_gains,
    normal_equations,
    run_away,
    share_within_reach,
    squares_of,
)
from bench.identification.by_recording import columns_without_value
from bench.identification.decision import RULE
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import forget_motions
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.observation import Observation
from bench.identification.prepare import Prepared
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES


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
    solved: cache of solved sets.
    """

    candidates: tuple[Candidate, ...]
    base: int
    start: Solution
    fitted: MotorProducts
    held_out: MotorProducts
    autocorrelation_time: float
    repeats: float = 1.0
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
        return Samples(fitted, held_out)

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


def build_system(
    prepared: Prepared,
    near: Sequence[RobotSignals],
    candidates: Sequence[Sequence[EffectInstance]],
    exact: Sequence[EffectInstance],
    start: Solution,
    deadline: Deadline = NEVER,
) -> System:
    """The system of a prepared model with its solution `start`; candidates: each an effect at its places, or empty.

    exact: instances with the exact columns of the fit; the others have columns from the signals `near`. Raises
    TimeUpError after the deadline.
    """
    every = [instance for instances in candidates for instance in instances]
    blocks: dict[str, list[tuple[MotorRows, ...]]] = {"identify": [], "validate": []}
    for signals, nearly, observation, measured in zip(
        prepared.signals, near, prepared.observations, prepared.measured, strict=True
    ):
        # passed on without a name, to free each recording's columns and motion after its rows
        rows = _rows(
            prepared,
            observation,
            _added(signals, nearly, prepared.settings.decimation, every, exact, deadline),
            start,
        )
        blocks[observation.use].append(rows)
        for seen in (signals, nearly):
            seen.forget()
        forget_motions((measured,))
    size = prepared.layout.size
    added = sum(len(instance.effect.parameters) for instance in every)
    triangle = _triangle(blocks["identify"], size + added, start)
    change, lengths = _orthonormal(triangle, size)
    base = change.shape[1] - len(lengths)
    listed = []
    at = 0
    for instances in candidates:
        some = np.arange(at, at + sum(len(instance.effect.parameters) for instance in instances))
        listed.append(Candidate(tuple(instances), base + some, lengths[some]))
        at += len(some)
    by_log = _products(prepared, blocks, change)
    fitted, held_out = (
        summed(
            [by_use[use] for by_use in by_log.values() if use in by_use],
            change.shape[1] + 3,
            len(start.gains),
        )
        for use in ("identify", "validate")
    )
    system = System(tuple(listed), base, start, fitted, held_out, 1.0, by_log=by_log)
    plain = [
        i
        for i, candidate in enumerate(listed)
        if candidate.instances and not candidate.instances[0].effect.shape
    ]
    largest = solve_set(system, plain)
    errors = [_errors(values, change, largest, start) for values in blocks["identify"]]
    known = [
        i for i, candidate in enumerate(listed) if any(instance in exact for instance in candidate.instances)
    ]
    wider = solve_set(system, sorted({*plain, *known}))
    residuals = [_errors(values, change, wider, start) for values in blocks["identify"]]
    returns = [observation.course.returns for observation in prepared.fitted]
    return replace(
        system,
        autocorrelation_time=autocorrelation_time(errors),
        repeats=repeats_of(residuals, returns),
        solved={},
    )


def solve_set(system: System, chosen: Sequence[int]) -> SetFit:
    """Least squares of the current's error with the base columns and the chosen candidates."""
    key = tuple(sorted(chosen))
    if key not in system.solved:
        system.solved[key] = _solved(system, key)
    return system.solved[key]


def squared_errors(products: MotorProducts, fit: SetFit, start: Solution) -> np.ndarray:
    """Sum of squares (n,) of every motor's current error with a set's solution."""
    return squares_of(inner_of(products, fit.columns), errors_by(fit.values, fit.gains, start.gains))


def _solved(system: System, chosen: tuple[int, ...]) -> SetFit:
    """Gauss-Newton with step halving, from the best known solution of a smaller set."""
    start, fit_gains = system.start, system.start.gains_fitted
    columns, values, gains = start_of(system, chosen)
    inner = inner_of(system.fitted, columns)
    squares = start.weights**2
    cost = float(squares_of(inner, errors_by(values, gains, start.gains)) @ squares)
    for _ in range(TOLERANCES.steps.most):
        both = least(*normal_equations(inner, values, gains, start.weights, start.gains, fit_gains))
        step, by_gain = (
            both[: len(values)],
            both[len(values) :] if np.any(fit_gains) else np.zeros(len(gains)),
        )
        share = float(share_within_reach(gains, by_gain))
        while share > 1e-6:
            new_values, new_gains = values + share * step, moved_gains(gains, share * by_gain)
            new = float(squares_of(inner, errors_by(new_values, new_gains, start.gains)) @ squares)
            if new <= cost * (1 + 1e-12):
                break
            share /= 2.0
        else:
            break
        converged = bool(has_converged(cost, new, share, new_gains / start.gains))
        values, gains, cost = new_values, new_gains, new
        if converged:
            break
    errors = errors_by(values, gains, start.gains)
    held_out = squares_of(inner_of(system.held_out, columns), errors)
    by_motor = np.stack((squares_of(inner, errors), held_out))
    return fit_of(system, chosen, columns, values, gains, cost, by_motor)


def has_converged(
    cost: np.ndarray | float, new: np.ndarray | float, share: np.ndarray | float, ratio: np.ndarray
) -> np.ndarray:
    """Whether a share of a step lowers the cost too little for another step; ratio (..., n): of the gains."""
    away = run_away(ratio)
    fall = np.subtract(cost, new)
    whole = np.equal(share, 1.0) & (fall <= np.multiply(TOLERANCES.steps.set_converged, cost))
    return np.asarray(whole | (away & (fall <= np.multiply(TOLERANCES.steps.runaway_set_converged, cost))))


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


def _added(
    signals: RobotSignals,
    nearly: RobotSignals,
    decimation: int,
    every: Sequence[EffectInstance],
    exact: Sequence[EffectInstance],
    deadline: Deadline,
) -> np.ndarray:
    """The columns of all candidates in one recording, (M, n, c): see `build_system`."""
    columns = effect_rows(nearly, decimation, every, deadline)
    as_fitted = np.concatenate(
        [
            np.zeros(0, dtype=bool),
            *(np.full(len(instance.effect.parameters), instance in exact) for instance in every),
        ]
    )
    columns[:, :, as_fitted] = effect_rows(
        signals, decimation, [instance for instance in every if instance in exact]
    )
    return columns


def _rows(
    prepared: Prepared, observation: Observation, added: np.ndarray, start: Solution
) -> tuple[MotorRows, ...]:
    """[phi, candidates, torque, error] of one recording at each motor, zero at rest; the columns of values that the
    recording lacks are projected out.
    """
    phi = regressor_rows(observation, prepared.layout)
    torque = phi @ start.theta + known_rows(observation, prepared.dataset.payloads)
    ends = np.stack((torque, observation.current - torque / start.gains), axis=2)
    every = tuple(
        motor_rows((phi[:, j] * moving[:, None], added[:, j] * moving[:, None]), ends[:, j] * moving[:, None])
        for j, moving in enumerate(observation.moving.T)
    )
    suited = [each[0] for each in columns_without_value(prepared, observation)]
    return tuple(apart_from(rows, suited) for rows in every) if suited else every


def _triangle(blocks: Sequence[Sequence[MotorRows]], size: int, start: Solution) -> np.ndarray:
    """Triangular factor of `size` columns, all but torque and error, every motor's rows weighted."""
    triangle = np.zeros((0, size))
    for motors in blocks:
        for rows, weight in zip(motors, start.weights / start.gains, strict=True):
            triangle = folded(triangle, rows, weight)
    return triangle


def _orthonormal(triangle: np.ndarray, p: int) -> tuple[np.ndarray, np.ndarray]:
    """Combination (p + k, b + k) of columns, from their triangular factor: the first b results are orthonormal and span
    the first p columns, the others have unit length and are orthogonal to these.

    Also the lengths (k,) of the last k columns over those of their remainders.
    """
    k = triangle.shape[1] - p
    norms = np.linalg.norm(triangle[:, :p], axis=0)
    norms[norms == 0.0] = 1.0
    _, singular, vectors = np.linalg.svd(triangle[:p, :p] / norms)
    kept = singular > TOLERANCES.rank.columns * singular[0]
    basis = vectors[kept].T / singular[kept] / norms[:, None]
    lengths = np.linalg.norm(triangle[:, p:], axis=0)
    within = basis.T @ triangle[:p, :p].T @ triangle[:p, p:]
    remaining = np.linalg.norm(triangle[:, p:] - triangle[:, :p] @ (basis @ within), axis=0)
    remaining = np.where(remaining > TOLERANCES.rank.candidate * lengths, remaining, 0.0)
    scales = np.divide(1.0, remaining, out=np.zeros(k), where=remaining > 0.0)
    change = np.zeros((p + k, basis.shape[1] + k))
    change[:p, : basis.shape[1]] = basis
    change[:p, basis.shape[1] :] = -basis @ within * scales
    change[p + np.arange(k), basis.shape[1] + np.arange(k)] = scales
    return change, lengths * scales


def _products(
    prepared: Prepared, blocks: Mapping[str, Sequence[Sequence[MotorRows]]], change: np.ndarray
) -> dict[str, dict[str, MotorProducts]]:
    """Products of every log and use, their columns combined by `change`."""
    size = change.shape[1] + 2
    by_log: dict[str, dict[str, MotorProducts]] = {}
    pending = {use: iter(motors) for use, motors in blocks.items()}
    for observation, measured in zip(prepared.observations, prepared.measured, strict=True):
        motors = next(pending[observation.use])
        with_zeros = np.zeros((len(motors), size + 1, size + 1))
        for inner, rows in zip(with_zeros, motors, strict=True):
            inner[:size, :size] = products(rows, change)
        of_motor = observation.moving.sum(axis=0)
        squares = float(((observation.current * observation.moving) ** 2).sum())
        of_recording = MotorProducts(with_zeros, int(of_motor.sum()), squares, of_motor)
        by_use = by_log.setdefault(measured.recording.log, {})
        before = by_use.get(observation.use)
        by_use[observation.use] = (
            of_recording if before is None else summed([before, of_recording], size + 1, len(motors))
        )
    return by_log


def _errors(motors: Sequence[MotorRows], change: np.ndarray, fit: SetFit, start: Solution) -> np.ndarray:
    """Weighted current errors (M, n) of one recording."""
    errors = errors_by(fit.values, fit.gains, start.gains)
    values = np.concatenate((errors[:, :-2] @ change[:, fit.columns].T, errors[:, -2:]), axis=1)
    by_motor = [combined(rows, motor_values) for rows, motor_values in zip(motors, values, strict=True)]
    return np.column_stack(by_motor) * start.weights
