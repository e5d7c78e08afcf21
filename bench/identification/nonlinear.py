"""Nonlinear effects: search their shape parameters, and linearise them about their model."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.errors import BenchError
from bench.effects import EffectInstance
from bench.effects.select import parameter_slices
from bench.identification.compressed import Stack
from bench.identification.decision import RULE
from bench.identification.effect_columns import PresentModel
from bench.identification.moved_regressor import check_closed
from bench.identification.newton import solved_about, stepped
from bench.identification.partial_regression import partial_regression
from bench.identification.prepare import Prepared, with_effects, with_judged
from bench.identification.shapes import best_shape
from bench.identification.solution import Solution
from bench.identification.solve_only import linearised, solved_quickly, spread
from bench.identification.tolerances import TOLERANCES


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
    extra = np.array([actuator.gain for actuator in prepared.dataset.robot.redundant])
    if layout.redundant:
        extra = extra + solution.theta[layout.redundant_slice]
    values = solution.theta[layout.effect_slice]
    effects = tuple((instance, values[part]) for instance, part in parameter_slices(prepared.effects))
    return replace(
        prepared.present,
        gains=solution.gains,
        base=base,
        payloads=payloads,
        effects=effects,
        redundant_gains=extra,
    )


def settles(instances: Sequence[EffectInstance]) -> bool:
    """Whether effects need rounds to converge; until then, recordings that are not fitted need no columns."""
    return any(instance.effect.shape or instance.effect.depends_on_model for instance in instances)


def converged(
    prepared: Prepared, *, nearly: bool = False, added_from: int | None = None, deadline: Deadline = NEVER
) -> Prepared:
    """Search shape parameters and linearise model-dependent columns in a few rounds, if there are any.

    First every shape is searched with the others fixed; then all move together by Gauss-Newton steps while these lower
    the errors (see newton.py), else they are searched again. nearly: shapes and the present model are nearly right, so
    no search comes first. added_from: in a search, index of the first effect that it added; these leave places where
    they are out of bounds (see `staying`). Raises TimeUpError after the deadline.
    """
    instances = prepared.effects
    if prepared.converged or not settles(instances):
        return prepared
    if nearly:
        begun, present, before = _begun(prepared)
        return _rounds(prepared, begun, present, before, added_from, deadline=deadline)
    straight = [instance for instance in instances if not settles([instance])]
    plain = with_effects(prepared, straight, fitted_only=True)
    present = present_model(plain, solved_quickly(plain)[1])
    return _rounds(prepared, instances, present, None, added_from, deadline=deadline)


def converged_from(
    prepared: Prepared,
    model: Prepared,
    *,
    added_from: int | None = None,
    deadline: Deadline = NEVER,
) -> Prepared:
    """The effects of a converged model, converged with other signals, such as exact ones in place of nearby ones.

    prepared: has these signals; its effects do not count. added_from: as `converged`.
    """
    return _rounds(prepared, *_begun(model), added_from, deadline=deadline)


def _begun(model: Prepared) -> tuple[tuple[EffectInstance, ...], PresentModel, tuple[np.ndarray, ...]]:
    """A model's effects about its solution, the model that they see, and its state."""
    stack, solution = solved_about(model) if model.converged else solved_quickly(model)
    instances = _but_bent(model.effects, _about(model, solution))
    return instances, present_model(model, solution), _state(model, stack, solution)


def _about(prepared: Prepared, solution: Solution) -> tuple[EffectInstance, ...]:
    """A model's effects, linearised about its solution."""
    return linearised(prepared.model.geometry, prepared.effects, solution.theta[prepared.layout.effect_slice])


def _but_bent(
    instances: Sequence[EffectInstance], about: Sequence[EffectInstance]
) -> tuple[EffectInstance, ...]:
    """Effects linearised about `about`, except those that bend: Gauss-Newton steps move these."""
    return tuple(x if x.effect.moves_by_steps else y for x, y in zip(instances, about, strict=True))


