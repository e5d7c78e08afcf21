"""All columns that the page can ask for, motor by motor: the model's own, and a few for every effect and place."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.effects import Effect, EffectInstance
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.solve_only import candidate_columns
from bench.workbench.decorrelated import set_apart
from bench.workbench.directions import (
    Directions,
    Terms,
    directions_of,
    needed_coordinates,
    rigid_coordinates,
)
from bench.workbench.found_model import FoundModel
from bench.workbench.kinds import Kinds
from bench.workbench.reduce import Reduced, coefficients_at, many, reduced, within_reach
from bench.workbench.rows import Rows
from bench.workbench.variants import Variants, shape_order


@dataclass(frozen=True)
class System:
    """columns (M, n, C) over all recordings, zero where a joint stands still: the model's own, then each effect's.

    effects: in the order of the catalogue; starts: the first column of each, and C. reference (C,): how the found
    model combines the columns; gains (n,) its drive gains; modelled, error (M, n): its current and what it leaves,
    as far as it is combined from the columns. fitted (M,): whether a row is fitted. directions: in which other
    models differ. basis (own, C): where there are many columns, they are combined so that they are far from each
    other: the model's parameters are basis @ the coordinates by these; None where they are its parameters.
    """

    columns: np.ndarray
    effects: tuple[Reduced, ...]
    starts: tuple[int, ...]
    reference: np.ndarray
    gains: np.ndarray
    modelled: np.ndarray
    error: np.ndarray
    moving: np.ndarray
    fitted: np.ndarray
    directions: Directions
    basis: np.ndarray | None


def build(model: FoundModel, effects: Sequence[Effect], triangles: int = 2) -> System:
    """The system with the columns of these effects, wherever each can sit; triangles: see `within_reach`."""
    plain = model.plain
    moving = np.concatenate([one.moving for one in plain.observations])
    fitted = np.concatenate([np.full(len(one.time), one.use == "identify") for one in plain.observations])
    own = np.concatenate([regressor_rows(one, plain.layout) for one in plain.observations])
    known = np.concatenate([known_rows(one, plain.dataset.payloads) for one in plain.observations]) * moving
    current = np.concatenate([one.current for one in plain.observations]) * moving
    kinds = Kinds(model)
    variants = [one for effect in effects for one in kinds.of(effect)]
    rows = Rows(kinds)
    parts = {i: reduced(one, rows.of(one), moving) for i, one in enumerate(variants) if not one.follows}
    told = [one for one in variants if _tells(one, kinds)]
    terms = _terms(model, list(parts.values()), told, own, fitted)
    directions = directions_of(model, terms, known[fitted], current[fitted], kinds.roomy)
    rows = Rows(kinds, directions)
    for i, one in enumerate(variants):
        if one.follows:
            parts[i] = reduced(one, rows.of(one), moving, rows.parts(one))
    wanted = [parts[i] for i in range(len(variants))]
    every = within_reach(wanted, own.shape[2], triangles)
    columns = np.concatenate([own, *(one.columns for one in every)], axis=2)
    columns *= moving[:, :, None]
    starts = np.cumsum([own.shape[2], *(one.columns.shape[2] for one in every)])
    reference = _reference(model, every, starts, columns.shape[2])
    modelled = (columns @ reference + known) / model.solution.gains
    basis = None
    if many(wanted, own.shape[2]):
        still = [one.variants.kind != "linear" or bool(one.variants.follows) for one in every]
        weighted = columns[fitted] * model.solution.weights[:, None]
        basis = set_apart(columns, reference, weighted, np.repeat(still, np.diff(starts)))
    return System(
        columns=columns,
        effects=every,
        starts=tuple(int(one) for one in starts),
        reference=reference,
        gains=model.solution.gains,
        modelled=modelled,
        error=current - modelled,
        moving=moving,
        fitted=fitted,
        directions=directions,
        basis=basis,
    )


def _tells(variants: Variants, kinds: Kinds) -> bool:
    """Whether an effect that follows the present model counts where directions are looked for.

    Of many effects through the loops, each with a small share, only those found.
    """
    instance = variants.instance
    named = (instance.effect.name, instance.joint) in kinds.ticked
    return variants.follows == "needed" or (variants.follows == "rigid" and (kinds.roomy or named))


def coordinates_of(system: System, part: Reduced) -> np.ndarray | None:
    """How a model's difference from the found one, by all columns, moves this effect's columns: (m, C)."""
    follows = part.variants.follows
    count = system.columns.shape[2]
    if follows == "rigid":
        found = rigid_coordinates(system.directions, count)
        if system.basis is not None:
            found = found[:, : len(system.basis)] @ system.basis
        return found
    if follows == "needed":
        joints = list(system.directions.model.plain.dataset.robot.joints)
        motor = joints.index(part.variants.instance.joint)
        found = needed_coordinates(system.directions, motor, system.columns[system.fitted, motor])
        for start, stop, one in zip(system.starts, system.starts[1:], system.effects, strict=False):
            if one.variants.instance.effect.before_torque:
                found[:, start:stop] = 0.0
        return found
    return None


def _terms(
    model: FoundModel,
    parts: Sequence[Reduced],
    following: Sequence[Variants],
    own: np.ndarray,
    fitted: np.ndarray,
) -> Terms:
    """Effects in the shape that was found, or in some shape, beside the model's own columns."""
    rows, instances, places = [own[fitted]], [], []
    at = own.shape[2]
    for part in parts:
        if part.variants.approximate:
            continue
        instance = part.variants.typical
        coefficients = _coefficients(model, part, instance)
        rows.append(part.columns[fitted] @ coefficients.T)
        instances.append(instance)
        places.append(at + np.arange(len(coefficients)))
        at += len(coefficients)
    after = [one.instance for one in following]
    places_after: dict[tuple[str, str], np.ndarray] = {}
    for one in after:
        places_after[one.effect.name, one.joint] = at + np.arange(len(one.effect.parameters))
        at += len(one.effect.parameters)
    found = {(one.effect.name, one.joint) for one in model.effects}
    moving = np.concatenate([one.moving for one in model.plain.fitted])[:, :, None]
    return Terms(
        np.concatenate(rows, axis=2) * moving,
        own.shape[2],
        tuple(instances),
        tuple(places),
        candidate_columns(model.found, after) * moving,
        tuple(
            np.concatenate([where for (name, _), where in places_after.items() if name == effect])
            for effect in dict.fromkeys(one.effect.name for one in after)
        ),
        tuple(where for key, where in places_after.items() if key in found),
    )


