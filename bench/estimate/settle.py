"""Effects that are not linear: find their shape parameters, and linearise them about the model they belong to."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar

from bench.effects import EffectInstance
from bench.estimate.current_error import current_error
from bench.estimate.effect_columns import PresentModel
from bench.estimate.least_squares import weighted_least_squares
from bench.estimate.observation import effect_rows
from bench.estimate.partial import PartialRegression, partial_regression
from bench.estimate.prepare import Prepared, with_effects
from bench.estimate.solution import Solution
from bench.estimate.stack import Stack, compress, stack_observations

MOST_ROUNDS = 4
SETTLED = 1e-4  # relative change of gains and shape parameters between rounds
SHAPE_STEP = 1e-3  # relative, for the derivative by a shape parameter


def solved_quickly(prepared: Prepared, fit_gains: bool) -> tuple[Stack, Solution]:
    """The current-domain solution of prepared equations, without deviations."""
    stack = stack_observations(prepared.fitted, prepared.layout, prepared.dataset.payloads)
    start = weighted_least_squares(stack, prepared.dataset.robot.nominal_gains, fit_gains)
    return stack, current_error(stack, start)


def present_model(prepared: Prepared, solution: Solution) -> PresentModel:
    """The solution as effects see it."""
    layout = prepared.layout
    payloads = {}
    for name, declared in prepared.present.declared.items():
        values = declared.copy()
        if name in layout.payloads:
            values[layout.payloads[name]] = solution.theta[layout.payload_slice(name)]
        payloads[name] = values
    base = solution.theta[: layout.base]
    return replace(prepared.present, gains=solution.gains, base=base, payloads=payloads)


def settled(prepared: Prepared, fit_gains: bool) -> Prepared:
    """Shape parameters found and model-dependent columns linearised, in a few rounds; nothing to do without."""
    instances = prepared.effects
    curved = [one for one in instances if one.effect.shape or one.effect.depends_on_model]
    if not curved:
        return prepared
    plain = with_effects(prepared, [one for one in instances if one not in curved])
    present = present_model(plain, solved_quickly(plain, fit_gains)[1])
    before = None
    for _ in range(MOST_ROUNDS):
        instances = _shaped(with_effects(prepared, instances, present), fit_gains)
        prepared = with_effects(prepared, instances, present)
        _, solution = solved_quickly(prepared, fit_gains)
        present = present_model(prepared, solution)
        now = np.array(
            [*solution.gains, *(v for one in instances for v in one.effect.shape_values().values())]
        )
        if before is not None and np.all(np.abs(now - before) <= SETTLED * np.abs(now)):
            break
        before = now
    return with_effects(prepared, instances, present)


def _shaped(prepared: Prepared, fit_gains: bool) -> tuple[EffectInstance, ...]:
    """Every shape parameter in turn at its best value, the others held."""
    instances = list(prepared.effects)
    for i, instance in enumerate(instances):
        if not instance.effect.shape:
            continue
        others = with_effects(prepared, instances[:i] + instances[i + 1 :])
        stack, solution = solved_quickly(others, fit_gains)
        partial = partial_regression(stack, solution)
        instances[i] = best_shape(prepared, instance, partial)
    return tuple(instances)


def best_shape(
    prepared: Prepared, instance: EffectInstance, partial: PartialRegression, refine: bool = True
) -> EffectInstance:
    """The instance with the shape values that explain most of what is left, one parameter after the other."""
    for parameter in instance.effect.shape:

        def unexplained(
            value: float, instance: EffectInstance = instance, name: str = parameter.name
        ) -> float:
            changed = replace(instance, effect=replace(instance.effect, **{name: float(value)}))
            return -partial.explained(candidate_columns(prepared, [changed]))[1]

        values = parameter.candidates
        costs = [unexplained(value) for value in values]
        best = int(np.argmin(costs))
        found = values[best]
        if refine and len(values) > 1:
            low, high = values[max(best - 1, 0)], values[min(best + 1, len(values) - 1)]
            result = minimize_scalar(
                unexplained, bounds=(low, high), method="bounded", options={"xatol": 1e-4 * high}
            )
            found = float(result.x) if result.fun < costs[best] else found
        instance = replace(instance, effect=replace(instance.effect, **{parameter.name: found}))
    return instance


def candidate_columns(prepared: Prepared, effects: Sequence[EffectInstance]) -> np.ndarray:
    """Columns (M, n, k) of effects over all fitted recordings, in the order of the stack."""
    return np.concatenate(
        [
            effect_rows(prepared.model, one, effects, prepared.present)
            for one in prepared.measured
            if one.recording.use == "identify"
        ]
    )


def with_shape_columns(prepared: Prepared, stack: Stack, solution: Solution) -> tuple[Stack, Solution]:
    """The system with one more column for every shape parameter: the torque's derivative by it.

    Only for deviations: the new parameters are zero, and stand after all others.
    """
    columns = []
    at = stack.phi.shape[2] - prepared.layout.effects
    for instance in prepared.effects:
        size = len(instance.effect.parameters)
        values = solution.theta[at : at + size]
        at += size
        for name, value in instance.effect.shape_values().items():
            step = SHAPE_STEP * (abs(value) or 1.0)
            ends = [
                candidate_columns(
                    prepared,
                    [replace(instance, effect=replace(instance.effect, **{name: value + sign * step}))],
                )
                @ values
                for sign in (-1.0, 1.0)
            ]
            columns.append((ends[1] - ends[0]) / (2.0 * step))
    if not columns:
        return stack, solution
    added = np.stack(columns, axis=2) * stack.moving[:, :, None]
    phi = np.concatenate((stack.phi, added), axis=2)
    theta = np.concatenate((solution.theta, np.zeros(len(columns))))
    factors = compress(phi, stack.kappa, stack.current)
    return replace(stack, phi=phi, factors=factors), replace(solution, theta=theta)
