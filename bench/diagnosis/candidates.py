"""The effects that a model might lack, each with the shape that fits the data best."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.progress import SILENT, Progress
from bench.effects import Effect, EffectInstance, RobotSignals, places_in
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import forget_motions
from bench.identification.joint_samples import stands_still
from bench.identification.newton import with_shape_columns
from bench.identification.partial_regression import PartialRegression, partial_regression
from bench.identification.prepare import Prepared
from bench.identification.shapes import best_shape
from bench.identification.solve_only import candidate_columns, linearised, solved_quickly
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Proposal:
    """An effect at the places where data can show it, and why not elsewhere.

    absorbed: no data of this robot can show it; taken_up_by: the parameter that absorbs most of it. prior: nats that it
    must bring beyond those of every effect, for the number of trials.
    """

    name: str
    instances: tuple[EffectInstance, ...]
    absorbed: bool
    taken_up_by: str
    prior: float = 0.0


@dataclass(frozen=True)
class Context:
    """A model from which effects get their shape: its equations, the signals for these effects, and its residual."""

    prepared: Prepared
    regression: PartialRegression


def context_of(prepared: Prepared, near: tuple[RobotSignals, ...]) -> Context:
    """Solve the prepared equations and keep the residual; near: signals for effects in a search."""
    regression = partial_regression(*solved_quickly(prepared))
    return Context(replace(prepared, signals=near), regression)


def propose(
    start: Context, catalogue: Mapping[str, Effect], progress: Progress = SILENT, deadline: Deadline = NEVER
) -> list[Proposal]:
    """Every effect of the catalogue that the starting model lacks, at all possible places.

    Raises TimeUpError after the deadline.
    """
    prepared = start.prepared
    places = places_in(prepared.model.geometry, prepared.dataset.weighed)
    present = {instance.seat for instance in prepared.effects}
    every = {
        name: [
            EffectInstance(
                places.effect_at(effect, joint), joint, name if effect.place == "robot" else f"{name}:{joint}"
            )
            for joint in places.where(effect)
            if (name, joint) not in present
        ]
        for name, effect in catalogue.items()
    }
    # Filtered together and kept; used one by one below.
    plain = [instance for instances in every.values() for instance in instances if not instance.effect.shape]
    alone = [instance for instance in plain if not instance.effect.depends_on_model]
    for seen, measured in zip(prepared.signals, prepared.measured, strict=True):
        deadline.check()
        fitted = measured.recording.use == "identify"
        effect_rows(seen, prepared.settings.decimation, plain if fitted else alone, deadline)
        forget_motions((measured,))
    proposals = []
    for name, instances in every.items():
        progress.advance()
        deadline.check()
        if not instances:
            continue
        effect = catalogue[name]
        visible = [
            instance
            for instance in instances
            if not stands_still(prepared, instance) and (effect.shape or _visible(start, instance))
        ]
        if not visible:
            proposals.append(Proposal(name, tuple(instances), True, _taken_up_by(start, instances[0])))
            continue
        proposals.append(Proposal(name, shaped(start, visible, deadline), False, ""))
        forget_motions(prepared.measured)  # few effects need them
    return proposals


def shaped(
    context: Context, instances: Sequence[EffectInstance], deadline: Deadline = NEVER
) -> tuple[EffectInstance, ...]:
    """The instances of one effect with the shape, and about the values, that explain most of the residual."""
    reshaped = tuple(instances)
    if reshaped[0].effect.shape:
        reshaped = tuple(_with_best_shape(context, instance, deadline) for instance in reshaped)
    for _ in range(TOLERANCES.steps.linearisations_of_candidates):
        about = _about_their_values(context, reshaped)
        if about == reshaped:
            break
        reshaped = about
    return reshaped


def _with_best_shape(context: Context, instance: EffectInstance, deadline: Deadline) -> EffectInstance:
    deadline.check()
    return best_shape(context.prepared, instance, context.regression)


def _about_their_values(
    context: Context, instances: tuple[EffectInstance, ...]
) -> tuple[EffectInstance, ...]:
    first = instances[0].effect
    if first.about({parameter.name: 0.0 for parameter in first.parameters}) is first:
        return instances  # linear: needs no linearisation
    values, _ = context.regression.explained(candidate_columns(context.prepared, instances))
    return linearised(context.prepared.model.geometry, instances, values)


def _visible(context: Context, instance: EffectInstance) -> bool:
    """Whether part of an effect's columns lies outside those of the model."""
    products = context.regression.products(candidate_columns(context.prepared, [instance]))
    return bool(np.any(products.remaining > TOLERANCES.rank.visible_effect))


def _taken_up_by(context: Context, instance: EffectInstance) -> str:
    """The base parameter whose column is most like an effect's first; empty for an effect of zero."""
    prepared, regression = context.prepared, context.regression
    column = (
        candidate_columns(prepared, [instance])[:, :, 0] * regression.moving * regression.weights
    ).reshape(-1)
    if not np.any(column):
        return ""
    rigid = (
        np.concatenate([observation.rigid for observation in prepared.fitted])
        * (regression.moving * regression.weights)[:, :, None]
    )
    rows = rigid.reshape(-1, rigid.shape[2])
    norms = np.linalg.norm(rows, axis=0)
    norms[norms == 0.0] = 1.0
    values = np.linalg.lstsq(rows / norms, column)[0]
    return prepared.model.base.names[int(np.argmax(np.abs(values)))]


def partners(
    model: Prepared, context: Context, proposals: Sequence[Proposal], chosen: Collection[int]
) -> list[int]:
    """Indices of proposals that would explain much of the converged model's residual, the most first.

    The derivatives by shape parameters count as columns of the model: a time constant identified without a viscous
    friction has absorbed its part, and could release it. If no column bends, in the model or the proposal, a search is
    already complete. context: of the model; chosen: proposals in the model.
    """
    bends = any(map(_bends, model.effects))
    able = [
        i
        for i, proposal in enumerate(proposals)
        if i not in chosen
        and not proposal.absorbed
        and (bends or (chosen and any(map(_bends, proposal.instances))))
    ]
    if not able:
        return []
    stack, solution = solved_quickly(model)
    bent, extended = with_shape_columns(model, stack, solution, np.arange(model.layout.size))
    regression = partial_regression(bent, extended)
    shares = {
        i: regression.explained(candidate_columns(context.prepared, proposals[i].instances))[1]
        / regression.sum_of_squares
        for i in able
    }
    bounds = TOLERANCES.search
    large = (i for i in shares if shares[i] > bounds.revealed_share)
    return sorted(large, key=lambda i: -shares[i])[: bounds.revealed]


def _bends(instance: EffectInstance) -> bool:
    """Whether its columns depend on the rest of the model."""
    return bool(instance.effect.shape) or instance.effect.depends_on_model