def _reference(model: FoundModel, parts: Sequence[Reduced], starts: np.ndarray, count: int) -> np.ndarray:
    """The found model by the page's columns (C,)."""
    theta = model.solution.theta
    reference = np.zeros(count)
    at = own = int(starts[0])
    reference[:own] = theta[:own]
    index = {
        (one.variants.instance.effect.name, one.variants.instance.joint): i for i, one in enumerate(parts)
    }
    for one in model.effects:
        values = theta[at : at + len(one.effect.parameters)]
        at += len(values)
        i = index[one.effect.name, one.joint]
        reference[starts[i] : starts[i + 1]] = values @ _coefficients(model, parts[i], one)
    return reference


def _coefficients(model: FoundModel, part: Reduced, instance: EffectInstance) -> np.ndarray:
    """How an effect's columns beside the found model are combined (k, b) from those that are kept."""
    variants, effect = part.variants, instance.effect
    scale = 1.0
    if variants.scale != "none":
        gain = model.solution.gains[list(model.plain.dataset.robot.joints).index(instance.joint)]
        scale = float(gain if variants.scale == "gain" else abs(gain))
    if variants.kind == "linear":
        return scale * part.tables[0][0, 0]
    branch = 0
    if variants.kind == "shape":
        free, others = shape_order(effect)
        value = float(getattr(effect, free.name))
        branch = variants.branches.index(tuple(float(getattr(effect, one.name)) for one in others))
    else:
        value = float(getattr(effect, effect.parameters[0].name))
    near = [
        (max(float(piece.nodes[0]) - value, value - float(piece.nodes[-1]), 0.0), i)
        for i, piece in enumerate(variants.pieces)
        if piece.branch == branch
    ]
    i = min(near)[1]
    return np.asarray(scale * coefficients_at(variants.pieces[i], part.tables[i], value)[0])
