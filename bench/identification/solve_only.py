"""Solve prepared equations without deviations; columns of effects that they lack.

A search solves thousands of models: every motor's compressed factors are multiplied once, in a basis in which they are
nearly orthonormal. Each start, reweighting and step then needs only sums of these products.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance
from bench.effects.select import parameter_slices
from bench.identification.bilinear import (
    TINY,
    Centred,
    FactorProducts,
    least,
    products_of,
    squares_of,
)
from bench.identification.compressed import Stack, stack_observations
from bench.identification.current_error import current_error, error_weights, from_products, squared_errors
from bench.identification.effect_rows import effect_rows
from bench.identification.fixed_columns import FixedColumns, fits, fixed_columns, stacked_with_fixed
from bench.identification.gauss_newton import run_away
from bench.identification.identifiability_of_effects import identifiable_columns, reduced, with_zeros
from bench.identification.least_squares import weighted_least_squares
from bench.identification.prepare import Prepared
from bench.identification.solution import Fitted, NominalGains, Solution
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Geometry

FIXED = "fixed columns"


def solved_quickly(prepared: Prepared) -> tuple[Stack, Solution]:
    """The current-domain solution of prepared equations, without deviations; zero for absorbed effects."""
    stack = stacked(prepared)
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


def stacked(prepared: Prepared) -> Stack:
    """The equations of a model; columns common to all models are orthogonalised once."""
    parts = prepared.fitted, prepared.layout, prepared.dataset.payloads
    if not prepared.layout.effects:
        return stack_observations(*parts)
    fixed = prepared.kept.get(FIXED)
    if FIXED not in prepared.kept or (fixed is not None and not fits(fixed, *parts)):
        fixed = prepared.kept[FIXED] = fixed_columns(*parts)
    return stack_observations(*parts) if fixed is None else stacked_with_fixed(fixed, prepared.fitted)


def solved_with(stack: Stack, kept: np.ndarray, gains: NominalGains, near: np.ndarray) -> Solution:
    """The current-domain solution with only columns kept (k,) of phi; zero for the others.

    near (n,): gains to start from, of a similar model.
    """
    size = stack.phi.shape[2]
    smaller = stack if len(kept) == size else reduced(stack, kept)
    solution = solved_from_products(smaller, gains, near)
    return replace(solution, theta=with_zeros(solution.theta, kept, size))


def spread(stack: Stack, solution: Solution) -> np.ndarray:
    """RMS of each motor's error (n,), in drive units."""
    error = stack.current - (stack.phi @ solution.theta + stack.kappa) / solution.gains
    return np.sqrt((error**2 * stack.moving).sum(axis=0) / np.maximum(stack.moving.sum(axis=0), 1))


def linearised(
    geometry: Geometry, instances: Sequence[EffectInstance], values: np.ndarray
) -> tuple[EffectInstance, ...]:
    """The effects linearised about these values (k,) of their parameters, one after the other, as far as they are valid
    in a robot of this geometry.
    """
    linear = []
    for instance, part in parameter_slices(instances):
        names = [parameter.name for parameter in instance.effect.parameters]
        furthest = instance.effect.furthest(geometry, instance.joint)
        there = np.clip(values[part], -furthest, furthest).tolist()
        about = instance.effect.about(dict(zip(names, there, strict=True)))
        linear.append(replace(instance, effect=about))
    return tuple(linear)


def reshaped(instance: EffectInstance, values: Mapping[str, float]) -> EffectInstance:
    """The effect with other values of its shape parameters."""
    return replace(instance, effect=replace(instance.effect, **values))


def candidate_columns(prepared: Prepared, effects: Sequence[EffectInstance]) -> np.ndarray:
    """Columns (M, n, k) of effects over all fitted recordings, in the order of the stack."""
    return np.concatenate(
        [effect_rows(signals, prepared.settings.decimation, effects) for signals in prepared.fitted_signals]
    )


def solved_from_products(stack: Stack, gains: NominalGains, near: np.ndarray) -> Solution:
    """The current-domain solution, to far less than any deviation; near (n,): gains of a similar model.

    It starts from weighted least squares with the gains among the unknowns, or held at `near`, whichever leaves less.
    If a gain runs so far from its nominal value that products are too inexact, steps on the factors themselves
    continue.
    """
    near = gains.with_fitted(near)
    solution = _minimum(stack, gains, near)
    if solution is None:
        return _on_factors(stack, gains, near)
    return replace(
        solution, weights=error_weights(stack, squared_errors(stack.factors, solution.theta, solution.gains))
    )


