"""All nonlinear parameters of a model together: derivatives, Gauss-Newton steps, deviations."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.effects import Bracket, EffectInstance
from bench.effects.select import parameter_slices
from bench.identification.compressed import Stack, compress, with_known
from bench.identification.decision import RULE
from bench.identification.gauss_newton import beyond
from bench.identification.identifiability_of_effects import with_zeros
from bench.identification.joint_samples import joint_samples
from bench.identification.moved_regressor import machine_derivatives, regressor_change
from bench.identification.partial_regression import torque_errors
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solution import NominalGains, Solution
from bench.identification.solve_only import (
    candidate_columns,
    identifiable,
    linearised,
    reshaped,
    solved_quickly,
    solved_with,
    spread,
    stacked,
)
from bench.identification.tolerances import TOLERANCES


def stepped(
    prepared: Prepared, stack: Stack, solution: Solution, *, trusted: bool = True
) -> tuple[Prepared, Stack, Solution] | None:
    """A Gauss-Newton step of all nonlinear parameters and linear unknowns together; the model is solved there.

    stack, solution: of the present model, from `solved_about` with the same `trusted`. None if there is nothing to move
    or even a small share of the step increases the errors.
    """
    shapes, columns = _shape_derivatives(prepared, solution.theta, stack.current.shape)
    bent, about = _bends(prepared, stack.phi, solution.theta, every=False)
    moves = about.any() or any(instance.effect.changes_machine for instance in prepared.effects)
    if not shapes and not moves:
        return None
    # a changed machine's factors have other rows than the columns that all models share
    kept = identifiable(prepared, stacked(prepared) if len(_columns_of_machine(prepared.effects)) else stack)
    linear = prepared.layout.effect_slice.start
    whole = np.concatenate((np.zeros((*bent.shape[:2], linear)), bent), axis=2)
    system = _linearised(stack, whole, np.append(np.zeros(linear), about), columns)
    added = np.arange(len(shapes)) + prepared.layout.size
    lacks = torque_errors(stack, solution)
    reaches = [_reach(prepared, lacks, i, name) for i, name in shapes]
    held = linear + _columns_of_machine(prepared.effects)
    furthest = _furthest(prepared)
    free, ends = np.append(kept, added), {k: about[k - linear] for k in np.setdiff1d(held, kept).tolist()}
    while True:  # the others stay at the end of their range
        at = np.array(list(ends), dtype=int)
        within = with_known(system, at, np.array(list(ends.values())))
        there = solved_with(within, free, prepared.gains, solution.gains)
        theta = there.theta.copy()
        theta[at] = list(ends.values())
        leave = [
            int(column)
            for column, shape, reach in zip(added, shapes, reaches, strict=True)
            if column in free and _leaves(prepared, *shape, *reach, theta[column])
        ]
        far = [int(k) for k, most in zip(held, furthest, strict=True) if k in free and abs(theta[k]) > most]
        if not leave and not far:
            break
        ends |= {k: float(np.sign(theta[k])) * furthest[held == k][0] for k in far}
        free = np.setdiff1d(free, [*leave, *far])
    if not np.isin(added, free).any() and not moves:
        return prepared, stack, solution
    values = theta[linear : prepared.layout.size]
    before = spread(stack, solution)
    if squares_ratio(spread(within, there), before) > 1.0 - TOLERANCES.steps.errors_settled:
        return None
    for share in TOLERANCES.shapes.shares:
        instances = _moved(prepared, shapes, share * theta[added], reaches, about + share * (values - about))
        try:
            regressor_change(replace(prepared, effects=tuple(instances)))  # before all columns, which take longer
            moved = with_effects(prepared, instances, fitted_only=True)
            after = solved_about(moved, trusted=trusted)
        except BenchError:  # out of reach, or singular
            continue
        if squares_ratio(spread(*after), before) <= 1.0 + TOLERANCES.steps.rounding:
            return moved, *after
    return None


def squares_ratio(errors: np.ndarray, before: np.ndarray) -> float:
    """Mean over the motors of their squared errors over those before, from RMS errors (n,) each."""
    ratio = np.divide(errors, before, out=np.ones_like(errors), where=before > 0.0)
    return float((ratio**2).mean())


def solved_about(prepared: Prepared, *, trusted: bool) -> tuple[Stack, Solution]:
    """As `solved_quickly`; effects that change the machine are held at the values about which they are linearised, and
    the regressor is that of the changed machine: the solution does not depend on the present model.

    trusted: the present model is nearly right. Otherwise drive gains are held, too, since those of a wrong machine can
    run away, and the torque of these effects is that of the regressor, not of their more exact columns. Raises
    BenchError if the loops cannot be closed.
    """
    held = _columns_of_machine(prepared.effects)
    if not len(held):
        return solved_quickly(prepared)
    stack, values = stacked(prepared), _values_about(prepared.effects)[held]
    identified = identifiable(prepared, stack)
    changes = regressor_change(prepared)
    at = prepared.layout.effect_slice.start + held
    if changes is not None:
        moving, (change, known) = stack.moving, changes
        more = known - stack.phi[:, :, at] @ values
        phi, kappa = stack.phi + change * moving[:, :, None], stack.kappa + more * moving
        stack = replace(stack, phi=phi, kappa=kappa, factors=compress(phi, kappa, stack.current))
    system = with_known(stack, at, values)
    kept, gains = np.setdiff1d(identified, at), prepared.gains
    near = prepared.present.gains
    if not trusted:
        near = np.where(beyond(near[:, None] / gains.values[:, None], RULE.gain_far), gains.values, near)
        gains = NominalGains(near, fitted=False)
    solution = solved_with(system, kept, gains, near)
    theta = solution.theta.copy()
    theta[at] = values
    return stack, replace(solution, theta=theta, gains_fitted=prepared.gains.fitted)


def _columns_of_machine(effects: Sequence[EffectInstance]) -> np.ndarray:
    """Indices (k,) of the parameters of effects that change the machine, among those of all effects."""
    return np.array(
        [
            k
            for instance, part in parameter_slices(effects)
            if instance.effect.changes_machine
            for k in range(part.start, part.stop)
        ],
        dtype=int,
    )


def _furthest(prepared: Prepared) -> np.ndarray:
    """Range (k,) of every parameter of the effects that change the machine, on either side of zero."""
    return np.array(
        [
            instance.effect.furthest(prepared.model.geometry, instance.joint)
            for instance in prepared.effects
            if instance.effect.changes_machine
            for _ in instance.effect.parameters
        ]
    )


def _values_about(effects: Sequence[EffectInstance]) -> np.ndarray:
    """The values (E,) about which the parameters of effects are linearised, zero for linear ones."""
    known = [(instance.effect.parameters, instance.effect.about_values()) for instance in effects]
    return np.array(
        [about.get(parameter.name, 0.0) for parameters, about in known for parameter in parameters]
    )


def known_values(prepared: Prepared) -> np.ndarray:
    """The present model's values (p,) of the unknowns, zero for effects."""
    layout, present = prepared.layout, prepared.present
    values = np.zeros(layout.size)
    values[: layout.base] = present.base
    for name, index in layout.payloads.items():
        values[layout.payload_slice(name)] = present.payloads[name][index]
    if layout.redundant:
        nominal = [actuator.gain for actuator in prepared.dataset.robot.redundant]
        values[layout.redundant_slice] = present.redundant_gains - np.array(nominal)
    return values


