"""All columns that the page can ask for, motor by motor: the model's, and those of every effect at every place."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.diagnosis.motor_rows import apart_from, motor_rows
from bench.effects import EffectInstance
from bench.identification.by_recording import columns_without_value
from bench.identification.effect_rows import effect_rows
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.perturbations import Nearby
from bench.identification.prepare import Prepared
from bench.page.workbench.diagnosed_model import DiagnosedModel

HARDLY = 1e-8  # of the largest singular value: what shows less is not made larger
NEAR, TOO_NEAR = (
    0.1,
    1e-4,
)  # of an effect's column: what the model's columns leave, where that is carried alone


def set_apart(
    columns: np.ndarray, reference: np.ndarray, weighted: np.ndarray, base_count: int
) -> np.ndarray:
    """Combine columns (M, n, C), the model's `base_count` first, and what a model is by them, `reference` (C,), in
    place.

    weighted (F, n, C): their fitted rows, weighted. The model's columns become orthogonal and of the same size, but
    what the recordings do not show stays small. Of an effect's column near to them only what they leave of it is kept.
    Gives (base_count, C): the model's parameters are this @ coordinates by the new columns; all others are as they
    were.
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

    effects: with shapes, and linearised, as identified; starts: the first column of each, and C. reference (C,): how
    the identified model combines the columns; gains (n,) its drive gains; measured, modelled, error (M, n): currents,
    and what the model leaves of them; columns, modelled and error apart from the value that suits a recording that has
    none of what differs from run to run. moving (M, n). fitted (M,): whether a row is fitted. basis (starts[0], C):
    columns are combined so that they are far from each other; the model's parameters are basis @ the coordinates by
    these, an effect's its coordinates.
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

    def filled(self) -> np.ndarray:
        """Which columns are more than zero at each motor (n, C)."""
        return np.asarray(self.columns.any(axis=0))


def build(model: DiagnosedModel, instances: Sequence[EffectInstance], nearby: Nearby) -> PageSystem:
    """The system of a model with the columns of these effects, the identified ones among them. nearby: of `model`."""
    plain = model.plain
    moving = np.concatenate([observation.moving for observation in plain.observations])
    fitted = np.concatenate(
        [np.full(len(observation.time), observation.use == "identify") for observation in plain.observations]
    )
    known = (
        np.concatenate(
            [known_rows(observation, plain.dataset.payloads) for observation in plain.observations]
        )
        * moving
    )
    current = np.concatenate([observation.current for observation in plain.observations]) * moving
    base_rows = np.concatenate(
        [regressor_rows(observation, plain.layout) for observation in plain.observations]
    )
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
    """Take from columns (M, n, C), modelled currents and errors (M, n) what a separate value accounts for in
    recordings that have none: they are not judged on it.
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
    """Columns (M, n, k) of effects about the identified model; of those not identified as they are seen nearby."""
    complete, decimation = model.complete, model.complete.settings.decimation
    near = nearby.signals(complete.present, complete.signals)
    exact = [instance for instance in instances if instance in model.effects]
    as_fitted = np.concatenate(
        [
            np.zeros(0, bool),
            *(np.full(len(instance.effect.parameters), instance in exact) for instance in instances),
        ]
    )
    rows = []
    for signals, nearly in zip(complete.signals, near, strict=True):
        added = effect_rows(nearly, decimation, instances)
        added[:, :, as_fitted] = effect_rows(signals, decimation, exact)
        rows.append(added)
    return np.concatenate(rows)


def _reference(model: DiagnosedModel, instances: Sequence[EffectInstance], starts: np.ndarray) -> np.ndarray:
    """The identified model by the columns (C,)."""
    theta = model.solution.theta
    reference = np.zeros(starts[-1])
    at = base_count = int(starts[0])
    reference[:base_count] = theta[:base_count]
    places = [(instance.effect.name, instance.joint) for instance in instances]
    for instance in model.effects:
        count = len(instance.effect.parameters)
        start = starts[places.index((instance.effect.name, instance.joint))]
        reference[start : start + count] = theta[at : at + count]
        at += count
    return reference
