"""Models in which an offset or a friction that differs from run to run has a value for each recording."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.diagnosis.block_cross_validation import BlockCrossValidation, block_cross_validation
from bench.diagnosis.result import Differing
from bench.effects import Effect, EffectInstance
from bench.effects.select import TAG
from bench.identification.decision import RULE
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import solved_quickly

Place = tuple[str, str]
"""An effect and the joint at which it is."""


def places_of(differs: Sequence[Differing]) -> frozenset[Place]:
    """Where what differs is."""
    return frozenset((differing.effect, differing.joint) for differing in differs)


def leading(differs: Sequence[Differing]) -> bool:
    """Whether values for each recording take most of a motor's error away: effects identified without them may be
    theirs.
    """
    return any(differing.error_after**2 < RULE.most * differing.error_before**2 for differing in differs)


def with_values_by_log(
    start: Prepared, places: Collection[Place], catalogue: Mapping[str, Effect]
) -> Prepared:
    """A starting model with a value for each recording of what differs, in place of one for all; converged."""
    names = {name for name, _ in places}
    kept = [
        replace(instance, request=f"{instance.effect.name}:{instance.joint}")
        if instance.effect.name in names and not instance.recording
        else instance
        for instance in start.effects
        if (instance.effect.name, instance.joint) not in places
    ]
    logs = start.logs
    added = [
        EffectInstance(catalogue[name], joint, f"{name}:{joint}{TAG}", log, logs)
        for name, joint in sorted(places)
        for log in logs
    ]
    return converged(with_effects(start, (*kept, *added)))


def values_by_log(model: Prepared, given: Sequence[EffectInstance]) -> tuple[EffectInstance, ...]:
    """The instances of a model with a value for one recording that the starting model (`given`) has not as such."""
    there = {(instance.effect.name, instance.place) for instance in given}
    return tuple(
        instance
        for instance in model.effects
        if instance.recording and (instance.effect.name, instance.place) not in there
    )


def with_common_values(model: Prepared, given: Sequence[EffectInstance]) -> Prepared:
    """The converged model with one value for all recordings in the place of those; itself where it has none."""
    per_recording = values_by_log(model, given)
    if not per_recording:
        return model
    kept = [instance for instance in model.effects if instance not in per_recording]
    common = {
        (instance.effect.name, instance.joint): replace(
            instance.everywhere(), request=f"{instance.effect.name}:{instance.joint}"
        )
        for instance in per_recording
    }
    return converged(with_effects(model, (*kept, *common.values())))


def explains_more(model: Prepared, other: Prepared) -> bool:
    """Whether a converged model clearly explains more of the fitted recordings than another: each is fitted to every
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