def _moved(
    prepared: Prepared,
    shapes: list[tuple[int, str]],
    steps: np.ndarray,
    reaches: list[tuple[float, float]],
    values: np.ndarray,
) -> list[EffectInstance]:
    """The effects with their shapes changed by steps within their reaches, and linearised about values."""
    about = linearised(prepared.model.geometry, prepared.effects, values)
    instances = [b if a.effect.bends else a for a, b in zip(prepared.effects, about, strict=True)]
    for (i, name), step, (low, high) in zip(shapes, steps, reaches, strict=True):
        value = instances[i].effect.shape_values()[name]
        most = TOLERANCES.shapes.stride * abs(value)
        stepped_to = value + float(np.clip(step, -most, most))
        instances[i] = reshaped(instances[i], {name: min(max(stepped_to, low), high)})
    return instances


def _leaves(prepared: Prepared, i: int, name: str, low: float, high: float, step: float) -> bool:
    """Whether a step would take a shape parameter out of its range from one end."""
    value = prepared.effects[i].effect.shape_values()[name]
    return (step < 0.0 and value <= low) or (step > 0.0 and value >= high)


def _reach(prepared: Prepared, lacks: np.ndarray, i: int, name: str) -> tuple[float, float]:
    """Range of a shape parameter: where it is searched, near its present value.

    lacks (M, n): torque that the model lacks.
    """
    instance = prepared.effects[i]
    parameter = next(shape for shape in instance.effect.shape if shape.name == name)
    value = instance.effect.shape_values()[name]
    brackets = instance.effect.brackets_near(parameter, joint_samples(prepared, instance, lacks))
    return within_reach(value, brackets)


def within_reach(value: float, brackets: Sequence[Bracket]) -> tuple[float, float]:
    """Range of a shape parameter: the searched range, or a little around a value outside it."""
    low, high = min(bracket[0] for bracket in brackets), max(bracket[2] for bracket in brackets)
    if low <= value <= high:
        return low, high
    nearby = TOLERANCES.shapes.nearby
    ends = (value * (1.0 - nearby), value * (1.0 + nearby))
    return min(ends), max(ends)