def _rounds(
    prepared: Prepared,
    instances: tuple[EffectInstance, ...],
    present: PresentModel,
    before: tuple[np.ndarray, ...] | None,
    added_from: int | None,
    *,
    deadline: Deadline,
) -> Prepared:
    """Rounds from effects linearised about `present`, until the state no longer changes from `before`.

    A settled model keeps the columns with which this was observed.
    """
    instances = _closed(prepared, instances)
    last = instances
    for _ in range(TOLERANCES.steps.rounds):
        deadline.check()
        prepared = with_effects(prepared, instances, present, fitted_only=True)
        solved = None if before is None else solved_about(prepared)
        together = None if solved is None else stepped(prepared, *solved)
        if together is None:
            unshaped, prepared = prepared, _shaped(prepared, deadline)
            stack, solution = solved if solved and prepared is unshaped else solved_about(prepared)
        else:
            prepared, stack, solution = together
        instances = prepared.effects
        present = present_model(prepared, solution)
        about = _about(prepared, solution)
        if together is None:
            instances, last = _eased(last, instances, about), instances
        else:
            instances = _but_bent(instances, about)
        stay = None if before is None or added_from is None else staying(prepared, solution, added_from)
        if stay is not None and len(stay) < len(instances):
            instances, last = (tuple(each[i] for i in stay) for each in (instances, last))
            present = replace(present, effects=tuple(present.effects[i] for i in stay))
            prepared = with_effects(prepared, instances, present, fitted_only=True)
            instances, present, before = _begun(prepared)
            continue
        now = _state(replace(prepared, effects=instances), stack, solution)
        if before is not None and _alike(now, before, int(stack.moving.sum())):
            return replace(with_judged(prepared), converged=True)
        before = now
    return replace(with_effects(prepared, instances, present), converged=True)


def _closed(prepared: Prepared, instances: tuple[EffectInstance, ...]) -> tuple[EffectInstance, ...]:
    """The effects; those that change the machine about zero, if the loops cannot be closed with their values."""
    try:
        check_closed(replace(prepared, effects=instances))
    except BenchError:
        nothing = (
            each.effect.about({parameter.name: 0.0 for parameter in each.effect.parameters})
            if each.effect.changes_machine
            else each.effect
            for each in instances
        )
        return tuple(replace(each, effect=effect) for each, effect in zip(instances, nothing, strict=True))
    return instances


def _state(prepared: Prepared, stack: Stack, solution: Solution) -> tuple[np.ndarray, ...]:
    """What no longer changes in a converged model: gains, nonlinear values and RMS errors."""
    curves = [
        (*effect.shape_values().values(), *(effect.about_values().values() if effect.moves_by_steps else ()))
        for effect in (instance.effect for instance in prepared.effects)
    ]
    return solution.gains, np.concatenate(curves), spread(stack, solution)


def _alike(now: tuple[np.ndarray, ...], before: tuple[np.ndarray, ...], rows: int) -> bool:
    """Whether gains, and either shape parameters or RMS errors, are the same as a round before.

    If the errors of all these rows together are, the data do not determine what has changed.
    """
    bounds = TOLERANCES.steps
    gains, shapes, errors, chance = (
        bool(np.all(np.abs(x - y) <= share * np.abs(x)))
        for x, y, share in zip(
            (*now, now[-1]),
            (*before, before[-1]),
            (bounds.settled, bounds.settled, bounds.errors_settled, bounds.settled_nats / rows),
            strict=True,
        )
    )
    return chance or (gains and (shapes or errors))


def _eased(
    earlier: Sequence[EffectInstance], last: Sequence[EffectInstance], searched: Sequence[EffectInstance]
) -> tuple[EffectInstance, ...]:
    """The searched values, but half of the way where they reverse direction: they would oscillate."""
    eased = []
    for instance, two, three in zip(earlier, last, searched, strict=True):
        a, b, c = (each.effect.about_values() for each in (instance, two, three))
        halfway = {
            name: 0.5 * (b[name] + c[name]) for name in c if (c[name] - b[name]) * (b[name] - a[name]) < 0.0
        }
        eased.append(replace(three, effect=three.effect.about(halfway)) if halfway else three)
    return tuple(eased)


