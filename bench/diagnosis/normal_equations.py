"""The columns of all candidates in the equations of every recording, as one system of inner products."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.batched_sets import solve_set
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
from bench.diagnosis.system import Candidate, SetFit, System
from bench.effects import EffectInstance, RobotSignals
from bench.identification.autocorrelation_time import autocorrelation_time, repeats_of
from bench.identification.bilinear import errors_by
from bench.identification.by_recording import columns_without_value
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import forget_motions
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.observation import Observation
from bench.identification.prepare import Prepared
from bench.identification.solution import Solution
from bench.identification.tolerances import TOLERANCES


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