def with_shape_columns(
    prepared: Prepared, stack: Stack, solution: Solution, kept: np.ndarray
) -> tuple[Stack, Solution]:
    """The system linearised in all parameters: one more column for every continuous shape parameter; if an effect is
    linearised about parameters, the derivatives by these replace its columns, and the regressor is that of the changed
    machine.

    Only for deviations: the new parameters are zero and come last; errors do not change. kept: the layout's columns
    that the stack has.
    """
    size, effects = prepared.layout.size, prepared.layout.effects
    theta = with_zeros(solution.theta, kept, size)
    shapes, columns = _shape_derivatives(prepared, theta, stack.current.shape)
    phi = np.zeros((*stack.current.shape, size))
    phi[:, :, kept] = stack.phi
    bent, about = _bends(prepared, phi, theta, every=True)
    if not shapes and not about.any():
        return stack, solution
    whole = np.concatenate((np.zeros((*bent.shape[:2], size - effects)), bent), axis=2)
    if len(_columns_of_machine(prepared.effects)) and (changes := regressor_change(prepared)) is not None:
        whole += changes[0]
    system = _linearised(stack, whole[:, :, kept], solution.theta, columns)
    return system, replace(solution, theta=np.append(solution.theta, np.zeros(len(shapes))))


def _linearised(stack: Stack, bent: np.ndarray, about: np.ndarray, columns: np.ndarray) -> Stack:
    """The system with `bent` (M, n, p) added to phi, the same modelled torque at theta = about (p,), and further
    columns (M, n, k).
    """
    moving = stack.moving[:, :, None]
    phi, kappa = stack.phi, stack.kappa
    if bent.any():
        phi, kappa = phi + bent * moving, kappa - (bent * moving) @ about
    phi = np.concatenate((phi, columns * moving), axis=2)
    return replace(stack, phi=phi, kappa=kappa, factors=compress(phi, kappa, stack.current))


def _bends(prepared: Prepared, phi: np.ndarray, theta: np.ndarray, *, every: bool) -> tuple[np.ndarray, np.ndarray]:
    """How the effects' torque depends on the values about which columns are linearised.

    (M, n, E): the columns' derivatives by these values, times the values (E,), which come second; zero for linear
    effects, or those linearised about nothing. every: include effects that hardly bend.
    """
    rows = phi.shape[:2]
    about, bent = [np.zeros(0)], [np.zeros((*rows, 0))]
    for instance in prepared.effects:
        known = instance.effect.about_values() if every or instance.effect.bends else {}
        values = np.array([known.get(parameter.name, 0.0) for parameter in instance.effect.parameters])
        about.append(values)
        derivatives = np.zeros((*rows, len(values)))
        if instance.effect.changes_machine:
            bent.append(derivatives)
            continue
        unchanged = candidate_columns(prepared, [instance]) if values.any() else derivatives
        for k, parameter in enumerate(instance.effect.parameters):
            if values[k]:
                value = values[k] * (1.0 + TOLERANCES.shapes.difference)
                there = replace(instance, effect=instance.effect.about(known | {parameter.name: value}))
                derivatives[:, :, k] = (
                    (candidate_columns(prepared, [there]) - unchanged) @ values / (value - values[k])
                )
        bent.append(derivatives)
    bends= np.concatenate(bent, axis=2)
    if len(held := _columns_of_machine(prepared.effects)):
        at = prepared.layout.effect_slice.start + held
        parameters = [
            (i, k)
            for i, instance in enumerate(prepared.effects)
            if instance.effect.changes_machine
            for k in range(len(instance.effect.parameters))
        ]
        derivatives = machine_derivatives(prepared, theta, parameters)
        moving = np.concatenate([each.moving for each in prepared.fitted])
        bends[:, :, held] = derivatives * moving[:, :, None] - phi[:, :, at]
    return bends, np.concatenate(about)


def _shape_derivatives(
    prepared: Prepared, theta: np.ndarray, rows: tuple[int, ...]
) -> tuple[list[tuple[int, str]], np.ndarray]:
    """Every continuous shape parameter as (effect index, name), and the torque's derivatives (M, n, k) by them.

    theta: all the layout's unknowns; the effects' parameters are the last of them. rows: (M, n).
    """
    shapes: list[tuple[int, str]] = []
    values, steps = [], []
    ends: list[EffectInstance] = []
    of_effects = theta[prepared.layout.effect_slice]
    for i, (instance, part) in enumerate(parameter_slices(prepared.effects)):
        coefficients = of_effects[part]
        for parameter in instance.effect.shape:
            if parameter.discrete:
                continue
            value = instance.effect.shape_values()[parameter.name]
            step = TOLERANCES.shapes.difference * (abs(value) or 1.0)
            ends += [reshaped(instance, {parameter.name: x}) for x in (value - step, value + step)]
            shapes.append((i, parameter.name))
            values.append(coefficients)
            steps.append(step)
    if not shapes:
        return shapes, np.zeros((*rows, 0))
    parts = np.split(
        candidate_columns(prepared, ends), np.cumsum([2 * len(column) for column in values])[:-1], axis=2
    )
    columns = [
        (both[:, :, len(coefficients) :] @ coefficients - both[:, :, : len(coefficients)] @ coefficients)
        / (2.0 * step)
        for both, coefficients, step in zip(parts, values, steps, strict=True)
    ]
    return shapes, np.stack(columns, axis=2)
