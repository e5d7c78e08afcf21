"""Effects whose size would mean nothing: so large that they are another name for the model that they are part of."""

from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance
from bench.identification.nonlinear import settled
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import solved_quickly


def beyond_bounds(prepared: Prepared, fit_gains: bool) -> tuple[EffectInstance, ...]:
    """The effects of a settled model with a parameter that its data ask to be at its bound or beyond."""
    if not any(np.isfinite(one.below) for each in prepared.effects for one in each.effect.parameters):
        return ()
    _, solution = solved_quickly(prepared, fit_gains)
    found, at = [], prepared.layout.size - prepared.layout.effects
    for instance in prepared.effects:
        parameters = instance.effect.parameters
        values = solution.theta[at : at + len(parameters)]
        at += len(values)
        if any(abs(value) >= one.below for value, one in zip(values, parameters, strict=True)):
            found.append(instance)
    return tuple(found)


def within_bounds(prepared: Prepared, fit_gains: bool) -> tuple[Prepared, tuple[EffectInstance, ...]]:
    """A settled model, and those of its effects that stay zero, since they cannot be told from the drive gain.

    Where the data ask for such a size, gain and effect grow together without end. The others are settled without it.
    """
    whole = prepared = settled(prepared, fit_gains)
    gone: set[tuple[str, str]] = set()
    while beyond := beyond_bounds(prepared, fit_gains):
        gone |= {_place(one) for one in beyond}
        kept = [one for one in prepared.effects if one not in beyond]
        prepared = settled(with_effects(whole, kept), fit_gains)
    if not gone:
        return whole, ()
    left = {_place(one): one for one in prepared.effects}
    every = [left.get(_place(one)) or _nothing(one) for one in whole.effects]
    outside = tuple(one for one in every if _place(one) in gone)
    return replace(with_effects(prepared, every), settled=True), outside


def columns_of(prepared: Prepared, instances: tuple[EffectInstance, ...]) -> np.ndarray:
    """Where the parameters of some of a model's effects stand among its unknowns."""
    found: list[int] = []
    at = prepared.layout.size - prepared.layout.effects
    for one in prepared.effects:
        size = len(one.effect.parameters)
        found += range(at, at + size) if one in instances else ()
        at += size
    return np.array(found, dtype=int)


def _place(instance: EffectInstance) -> tuple[str, str]:
    return instance.effect.name, instance.place


def _nothing(instance: EffectInstance) -> EffectInstance:
    effect = instance.effect
    return replace(instance, effect=effect.about({one.name: 0.0 for one in effect.parameters}))
