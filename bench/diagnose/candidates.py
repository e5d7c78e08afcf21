"""The effects that a model might lack, each with the shape that suits the data best."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.effects import Effect, EffectInstance, places_in
from bench.estimate.partial import PartialRegression, partial_regression
from bench.estimate.prepare import Prepared
from bench.estimate.settle import best_shape, candidate_columns, solved_quickly

INVISIBLE = 1e-4  # of a column's length: less left beside the model's own columns cannot be told from them


@dataclass(frozen=True)
class Proposal:
    """An effect at the places where it shows, and what keeps it from showing elsewhere.

    absorbed: no data of this robot can show it; taken_up_by: the parameter that takes up most of it.
    """

    name: str
    instances: tuple[EffectInstance, ...]
    absorbed: bool
    taken_up_by: str


def propose(
    model: Prepared, start: Prepared, catalogue: Mapping[str, Effect], fit_gains: bool
) -> list[Proposal]:
    """Every effect of the catalogue that the starting model does not have, wherever it can sit.

    Shapes are those that explain most of what `model` (the starting model, or one with effects found since)
    leaves; whether an effect is absorbed is asked beside the starting model's columns.
    """
    stack, solution = solved_quickly(model, fit_gains)
    left = partial_regression(stack, solution)
    own_stack, own_solution = (stack, solution) if model is start else solved_quickly(start, fit_gains)
    own = left if model is start else partial_regression(own_stack, own_solution)
    weighed = [name for name, one in start.dataset.payloads.items() if one.mass is not None]
    places = places_in(start.model.geometry, weighed)
    present = {(one.effect.name, one.joint) for one in start.effects}
    proposals = []
    for name, effect in catalogue.items():
        at = [joint for joint in places.of(effect.place) if (name, joint) not in present]
        if not at:
            continue
        found = [EffectInstance(effect, joint, f"{name}:{joint}" if joint else name) for joint in at]
        shaped = [best_shape(model, one, left, refine=False) if effect.shape else one for one in found]
        visible = [one for one in shaped if _visible(model, one, own)]
        taken = "" if visible else _taken_up_by(model, shaped[0], own, own_stack.phi)
        proposals.append(Proposal(name, tuple(visible or shaped), not visible, taken))
    return proposals


def _visible(prepared: Prepared, instance: EffectInstance, partial: PartialRegression) -> bool:
    """Whether anything of an effect's columns is left beside those that the model has."""
    columns = candidate_columns(prepared, [instance])
    whole = np.linalg.norm((columns * partial.moving[:, :, None] * partial.weights[:, None]), axis=(0, 1))
    left = np.linalg.norm(partial.left(columns), axis=0)
    return bool(np.any(left > INVISIBLE * np.maximum(whole, np.finfo(float).tiny)))


def _taken_up_by(
    prepared: Prepared, instance: EffectInstance, partial: PartialRegression, phi: np.ndarray
) -> str:
    """The model's parameter that takes up most of an effect's first column."""
    column = candidate_columns(prepared, [instance])[:, :, 0] * partial.moving * partial.weights
    if not np.any(column):
        return ""
    rows = (phi * (partial.moving * partial.weights)[:, :, None]).reshape(-1, phi.shape[2])
    norms = np.linalg.norm(rows, axis=0)
    norms[norms == 0.0] = 1.0
    values = np.linalg.lstsq(rows / norms, column.reshape(-1))[0]
    names = [*prepared.model.base.names]
    return names[int(np.argmax(np.abs(values[: len(names)])))]
