"""Effects that are not linear: find their shape parameters, and linearise them about the model they belong to."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from scipy.optimize import minimize_scalar

from bench.effects import EffectInstance, JointSamples, ShapeParameter
from bench.estimate.absorbed import identifiable_columns
from bench.estimate.current_error import current_error
from bench.estimate.effect_columns import PresentModel
from bench.estimate.essential import reduced, with_zeros
from bench.estimate.least_squares import weighted_least_squares
from bench.estimate.observation import effect_rows
from bench.estimate.partial import PartialRegression, partial_regression
from bench.estimate.prepare import Prepared, with_effects
from bench.estimate.solution import Solution
from bench.estimate.stack import Stack, compress, stack_observations

MOST_ROUNDS = 4
SETTLED = 1e-4  # relative change of gains and shape parameters between rounds
NEARBY = 0.02  # relative: how far around its present value a shape parameter is searched, beside all else
SHAPE_STEP = 1e-3  # relative, for the derivative by a shape parameter


def solved_quickly(prepared: Prepared, fit_gains: bool) -> tuple[Stack, Solution]:
    """The current-domain solution of prepared equations, without deviations; zero for what is absorbed."""
    stack = stack_observations(prepared.fitted, prepared.layout, prepared.dataset.payloads)
    kept = identifiable_columns(stack, prepared.layout, fit_gains)
    smaller = stack if len(kept) == prepared.layout.size else reduced(stack, kept)
    start = weighted_least_squares(smaller, prepared.dataset.robot.nominal_gains, fit_gains)
    solution = current_error(smaller, start)
    return stack, replace(solution, theta=with_zeros(solution.theta, kept, prepared.layout.size))


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
    effects, at = [], layout.size - layout.effects
    for one in prepared.effects:
        count = len(one.effect.parameters)
        effects.append((one, solution.theta[at : at + count]))
        at += count
    return replace(
        prepared.present, gains=solution.gains, base=base, payloads=payloads, effects=tuple(effects)
    )


def linearised(instances: Sequence[EffectInstance], solution: Solution) -> tuple[EffectInstance, ...]:
    """The effects linearised about their parameters in the solution, where these stand last in theta."""
    at = len(solution.theta) - sum(len(one.effect.parameters) for one in instances)
    found = []
    for one in instances:
        names = [parameter.name for parameter in one.effect.parameters]
        values = dict(zip(names, solution.theta[at : at + len(names)].tolist(), strict=True))
        found.append(replace(one, effect=one.effect.about(values)))
        at += len(names)
    return tuple(found)


def settled(prepared: Prepared, fit_gains: bool) -> Prepared:
    """Shape parameters found and model-dependent columns linearised, in a few rounds; nothing to do without."""
    instances = prepared.effects
    curved = [one for one in instances if one.effect.shape or one.effect.depends_on_model]
    if prepared.settled or not curved:
        return prepared
    plain = with_effects(prepared, [one for one in instances if one not in curved])
    present = present_model(plain, solved_quickly(plain, fit_gains)[1])
    before = None
    for _ in range(MOST_ROUNDS):
        prepared = with_effects(prepared, instances, present)
        instances = _shaped(prepared, fit_gains)
        if instances != prepared.effects:
            prepared = with_effects(prepared, instances)
        _, solution = solved_quickly(prepared, fit_gains)
        present = present_model(prepared, solution)
        instances = linearised(instances, solution)
        shapes = [value for one in instances for value in one.effect.shape_values().values()]
        now = np.array([*solution.gains, *shapes])
        if before is not None and np.all(np.abs(now - before) <= SETTLED * np.abs(now)):
            break
        before = now
    return replace(with_effects(prepared, instances, present), settled=True)


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
    """The instance with the shape values that explain most of what is left.

    Every combination of discrete values is tried, and with each the other parameters, one after the other.
    """
    samples = joint_samples(prepared, instance, partial)
    shape = instance.effect.shape
    free = [parameter for parameter in shape if not parameter.discrete]
    if not free:
        free = list(shape)
    choices = [list(one.candidates) for one in shape if one not in free]
    best, least = instance, np.inf
    for chosen in product(*choices):
        names = [one.name for one in shape if one not in free]
        tried = _changed(instance, dict(zip(names, chosen, strict=True)))
        for parameter in free:
            tried, cost = _searched(prepared, tried, parameter, samples, partial, refine=refine)
        if cost < least:
            best, least = tried, cost
    return best


def _searched(
    prepared: Prepared,
    instance: EffectInstance,
    parameter: ShapeParameter,
    samples: tuple[JointSamples, ...],
    partial: PartialRegression,
    *,
    refine: bool,
) -> tuple[EffectInstance, float]:
    """One shape parameter at its best value, and minus the squares that are explained with it.

    The present value competes, so that what the effect explains never becomes less.
    """

    def unexplained(value: float) -> float:
        changed = _changed(instance, {parameter.name: float(value)})
        return -partial.explained(candidate_columns(prepared, [changed]))[1]

    brackets = instance.effect.brackets(parameter, samples)
    if not parameter.discrete:
        present = instance.effect.shape_values()[parameter.name]
        brackets = (*brackets, (present * (1.0 - NEARBY), present, present * (1.0 + NEARBY)))
    costs = [unexplained(value) for _, value, _ in brackets]
    best = int(np.argmin(costs))
    (low, found, high), cost = brackets[best], costs[best]
    if refine and low < high:
        tolerance = 1e-4 * max(abs(low), abs(high))
        result = minimize_scalar(
            unexplained, bounds=(low, high), method="bounded", options={"xatol": tolerance}
        )
        if result.fun < cost:
            found, cost = float(result.x), float(result.fun)
    return _changed(instance, {parameter.name: found}), cost


def _changed(instance: EffectInstance, values: Mapping[str, float]) -> EffectInstance:
    return replace(instance, effect=replace(instance.effect, **values))


def joint_samples(
    prepared: Prepared, instance: EffectInstance, partial: PartialRegression
) -> tuple[JointSamples, ...]:
    """What an effect at an actuated joint may look at when it looks for its shape; nothing for the others."""
    names = list(prepared.dataset.robot.joints)
    if instance.joint not in names:
        return ()
    j, n = names.index(instance.joint), len(names)
    error = -partial.remainder.reshape(-1, n)[:, j] / partial.weights[j]
    travel = np.ptp(np.concatenate([one.position[:, j] for one in prepared.fitted]))
    found, start = [], 0
    for one in prepared.fitted:
        own = next(seen for seen in prepared.measured if seen.recording.name == one.name)
        found.append(
            JointSamples(
                position=one.position[:, j],
                velocity=one.velocity[:, j],
                motor_torque=one.current[:, j] * prepared.present.gains[j],
                error=error[start : start + len(one.time)] * one.moving[:, j],
                duration=float(own.time[-1] - own.time[0]),
                speed=float(prepared.present.speeds[j]),
                travel=float(travel),
                band=prepared.settings.band(own.recording.rate),
                rotates=prepared.signals[0].joints[instance.joint].rotates,
            )
        )
        start += len(one.time)
    return tuple(found)


def candidate_columns(prepared: Prepared, effects: Sequence[EffectInstance]) -> np.ndarray:
    """Columns (M, n, k) of effects over all fitted recordings, in the order of the stack."""
    return np.concatenate(
        [
            effect_rows(signals, prepared.settings.decimation, effects)
            for signals, measured in zip(prepared.signals, prepared.measured, strict=True)
            if measured.recording.use == "identify"
        ]
    )


def with_shape_columns(
    prepared: Prepared, stack: Stack, solution: Solution, kept: np.ndarray
) -> tuple[Stack, Solution]:
    """The system with one more column for every continuous shape parameter: the torque's derivative by it.

    Only for deviations: the new parameters are zero, and stand after all others. kept: which of the layout's
    columns the stack has.
    """
    columns = []
    theta = with_zeros(solution.theta, kept, prepared.layout.size)
    at = prepared.layout.size - prepared.layout.effects
    for instance in prepared.effects:
        size = len(instance.effect.parameters)
        values = theta[at : at + size]
        at += size
        for parameter in instance.effect.shape:
            if parameter.discrete:
                continue
            name, value = parameter.name, instance.effect.shape_values()[parameter.name]
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
    extended = np.concatenate((solution.theta, np.zeros(len(columns))))
    factors = compress(phi, stack.kappa, stack.current)
    return replace(stack, phi=phi, factors=factors), replace(solution, theta=extended)
