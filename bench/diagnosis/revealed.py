"""Effects that show only when the shape of a found one gives way."""

from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from bench.diagnosis.candidates import Context, Proposal
from bench.identification.newton import with_shape_columns
from bench.identification.partial_regression import partial_regression
from bench.identification.prepare import Prepared
from bench.identification.solve_only import candidate_columns, solved_quickly

WORTH = 0.1  # share of what the found effects leave, in squares, from which an effect is tried beside them
MOST = 2  # effects that are tried


def partners(
    model: Prepared, context: Context, proposals: Sequence[Proposal], found: Collection[int]
) -> list[int]:
    """Proposals (indices) that would explain much of what the settled model leaves, the most first.

    Beside the model's columns stand the derivatives by its shape parameters: a time constant that was found without a
    viscous friction has taken its part, and would leave it there. context: of the model; found: what the model has
    already.
    """
    stack, solution = solved_quickly(model)
    bent, extended = with_shape_columns(model, stack, solution, np.arange(model.layout.size))
    if bent.phi.shape[2] == stack.phi.shape[2]:
        return []
    left = partial_regression(bent, extended)
    shares = {
        i: left.explained(candidate_columns(context.prepared, one.instances))[1] / left.sum_of_squares
        for i, one in enumerate(proposals)
        if i not in found and not one.absorbed
    }
    return sorted((i for i in shares if shares[i] > WORTH), key=lambda i: -shares[i])[:MOST]


def beside(proposals: Sequence[Proposal], model: Prepared, own: int) -> list[Proposal]:
    """The proposals in the shape that they have in a settled model, whose first `own` effects are the starting ones."""
    added = model.effects[own:]
    changed = []
    for one in proposals:
        instances = tuple(each for each in added if each.effect.name == one.name)
        changed.append(replace(one, instances=instances) if instances else one)
    return changed
