"""Models with a value per recording of an offset or friction that differs from run to run."""

from collections.abc import Collection, Iterator, Mapping, Sequence

import numpy as np

from bench.diagnosis.block_cross_validation import BlockCrossValidation, block_cross_validation
from bench.diagnosis.result import Differing
from bench.effects import Effect, EffectInstance
from bench.effects.select import at_joint, with_value_each
from bench.identification.decision import RULE
from bench.identification.effect_rows import effect_rows
from bench.identification.findings import unlike, with_other_values
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.result import Identification
from bench.identification.solve_only import solved_quickly

Place = tuple[str, str]
"""An effect and its joint."""


def places_of(differs: Sequence[Differing]) -> frozenset[Place]:
    """Places of these."""
    return frozenset((differing.effect, differing.joint) for differing in differs)


def leading(differs: Sequence[Differing]) -> bool:
    """Whether values by recording remove most of a motor's error: effects identified without them may be artefacts."""
    return any(differing.error_after**2 < RULE.most * differing.error_before**2 for differing in differs)


def with_values_by_log(
    start: Prepared, places: Collection[Place], catalogue: Mapping[str, Effect]
) -> Prepared:
    """A starting model with values by recording at these places, in place of one for all; converged."""
    names = {name for name, _ in places}
    kept = [
        at_joint(instance.effect, instance.joint)
        if instance.name in names and not instance.recording
        else instance
        for instance in start.effects
        if instance.seat not in places
    ]
    added = [
        instance
        for name, joint in sorted(places)
        for instance in with_value_each(catalogue[name], joint, start.logs)
    ]
    return converged(with_effects(start, (*kept, *added)))


def values_by_log(model: Prepared, given: Sequence[EffectInstance]) -> tuple[EffectInstance, ...]:
    """The instances of a model with a value for one recording that are not in the starting model (`given`)."""
    there = {instance.key for instance in given}
    return tuple(instance for instance in model.effects if instance.recording and instance.key not in there)


def with_common_values(model: Prepared, given: Sequence[EffectInstance]) -> Prepared:
    """The converged model with one value for all recordings in their place; itself if it has none."""
    per_recording = values_by_log(model, given)
    if not per_recording:
        return model
    kept = [instance for instance in model.effects if instance not in per_recording]
    common = {instance.seat: at_joint(instance.effect, instance.joint) for instance in per_recording}
    return converged(with_effects(model, (*kept, *common.values())))


def explains_more(model: Prepared, other: Prepared) -> bool:
    """Whether a converged model explains clearly more of the fitted recordings than another: each is fitted to every
    other part of each recording and judged on the rest, where values for one recording hold, too.
    """
    of_model, of_other = _cross_validated(model), _cross_validated(other)
    samples = np.minimum(of_model.samples, of_other.samples)
    ratio = (of_other.held_out_squares(()) / of_other.measured) / (
        of_model.held_out_squares(()) / of_model.measured
    )
    return 0.5 * float(samples @ np.log(ratio)) > RULE.prior


def _cross_validated(model: Prepared) -> BlockCrossValidation:
    stack, solution = solved_quickly(model)
    return block_cross_validation(stack, solution, np.zeros((*stack.current.shape, 0)))


def differing_elsewhere(
    model: Prepared, answer: Identification, catalogue: Mapping[str, Effect]
) -> frozenset[Place]:
    """Places at which held-out recordings, modelled far worse than fitted ones, have another value that removes most of
    a motor's error there; without it, no effect can be seen.

    model: with its answer, and without values for each recording at these places.
    """
    if unlike(answer) is None:
        return frozenset()
    varying = [effect for effect in catalogue.values() if effect.varies_by_run]
    places = [(effect, joint) for effect in varying for joint in model.dataset.robot.joints]
    instances = [at_joint(effect, joint) for effect, joint in places]
    before, after = np.zeros(len(places)), np.zeros(len(places))
    motors = {joint: j for j, joint in enumerate(model.dataset.robot.joints)}
    for error, columns in _elsewhere(model, answer, instances):
        for i, (_, joint) in enumerate(places):
            j = motors[joint]
            before[i] += _residual_norm(error[:, j], columns[:, j, :0]) ** 2
            after[i] += _residual_norm(error[:, j], columns[:, j, i : i + 1]) ** 2
    best = {
        joint: min((i for i, place in enumerate(places) if place[1] == joint), key=lambda i: after[i])
        for _, joint in places
    }
    return frozenset(
        (places[i][0].name, joint) for joint, i in best.items() if after[i] < RULE.most * before[i]
    )


def with_elsewhere_noted(
    model: Prepared, answer: Identification, catalogue: Mapping[str, Effect]
) -> Identification:
    """The answer with a finding that different values explain why held-out recordings are modelled worse."""
    places = differing_elsewhere(model, answer, catalogue)
    return (
        with_other_values(answer, [f"{name}:{joint}" for name, joint in sorted(places)]) if places else answer
    )


def worse_elsewhere(
    model: Prepared, answer: Identification, other: Identification, places: Collection[Place]
) -> bool:
    """Whether a model's answer explains clearly less of held-out recordings than another, both with their best values
    at `places` there.
    """
    common = {instance.seat: instance.everywhere() for instance in model.effects if instance.seat in places}
    of_answer, of_other = (
        sum(
            _residual_norm(error.ravel(), columns.reshape(error.size, -1)) ** 2
            for error, columns in _elsewhere(model, each, [*common.values()])
        )
        for each in (answer, other)
    )
    return of_other < (1.0 - RULE.material) ** 2 * of_answer


def _elsewhere(
    model: Prepared, answer: Identification, instances: Sequence[EffectInstance]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """For every held-out recording, the current errors (M, n) and their change by a unit of each effect (M, n, k); none
    for parts of fitted ones, whose values are known.
    """
    gains = np.array([answer.drive_gains[joint].value for joint in answer.joints])
    series = {trace.name: trace for trace in answer.recordings}
    for measured, signals in zip(model.measured, model.signals, strict=True):
        recording = measured.recording
        if recording.use == "identify":
            continue
        trace = series[recording.name]
        torque = effect_rows(signals, model.settings.decimation, instances)
        weight = 0.0 if recording.log in model.logs else 1.0
        columns = weight * torque / gains[:, None] * trace.moving[:, :, None]
        yield trace.error * trace.moving, columns


def _residual_norm(error: np.ndarray, columns: np.ndarray) -> float:
    """Length of an error (M,) outside columns (M, k)."""
    if not columns.any():
        return float(np.linalg.norm(error))
    return float(np.linalg.norm(error - columns @ np.linalg.lstsq(columns, error, rcond=None)[0]))
