"""All nonlinear parameters of a model together: derivatives, Gauss-Newton steps, deviations."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.effects import Bracket, Effect, EffectInstance
from bench.effects.select import parameter_slices
from bench.identification.compressed import Stack, compress, with_known
from bench.identification.identifiability_of_effects import with_zeros
from bench.identification.joint_samples import joint_samples
from bench.identification.moved_regressor import check_closed, machine_derivatives, regressor_change
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


def stepped(prepared: Prepared, stack: Stack, solution: Solution) -> tuple[Prepared, Stack, Solution] | None:
    """A Gauss-Newton step of all nonlinear parameters and linear unknowns together; the model is solved there.

    stack, solution: of the present model, from `solved_about`. The model itself if a step promises no smaller errors;
    None if there is nothing to move or even a small share of the step increases the errors.
    """
    shapes, columns = _shape_derivatives(prepared, solution.theta, stack.current.shape)
    bent, about = _bends(prepared, stack.phi, solution.theta, every=False)
    machine = _columns_of_machine(prepared.effects)
    moves = about.any() or len(machine)
    if not shapes and not moves:
        return None
    # a changed machine's factors have other rows than the columns that all models share
    kept = identifiable(prepared, stacked(prepared) if len(machine) else stack)
    linear = prepared.layout.effect_slice.start
    whole = np.concatenate((np.zeros((*bent.shape[:2], linear)), bent), axis=2)
    system = _linearised(stack, whole, np.append(np.zeros(linear), about), columns)
    added = np.arange(len(shapes)) + prepared.layout.size
    lacks = torque_errors(stack, solution)
    reaches = [_reach(prepared, lacks, i, name) for i, name in shapes]
    ranges = _ranges(prepared, shapes, reaches)
    fixed = {k: about[k - linear] for k in np.setdiff1d(linear + machine, kept)}
    theta, promised = _within(system, np.append(kept, added), fixed, ranges, prepared.gains, solution.gains)
    if not theta[added].any() and not moves:
        return prepared, stack, solution
    values = theta[linear : prepared.layout.size]
    before = spread(stack, solution)
    far = np.abs(values - about) > TOLERANCES.steps.settled * np.abs(values)  # not where it is linearised
    if (
        squares_ratio(promised, before) > 1.0 - TOLERANCES.steps.errors_settled
        and not far[
            _columns_where(prepared.effects, lambda effect: effect.bends and not effect.changes_machine)
        ].any()
    ):
        return prepared, stack, solution
    for share in TOLERANCES.shapes.shares:
        instances = _moved(prepared, shapes, share * theta[added], reaches, about + share * (values - about))
        try:
            check_closed(replace(prepared, effects=tuple(instances)))  # fails sooner than all columns
            moved = with_effects(prepared, instances, fitted_only=True)
            after = solved_about(moved)
        except BenchError:  # out of reach, or singular
            continue
        if squares_ratio(spread(*after), before) <= 1.0 + TOLERANCES.steps.rounding:
            return moved, *after
    return None


def _within(
    system: Stack,
    free: np.ndarray,
    fixed: Mapping[int, float],
    ranges: Mapping[int, tuple[float, float]],
    gains: NominalGains,
    near: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """The unknowns (p,) of a linearised system within their ranges (column -> least and largest value), and the motors'
    RMS errors (n,) there, drive units: one that would leave its range stays at the end of it.

    free (k,): columns that are solved; fixed: columns with a given value. All others are zero.
    """
    ends = dict(fixed)
    while True:
        at, values = np.array(list(ends), dtype=int), np.array(list(ends.values()))
        within = with_known(system, at, values)
        solution = solved_with(within, free, gains, near)
        outside = {
            k: (low if solution.theta[k] < low else high)
            for k, (low, high) in ranges.items()
            if k in free and not low <= solution.theta[k] <= high
        }
        if not outside:
            theta = solution.theta.copy()
            theta[at] = values
            return theta, spread(within, solution)
        ends |= outside
        free = np.setdiff1d(free, list(outside))


def squares_ratio(errors: np.ndarray, before: np.ndarray) -> float:
    """Mean over the motors of their squared errors over those before, from RMS errors (n,) each."""
    ratio = np.divide(errors, before, out=np.ones_like(errors), where=before > 0.0)
    return float((ratio**2).mean())


def solved_about(prepared: Prepared) -> tuple[Stack, Solution]:
    """As `solved_quickly`; effects that change the machine are held at the values about which they are linearised, and
    the regressor is that of the changed machine: the solution does not depend on the present model.

    Raises BenchError if the loops cannot be closed with them.
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
    solution = solved_with(system, np.setdiff1d(identified, at), prepared.gains, prepared.present.gains)
    theta = solution.theta.copy()
    theta[at] = values
    return stack, replace(solution, theta=theta)