def _shaped(prepared: Prepared, deadline: Deadline) -> Prepared:
    """Every shape parameter in turn at its best value, the others held."""
    instances = list(prepared.effects)
    for i, instance in enumerate(instances):
        if not instance.effect.shape:
            continue
        deadline.check()
        others = with_effects(prepared, instances[:i] + instances[i + 1 :], fitted_only=True)
        stack, solution = solved_quickly(others)
        partial = partial_regression(stack, solution)
        instances[i] = best_shape(prepared, instance, partial)
    if tuple(instances) == prepared.effects:
        return prepared
    return with_effects(prepared, instances, fitted_only=True)


def beyond_bounds(prepared: Prepared) -> tuple[EffectInstance, ...]:
    """The effects of a converged model with a parameter that the data push to its bound or beyond.

    Also those whose motor's gain runs away with them: the two grow together, or oscillate between linearisations and
    never settle, so a few more are tried.
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
        about = _about(prepared, solution)
        prepared = with_effects(prepared, about, present_model(prepared, solution), fitted_only=True)
    return ()


def within_bounds(prepared: Prepared) -> tuple[Prepared, tuple[EffectInstance, ...]]:
    """A converged model, and its effects that are set to zero, since the drive gain cannot be distinguished from them.

    With such an effect, gain and effect grow together without end. The others are converged without it.
    """
    whole = prepared = converged(prepared)
    gone: set[tuple[str, str]] = set()
    while beyond := beyond_bounds(prepared):
        gone |= {instance.key for instance in beyond}
        kept = [instance for instance in prepared.effects if instance.key not in gone]
        prepared = converged(with_effects(whole, kept))
    if not gone:
        return whole, ()
    remaining = {instance.key: instance for instance in prepared.effects}
    every = [remaining.get(instance.key) or _nothing(instance) for instance in whole.effects]
    outside = tuple(instance for instance in every if instance.key in gone)
    return replace(with_effects(prepared, every), converged=True), outside


def columns_of(prepared: Prepared, instances: tuple[EffectInstance, ...]) -> np.ndarray:
    """Indices of the parameters of some effects among a model's unknowns."""
    among = [part for instance, part in parameter_slices(prepared.effects) if instance in instances]
    indices = [k for part in among for k in range(part.start, part.stop)]
    return prepared.layout.effect_slice.start + np.array(indices, dtype=int)


def _nothing(instance: EffectInstance) -> EffectInstance:
    effect = instance.effect
    return replace(instance, effect=effect.about({parameter.name: 0.0 for parameter in effect.parameters}))


def out_of_bounds(prepared: Prepared, solution: Solution) -> tuple[EffectInstance, ...]:
    """The effects at or beyond a bound; gain and effect grow together if the data determine only one of them."""
    robot = prepared.dataset.robot
    ratios = dict(zip(robot.joints, (solution.gains / robot.nominal_gains).tolist(), strict=True))
    outside, values = [], solution.theta[prepared.layout.effect_slice]
    for instance, part in parameter_slices(prepared.effects):
        bounds = [parameter.below for parameter in instance.effect.parameters]
        if not np.any(np.isfinite(bounds)):
            continue
        wild = (
            prepared.fit_gains and not 1.0 / RULE.gain_far <= ratios.get(instance.joint, 1.0) <= RULE.gain_far
        )
        if wild or np.any(np.abs(values[part]) >= bounds):
            outside.append(instance)
    return tuple(outside)


def staying(prepared: Prepared, solution: Solution, added_from: int) -> list[int]:
    """Indices of a model's effects that stay in a search, which added those from `added_from` on.

    An effect out of bounds never settles and takes its motor's gain with it, so that nothing is determined. It leaves
    this place, unless it is its last.
    """
    outside = out_of_bounds(prepared, solution)
    remaining = Counter(instance.name for instance in prepared.effects)
    stay = []
    for i, instance in enumerate(prepared.effects):
        if i < added_from or instance not in outside or remaining[instance.name] == 1:
            stay.append(i)
        else:
            remaining[instance.name] -= 1
    return stay
