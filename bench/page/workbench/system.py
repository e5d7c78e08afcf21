"""All columns that the page may need, motor by motor: the model's, and those of every effect at every place."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnosis.motor_products import apart_from, motor_rows
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.split import with_held_out_parts
from bench.effects import EffectInstance, places_in, select_effects
from bench.effects.select import TAG
from bench.identification.by_recording import columns_without_value
from bench.identification.effect_rows import effect_rows
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.nonlinear import present_model
from bench.identification.perturbations import Nearby
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.solution import Solution
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import ROBOT

HARDLY = 1e-8  # of the largest singular value: directions below it are not scaled to unit size
# bounds of the residual of an effect's column on the model's, relative to the column, that replaces the column
NEAR, TOO_NEAR = 0.1, 1e-4


@dataclass(frozen=True)
class DiagnosedModel:
    """plain: the equations without effects, except those with a value per recording, which the page does not change;
    complete: followed by the identified effects, linearised about the solution; solution: of `complete`, theta in its
    order. started: effects in the model before the diagnosis, as (effect, place).
    """

    plain: Prepared
    complete: Prepared
    solution: Solution
    started: tuple[tuple[str, str], ...]

    @property
    def effects(self) -> tuple[EffectInstance, ...]:
        """The identified effects, without those that the page does not change."""
        return self.complete.effects[len(self.plain.effects) :]

    def nearby(self) -> Nearby:
        """Perturbations about the complete model, computed once for all effects."""
        return Nearby(self.complete.model, self.complete.measured)


def diagnosed_model(problem: Problem, diagnosis: Diagnosis) -> DiagnosedModel:
    """Prepare the equations of a problem's diagnosis again, with its filters and its held-out parts, if any."""
    dataset, _ = with_held_out_parts(problem.dataset)
    problem = replace(problem, dataset=dataset, filters=diagnosis.before.settings)
    before, after, catalogue = diagnosis.before, diagnosis.after, problem.catalogue
    plain = prepare(replace(problem, effects=()))
    places = places_in(plain.model.geometry, problem.dataset.weighed)
    each = [effect for effect in after.effects if effect.endswith(TAG)]
    given = select_effects(each, places, catalogue, plain.logs)
    instances = select_effects(_requests(after, given), places, catalogue)
    given, instances = (
        tuple(_with_values(after, instance) for instance in some) for some in (given, instances)
    )
    gains = np.array([after.drive_gains[joint].value for joint in after.joints])
    extra = plain.dataset.robot.redundant[: plain.layout.redundant]
    changes = [after.drive_gains[actuator.joint].value - actuator.gain for actuator in extra]
    theta = np.array([*(parameter.value for parameter in after.parameters), *changes])
    identified = Solution(theta, gains, np.ones(len(gains)), "current", after.gains_fitted)
    present = present_model(plain, identified)
    plain = with_effects(plain, given, present)
    complete = with_effects(plain, (*given, *instances), present)
    _, solution = solved_quickly(complete)
    # linearised once more about its solution, as identify does
    complete = with_effects(plain, (*given, *instances), present_model(complete, solution))
    _, solution = solved_quickly(complete)
    kept = [effect for effect in before.effects if not effect.endswith(TAG)]
    started = tuple(instance.seat for instance in select_effects(kept, places, catalogue))
    return DiagnosedModel(plain, complete, solution, started)


def _requests(result: Identification, given: Sequence[EffectInstance]) -> list[str]:
    """Names of the identified effects with one value for all recordings. given: the other effects."""
    each = {instance.key for instance in given}
    return [
        name if place == ROBOT else f"{name}:{place}"
        for name, values in result.effect_parameters.items()
        for place in values
        if (name, place) not in each
    ]


def _with_values(result: Identification, instance: EffectInstance) -> EffectInstance:
    values = result.effect_parameters[instance.name][instance.place]
    shapes = {shape.name: values[shape.name].value for shape in instance.effect.shape}
    effect = replace(instance.effect, **shapes) if shapes else instance.effect
    linear = {parameter.name: values[parameter.name].value for parameter in effect.parameters}
    return replace(instance, effect=effect.about(linear))


def set_apart(
    columns: np.ndarray, reference: np.ndarray, weighted: np.ndarray, base_count: int
) -> np.ndarray:
    """Orthogonalise columns (M, n, C), the first `base_count` of which are the model's, in place, and express the
    identified model's coefficients `reference` (C,) in the new columns.

    weighted (F, n, C): their fitted rows, weighted. The model's columns become orthonormal on these, except directions
    that the recordings do not excite, which stay small. An effect's column that is nearly a combination of the model's
    is replaced by its residual. Returns the basis (base_count, C): the model's parameters are basis @ coefficients of
    the new columns; the effects' coefficients are unchanged.
    """
    rows = weighted.reshape(-1, columns.shape[2])
    _, singular, right = np.linalg.svd(np.linalg.qr(rows[:, :base_count], mode="r"), full_matrices=False)
    sizes = np.maximum(singular, HARDLY * singular[0]) if singular[0] > 0.0 else np.ones(len(singular))
    basis = np.zeros((base_count, columns.shape[2]))
    basis[:, :base_count] = right.T / sizes
    columns[:, :, :base_count] = columns[:, :, :base_count] @ basis[:, :base_count]
    reference[:base_count] = (sizes[:, None] * right) @ reference[:base_count]
    shares = (rows[:, :base_count] @ basis[:, :base_count]).T @ rows[:, base_count:]
    squares = (rows[:, base_count:] ** 2).sum(axis=0)
    remaining = np.maximum(squares - (shares**2).sum(axis=0), 0.0)
    near = np.flatnonzero((remaining < NEAR**2 * squares) & (remaining > TOO_NEAR**2 * squares))
    shares, near = shares[:, near], base_count + near
    columns[:, :, near] -= columns[:, :, :base_count] @ shares
    reference[:base_count] += shares @ reference[near]
    basis[:, near] = -basis[:, :base_count] @ shares
    return basis


