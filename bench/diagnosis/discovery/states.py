"""Beam search: small sets of terms that explain much of a model's residual."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.discovery.screen import Residual, Screened, screened
from bench.diagnosis.discovery.term import Term
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class State:
    """Terms added to a model with some effects, their residual, and half the logarithm of its squares plus a charge for
    each unknown, `charged` for those of the effects.
    """

    effects: tuple[str, ...]
    terms: tuple[Screened, ...]
    residual: Residual
    charged: float
    cost: float


def best_states(
    lefts: Mapping[tuple[str, ...], tuple[Residual, int]],
    terms: Sequence[Term],
    basics: Sequence[Term],
    deadline: Deadline = NEVER,
) -> list[State]:
    """Sets of up to `LawBounds.depth` terms, added to models with these residuals and numbers of unknowns.

    The best of each size, then the second best, and so on, while more terms are worth their cost. basics: terms that
    may reveal others; each model is also tried with these. Raises TimeUpError after the deadline.
    """
    price = RULE.prior + float(np.log(len(terms)))
    levels: list[list[State]] = []
    alone = [
        _state(names, (), residual, _charge(residual, unknowns, RULE.prior * len(names)), price)
        for names, (residual, unknowns) in lefts.items()
    ]
    beam = list(alone)
    least = min(state.cost for state in alone)
    for basic in basics:
        beam += [_joined(state, Screened(basic, {}, 0.0), price) for state in beam]
    for _ in range(TOLERANCES.laws.depth):
        wider: list[State] = []
        for state in beam:
            deadline.check()
            best = screened(state.residual, terms, TOLERANCES.laws.added, _known(state))
            wider += [_joined(state, candidate, price) for candidate in best]
        beam = _distinct(wider)[: TOLERANCES.laws.kept]
        if not beam or beam[0].cost >= least:
            break
        least = beam[0].cost
        levels.append(beam)
    return [state for rank in zip_longest(*levels) for state in rank if state is not None]


def _known(state: State) -> set[object]:
    return {candidate.term.structure for candidate in state.terms}


def _state(
    effects: tuple[str, ...], terms: tuple[Screened, ...], residual: Residual, charged: float, price: float
) -> State:
    unknowns = (
        sum(candidate.term.parts + len(candidate.term.numbers) for candidate in terms) * residual.motors
    )
    charge = charged + _charge(residual, unknowns, price * len(terms))
    return State(effects, terms, residual, charged, float(0.5 * np.log(residual.squares) + charge))


def _charge(residual: Residual, unknowns: int, price: float) -> float:
    return float((0.5 * np.log(residual.rows) * unknowns + price) / residual.rows)


def _joined(state: State, candidate: Screened, price: float) -> State:
    return _state(
        state.effects,
        (*state.terms, candidate),
        state.residual.orthogonal_to(candidate),
        state.charged,
        price,
    )


def _distinct(states: Sequence[State]) -> list[State]:
    """The best of each set of structures, the best first."""
    distinct: dict[frozenset[object], State] = {}
    for state in sorted(states, key=lambda candidate: candidate.cost):
        distinct.setdefault(frozenset((*_known(state), *state.effects)), state)
    return list(distinct.values())
