"""Laws that an effect of the catalogue does as well are called by its name."""

from collections.abc import Collection, Sequence

from bench.diagnosis.normal_equations import solve_set
from bench.diagnosis.rounds import Round
from bench.diagnosis.search import possible, score


def stood_for(this_round: Round, laws: Sequence[str], barred: Collection[str]) -> dict[str, int]:
    """Laws of the best set for which another proposal (index) does as well or better, by the law's name.

    As sign(load) is a constant offset where the load does not change its sign. Effects have less to earn than laws, so
    that the evidence for the set with the effect is at least as large where both explain the same.
    """
    system, proposals, selection = this_round.system, this_round.proposals, this_round.selection
    chosen, total = selection.selected.fit.chosen, selection.selected.total
    called: dict[str, int] = {}
    for name in laws:
        place = next((i for i in chosen if proposals[i].name == name), None)
        if place is None:
            continue
        others = tuple(i for i in chosen if i != place)
        tried = [
            (score(system, solve_set(system, (*others, i))), i)
            for i in selection.singles
            if i not in chosen and proposals[i].name not in (*laws, *barred)
        ]
        able = [
            (scored.total, i) for scored, i in tried if scored.total >= total and possible(system, scored.fit)
        ]
        if able:
            best, i = max(able)
            chosen, total, called[name] = (*others, i), best, i
    return called