@dataclass(frozen=True)
class PageSystem:
    """columns (M, n, C) over all recordings, zero where a joint does not move: the model's, then each effect's.

    effects: in the identified shapes and linearisation; starts: index of the first column of each, then C. reference
    (C,): the identified model's coefficients; gains (n,): its drive gains; measured, modelled, error (M, n): currents
    and residual. Of columns, modelled and error, what a separate value would account for is removed in recordings that
    have none. moving (M, n): where a joint moves. fitted (M,): whether a row is fitted. basis (starts[0], C): the
    columns are combined to be well conditioned; the model's parameters are basis @ coefficients, an effect's parameters
    its coefficients.
    """

    columns: np.ndarray
    effects: tuple[EffectInstance, ...]
    starts: tuple[int, ...]
    reference: np.ndarray
    gains: np.ndarray
    measured: np.ndarray
    modelled: np.ndarray
    error: np.ndarray
    moving: np.ndarray
    fitted: np.ndarray
    basis: np.ndarray


def build(model: DiagnosedModel, instances: Sequence[EffectInstance], nearby: Nearby) -> PageSystem:
    """The system of a model with the columns of these effects, including the identified ones. nearby: of `model`."""
    plain = model.plain
    logs, payloads = plain.observations, plain.dataset.payloads
    moving = np.concatenate([log.moving for log in logs])
    fitted = np.concatenate([np.full(len(log.time), log.use == "identify") for log in logs])
    known = np.concatenate([known_rows(log, payloads) for log in logs]) * moving
    current = np.concatenate([log.current for log in logs]) * moving
    base_rows = np.concatenate([regressor_rows(log, plain.layout) for log in logs])
    columns = np.concatenate((base_rows, _added(model, instances, nearby)), axis=2) * moving[:, :, None]
    starts = np.cumsum([base_rows.shape[2], *(len(instance.effect.parameters) for instance in instances)])
    reference = _reference(model, instances, starts)
    modelled = (columns @ reference + known) / model.solution.gains
    error = current - modelled
    _set_apart_from_values(plain, columns, modelled, error)
    basis = set_apart(
        columns, reference, columns[fitted] * model.solution.weights[:, None], base_rows.shape[2]
    )
    return PageSystem(
        columns=columns,
        effects=tuple(instances),
        starts=tuple(int(start) for start in starts),
        reference=reference,
        gains=model.solution.gains,
        measured=current,
        modelled=modelled,
        error=error,
        moving=moving,
        fitted=fitted,
        basis=basis,
    )


def _set_apart_from_values(
    plain: Prepared, columns: np.ndarray, modelled: np.ndarray, error: np.ndarray
) -> None:
    """Remove from columns (M, n, C), modelled currents and errors (M, n), in place, what a separate value would account
    for in recordings that have none, as these are not judged on it.
    """
    at = 0
    for observation in plain.observations:
        rows = slice(at, at := at + len(observation.time))
        suited = [each[0] for each in columns_without_value(plain, observation)]
        for j in range(modelled.shape[1]) if suited else ():
            ends = np.stack((modelled[rows, j], error[rows, j]), axis=1)
            apart = apart_from(motor_rows((columns[rows, j],), ends), suited)
            columns[rows, j, apart.filled] = apart.values
            modelled[rows, j], error[rows, j] = apart.ends.T


def _added(model: DiagnosedModel, instances: Sequence[EffectInstance], nearby: Nearby) -> np.ndarray:
    """Columns (M, n, k) of effects about the identified model; those of effects not identified use `nearby`."""
    complete, decimation = model.complete, model.complete.settings.decimation
    near = nearby.signals(complete.present, complete.signals)
    exact = [instance for instance in instances if instance in model.effects]
    columns = [instance for instance in instances for _ in instance.effect.parameters]
    as_fitted = np.array([instance in exact for instance in columns], dtype=bool)
    rows = []
    for signals, nearly in zip(complete.signals, near, strict=True):
        added = effect_rows(nearly, decimation, instances)
        added[:, :, as_fitted] = effect_rows(signals, decimation, exact)
        rows.append(added)
    return np.concatenate(rows)


def _reference(model: DiagnosedModel, instances: Sequence[EffectInstance], starts: np.ndarray) -> np.ndarray:
    """The coefficients (C,) of the identified model."""
    theta = model.solution.theta
    reference = np.zeros(starts[-1])
    at = base_count = int(starts[0])
    reference[:base_count] = theta[:base_count]
    places = [instance.seat for instance in instances]
    for instance in model.effects:
        count = len(instance.effect.parameters)
        start = starts[places.index(instance.seat)]
        reference[start : start + count] = theta[at : at + count]
        at += count
    return reference