def _columns_of_machine(effects: Sequence[EffectInstance]) -> np.ndarray:
    """Indices (k,) of the parameters of effects that change the machine, among those of all effects."""
    return _columns_where(effects, lambda effect: effect.changes_machine)


def _columns_where(effects: Sequence[EffectInstance], which: Callable[[Effect], bool]) -> np.ndarray:
    return np.array(
        [
            k
            for instance, part in parameter_slices(effects)
            if which(instance.effect)
            for k in range(part.start, part.stop)
        ],
        dtype=int,
    )


def _values_about(effects: Sequence[EffectInstance]) -> np.ndarray:
    """The values (E,) about which the parameters of effects are linearised, zero for linear ones."""
    known = [(instance.effect.parameters, instance.effect.about_values()) for instance in effects]
    return np.array(
        [about.get(parameter.name, 0.0) for parameters, about in known for parameter in parameters]
    )


def _moved(
    prepared: Prepared,
    shapes: list[tuple[int, str]],
    steps: np.ndarray,
    reaches: list[tuple[float, float]],
    values: np.ndarray,
) -> list[EffectInstance]:
    """The effects with their shapes changed by steps within their reaches, and linearised about values."""
    about = linearised(prepared.model.geometry, prepared.effects, values)
    instances = [b if a.effect.moves_by_steps else a for a, b in zip(prepared.effects, about, strict=True)]
    for (i, name), step, (low, high) in zip(shapes, steps, reaches, strict=True):
        value = instances[i].effect.shape_values()[name]
        most = TOLERANCES.shapes.stride * abs(value)
        stepped_to = value + float(np.clip(step, -most, most))
        instances[i] = reshaped(instances[i], {name: min(max(stepped_to, low), high)})
    return instances


def _ranges(
    prepared: Prepared, shapes: Sequence[tuple[int, str]], reaches: Sequence[tuple[float, float]]
) -> dict[int, tuple[float, float]]:
    """Ranges of the step of each shape parameter that is at an end of its reach, which come last, and of the values of
    effects that change the machine, by column.
    """
    ranges: dict[int, tuple[float, float]] = {}
    for instance, part in parameter_slices(prepared.effects):
        if instance.effect.changes_machine:
            most = instance.effect.furthest(prepared.model.geometry, instance.joint)
            first = prepared.layout.effect_slice.start
            ranges |= {first + k: (-most, most) for k in range(part.start, part.stop)}
    for k, ((i, name), (low, high)) in enumerate(zip(shapes, reaches, strict=True)):
        value = prepared.effects[i].effect.shape_values()[name]
        ranges[prepared.layout.size + k] = (
            0.0 if value <= low else -np.inf,
            0.0 if value >= high else np.inf,
        )
    return ranges


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


def _bends(
    prepared: Prepared, phi: np.ndarray, theta: np.ndarray, *, every: bool
) -> tuple[np.ndarray, np.ndarray]:
    """How the effects' torque depends on the values about which columns are linearised.

    (M, n, E): the columns' derivatives by these values, times the values (E,), which come second; zero for linear
    effects, or those linearised about nothing. every: include effects that hardly bend.
    """
    rows = phi.shape[:2]
    about, bent = [np.zeros(0)], [np.zeros((*rows, 0))]
    for instance in prepared.effects:
        known = instance.effect.about_values() if every or instance.effect.moves_by_steps else {}
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
    bends = np.concatenate(bent, axis=2)
    if len(held := _columns_of_machine(prepared.effects)):
        at = prepared.layout.effect_slice.start + held
        bends[:, :, held] = machine_derivatives(prepared, theta) - phi[:, :, at]
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
