"""Effects that show only when the shape of an identified one gives way, or when all are converged with them."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from bench.diagnosis.candidates import Context, Proposal
from bench.effects import EffectInstance
from bench.identification.newton import with_shape_columns
from bench.identification.partial_regression import partial_regression
from bench.identification.prepare import Prepared
from bench.identification.solve_only import candidate_columns, solved_quickly
from bench.identification.tolerances import TOLERANCES


def partners(
    model: Prepared, context: Context, proposals: Sequence[Proposal], chosen: Collection[int]
) -> list[int]:
    """Proposals (indices) that would explain much of what the converged model leaves, the most first.

    The model's columns are joined by the derivatives by its shape parameters: a time constant that was identified
    without a viscous friction has taken its part, and would leave it there. Where nothing bends, in the model or in
    what joins it, a search has said all there is. context: of the model; chosen: what the model has already.
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
    """Whether its columns depend on what else the model has."""
    return bool(instance.effect.shape) or instance.effect.depends_on_model


def in_their_shape(proposals: Sequence[Proposal], model: Prepared, given_count: int) -> list[Proposal]:
    """The proposals in the shape they have in a converged model, whose first `given_count` effects are the starting
    ones.
    """
    added = model.effects[given_count:]
    changed = []
    for proposal in proposals:
        instances = tuple(each for each in added if each.effect.name == proposal.name)
        changed.append(replace(proposal, instances=instances) if instances else proposal)
    return changed
