"""Effects whose size would mean nothing: so large that they are another name for the model that they are part of."""

from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance
from bench.identification.nonlinear import converged, present_model
from bench.identification.out_of_bounds import out_of_bounds
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import linearised, solved_quickly
from bench.identification.tolerances import TOLERANCES


def beyond_bounds(prepared: Prepared) -> tuple[EffectInstance, ...]:
    """The effects of a converged model with a parameter that its data ask to be at its bound or beyond.

    So are those whose motor's gain runs away with them: the two grow together, or swing from one linearisation to the
    next and never settle, so that a few more are looked at.
    """
    if not any(
        np.isfinite(parameter.below) for each in prepared.effects for parameter in each.effect.parameters
    ):
        return ()
    before, settled = None, TOLERANCES.steps.gains_at_bounds
    for _ in range(TOLERANCES.steps.linearisations_at_bounds):
        _, solution = solved_quickly(prepared)
        outside = out_of_bounds(prepared, solution)
        if outside or (before is not None and np.allclose(solution.gains, before, rtol=settled, atol=0.0)):
            return outside
        before = solution.gains
        about = linearised(prepared.effects, solution.theta[prepared.layout.size - prepared.layout.effects :])
        prepared = with_effects(prepared, about, present_model(prepared, solution), fitted_only=True)
    return ()


def within_bounds(prepared: Prepared) -> tuple[Prepared, tuple[EffectInstance, ...]]:
    """A converged model, and those of its effects that stay zero, since they cannot be distinguished from the drive
    gain.

    Where the data ask for such a size, gain and effect grow together without end. The others are converged without it.
    """
    whole = prepared = converged(prepared)
    gone: set[tuple[str, str]] = set()
    while beyond := beyond_bounds(prepared):
        gone |= {_place(instance) for instance in beyond}
        kept = [instance for instance in prepared.effects if _place(instance) not in gone]
        prepared = converged(with_effects(whole, kept))
    if not gone:
        return whole, ()
    remaining = {_place(instance): instance for instance in prepared.effects}
    every = [remaining.get(_place(instance)) or _nothing(instance) for instance in whole.effects]
    outside = tuple(instance for instance in every if _place(instance) in gone)
    return replace(with_effects(prepared, every), converged=True), outside


def columns_of(prepared: Prepared, instances: tuple[EffectInstance, ...]) -> np.ndarray:
    """Where the parameters of some of a model's effects stand among its unknowns."""
    indices: list[int] = []
    at = prepared.layout.size - prepared.layout.effects
    for instance in prepared.effects:
        size = len(instance.effect.parameters)
        indices += range(at, at + size) if instance in instances else ()
        at += size
    return np.array(indices, dtype=int)


def _place(instance: EffectInstance) -> tuple[str, str]:
    return instance.effect.name, instance.place


def _nothing(instance: EffectInstance) -> EffectInstance:
    effect = instance.effect
    return replace(instance, effect=effect.about({parameter.name: 0.0 for parameter in effect.parameters}))
