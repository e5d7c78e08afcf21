"""Prepared equations solved without deviations, and columns of effects that they do not have."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance
from bench.identification.compressed import Stack, stack_observations
from bench.identification.effect_rows import effect_rows
from bench.identification.essential_parameters import reduced, with_zeros
from bench.identification.fixed_columns import FixedColumns, fits, fixed_columns, stacked_with_fixed
from bench.identification.identifiability_of_effects import identifiable_columns
from bench.identification.prepare import Prepared
from bench.identification.solution import NominalGains, Solution
from bench.identification.solved_from_products import solved_from_products

FIXED = "fixed columns"


def solved_quickly(prepared: Prepared) -> tuple[Stack, Solution]:
    """The current-domain solution of prepared equations, without deviations; zero for what is absorbed."""
    stack = _stacked(prepared)
    kept = identifiable(prepared, stack)
    return stack, solved_with(stack, kept, prepared.gains, prepared.present.gains)


def identifiable(prepared: Prepared, stack: Stack) -> np.ndarray:
    """See `identifiable_columns`; stack: the model's equations, from `solved_quickly`."""
    layout, fixed = prepared.layout, prepared.kept.get(FIXED)
    if fixed is None or not layout.effects:
        return identifiable_columns(stack, layout, prepared.gains)

    def span(columns: np.ndarray, fixed: FixedColumns = fixed) -> np.ndarray:
        indices = np.where(columns < layout.size, columns, columns - layout.effects)
        return fixed.span(indices, stack.factors.shape[1])

    return identifiable_columns(stack, layout, prepared.gains, span)


def _stacked(prepared: Prepared) -> Stack:
    """The equations of a model; what all models of these recordings have is orthogonalised once."""
    parts = prepared.fitted, prepared.layout, prepared.dataset.payloads
    if not prepared.layout.effects:
        return stack_observations(*parts)
    fixed = prepared.kept.get(FIXED)
    if FIXED not in prepared.kept or (fixed is not None and not fits(fixed, *parts)):
        fixed = prepared.kept[FIXED] = fixed_columns(*parts)
    return stack_observations(*parts) if fixed is None else stacked_with_fixed(fixed, prepared.fitted)


def solved_with(stack: Stack, kept: np.ndarray, gains: NominalGains, near: np.ndarray) -> Solution:
    """The current-domain solution with some columns of phi only, kept (k,); zero for the others.

    near (n,): gains to start from, of a model much like this one.
    """
    size = stack.phi.shape[2]
    smaller = stack if len(kept) == size else reduced(stack, kept)
    solution = solved_from_products(smaller, gains, near)
    return replace(solution, theta=with_zeros(solution.theta, kept, size))


def spread(stack: Stack, solution: Solution) -> np.ndarray:
    """RMS of each motor's error (n,), in drive units."""
    error = stack.current - (stack.phi @ solution.theta + stack.kappa) / solution.gains
    return np.sqrt((error**2 * stack.moving).sum(axis=0) / np.maximum(stack.moving.sum(axis=0), 1))


def linearised(instances: Sequence[EffectInstance], values: np.ndarray) -> tuple[EffectInstance, ...]:
    """The effects linearised about these values (k,) of their parameters, one after the other."""
    linear, at = [], 0
    for instance in instances:
        names = [parameter.name for parameter in instance.effect.parameters]
        shape_values = dict(zip(names, values[at : at + len(names)].tolist(), strict=True))
        linear.append(replace(instance, effect=instance.effect.about(shape_values)))
        at += len(names)
    return tuple(linear)


def reshaped(instance: EffectInstance, values: Mapping[str, float]) -> EffectInstance:
    """The effect with other values of its shape parameters."""
    return replace(instance, effect=replace(instance.effect, **values))


def candidate_columns(prepared: Prepared, effects: Sequence[EffectInstance]) -> np.ndarray:
    """Columns (M, n, k) of effects over all fitted recordings, in the order of the stack."""
    return np.concatenate(
        [
            effect_rows(signals, prepared.settings.decimation, effects)
            for signals, measured in zip(prepared.signals, prepared.measured, strict=True)
            if measured.recording.use == "identify"
        ]
    )