def _minimum(stack: Stack, gains: NominalGains, near: np.ndarray) -> Solution | None:
    lengths = np.linalg.norm(stack.factors[:, :, -1], axis=1)
    scale = 1.0 / np.maximum(np.abs(gains.values) * lengths, TINY)
    products = products_of(stack.factors, scale)
    starts = []
    if np.any(gains.fitted):
        about, values = _held(products, gains.values, lengths)
        about = products.about(about.theta_at(values), gains.values)  # where products are exact enough
        values, first = _weighted(about, lengths, fit_gains=gains.fitted)
        if not run_away(first / gains.values):
            starts.append((about.theta_at(values), first))
    if (not np.any(gains.fitted) or not np.array_equal(near, gains.values)) and not run_away(
        near / gains.values
    ):
        about, values = _held(products, near, lengths)
        starts.append((about.theta_at(values), near))
    if not starts:
        return None
    errors = [squared_errors(stack.factors, *start) for start in starts]
    best = int(np.argmin([_missed(squares) for squares in errors]))
    start = Solution(*starts[best], np.ones(len(near)), "torque", gains.fitted)
    weights = error_weights(stack, errors[best])
    ratio = weights / np.abs(start.gains) / scale
    if ratio.max() > TOLERANCES.steps.scale_ratio * ratio.min():
        products = products_of(stack.factors, weights / start.gains)
    unseen = 2.0 * TOLERANCES.steps.creeping_nats / max(int(stack.moving.sum()), 1)
    minimum = from_products(stack, products, start, weights, unseen=unseen, anew=TOLERANCES.steps.recentred)
    return None if minimum is None or run_away(minimum.gains / gains.values) else minimum


def _on_factors(stack: Stack, gains: NominalGains, near: np.ndarray) -> Solution:
    """The same by steps on the factors themselves; from nominal gains if these leave less than the other starts."""

    def held(at: np.ndarray) -> Solution:
        return replace(
            weighted_least_squares(stack, NominalGains(at, fitted=False)), gains_fitted=gains.fitted
        )

    starts = [weighted_least_squares(stack, gains)]
    if np.any(gains.fitted):
        least = TOLERANCES.rank.square * np.abs(gains.values)
        starts += [] if np.array_equal(near, gains.values) else [held(near)]
        starts = [start for start in starts if not np.any(np.abs(start.gains) < least)] + [held(gains.values)]
    missed = [_missed(squared_errors(stack.factors, start.theta, start.gains)) for start in starts]
    return current_error(stack, starts[int(np.argmin(missed))])


def _missed(squares: np.ndarray) -> float:
    """Size of the motors' current errors in the likelihood, from their squares (n,)."""
    return float(np.log(np.maximum(squares, TINY)).sum())


def _held(products: FactorProducts, gains: np.ndarray, lengths: np.ndarray) -> tuple[Centred, np.ndarray]:
    """The same with held gains (n,): the system about zero parameters, and the values (b,)."""
    about = products.about(np.zeros(len(products.basis)), gains)
    return about, _weighted(about, lengths, fit_gains=False)[0]


def _weighted(about: Centred, lengths: np.ndarray, *, fit_gains: Fitted) -> tuple[np.ndarray, np.ndarray]:
    """Values (b,) and gains (n,) by weighted least squares of torque errors; see `weighted_least_squares`.

    lengths (n,): of the currents.
    """
    start, b, n = about.gains, about.basis.shape[1], len(about.gains)
    some = bool(np.any(fit_gains))
    motors = b + np.arange(n) if some else np.arange(0)
    current = np.zeros((n, b + 2))  # every motor's, of [columns, torque, error]
    current[:, b], current[:, b + 1] = 1.0 / start, 1.0
    by_current = (about.inner @ current[:, :, None])[:, :, 0]
    current_products = (current * by_current).sum(axis=1)
    towards = about.inner[:, :b, b + 1] * start[:, None]
    columns = about.inner[:, :b, :b].reshape(n, -1)
    weights, solution = np.ones(n), np.zeros(b + len(motors))
    normal, right = np.zeros((len(solution), len(solution))), np.zeros(len(solution))
    for remaining in range(TOLERANCES.steps.reweightings, -1, -1):
        squares = weights**2
        normal[:b, :b] = (squares @ columns).reshape(b, b)
        right[:b] = squares @ towards
        if some:
            normal[motors, :b] = -squares[:, None] * by_current[:, :b] * np.reshape(fit_gains, (-1, 1))
            normal[:b, motors] = normal[motors, :b].T
            normal[motors, motors] = np.where(fit_gains, squares * current_products, 1.0)
            right[motors] = -squares * start * by_current[:, b + 1] * fit_gains
        solution = least(normal, right)
        gains = start + solution[b:] if some else start
        if remaining:
            errors = current * (gains - start)[:, None]
            errors[:, :b] -= solution[:b]
            errors[:, b + 1] += start
            size = lengths * np.abs(gains)
            weights = 1.0 / np.maximum(
                np.sqrt(squares_of(about.inner, errors)), TOLERANCES.rank.motor_error * size.max() + TINY
            )
    return solution[:b], gains
