"""A verdict on every effect of the catalogue, with its reason."""

from collections.abc import Mapping, Sequence

from bench.diagnosis.batched_sets import solve_sets, swapped
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.normal_equations import System, solve_set
from bench.diagnosis.reason import Because, Doubt, Reason
from bench.diagnosis.result import EffectVerdict, Unexplained, Verdict
from bench.diagnosis.search import Scored, Selection, close, contains, held_out_error, score
from bench.identification.decision import RULE


def verdicts(
    system: System,
    proposals: Sequence[Proposal],
    selection: Selection,
    places: dict[str, tuple[str, ...]],
    scale: float,
    unexplained: Unexplained,
    without: Mapping[str, float],
) -> tuple[EffectVerdict, ...]:
    """Every effect, the identified ones first, then by evidence.

    places: joints at which each identified effect shows. scale: error of the converged model over that of its set.
    without: error of the identified model without each of its effects, fitted anew. unexplained: where it is
    significant, no effect accounts for it, and an identified effect is only sure if the error without it is
    RULE.dominant times the residual with it, or RULE.dominant_in_much times where much remains.
    """
    best = selection.selected
    chosen = set(best.fit.chosen)
    others = [i for i in selection.singles if i not in chosen]
    more = [(*best.fit.chosen, i) for i in others]
    solve_sets(
        system, [*more, *swapped(best.fit.chosen, others)]
    )  # together, and kept: each is asked for below
    sure = (RULE.dominant_in_much if unexplained.much else RULE.dominant) if unexplained.significant else 0.0
    rows: list[EffectVerdict] = []
    for i, proposal in enumerate(proposals):
        if proposal.absorbed:
            rows.append(_absorbed(proposal, _error(system, best, scale)))
        elif i in chosen:
            error = without.get(proposal.name, 0.0)
            rows.append(
                _identified(system, proposals, selection, i, places[proposal.name], scale, sure, error)
            )
        else:
            rows.append(_other(system, proposals, selection, i, scale))
    order: dict[Verdict, int] = {
        "missing": 0,
        "indistinguishable": 1,
        "resembles": 2,
        "not supported": 3,
        "absorbed": 4,
    }
    names = {proposals[i].name for i in chosen}
    return tuple(
        sorted(
            rows,
            key=lambda verdict: (
                verdict.effect not in names,
                order[verdict.verdict],
                -verdict.evidence,
                verdict.effect,
            ),
        )
    )


def undecided(verdict: EffectVerdict) -> bool:
    """Whether an effect explains so much of the residual that a complete search would have to decide on it."""
    return verdict.why.because is Because.GAINS_LITTLE and verdict.evidence > RULE.prior


def _error(system: System, scored: Scored, scale: float) -> float:
    return scale * held_out_error(system, scored.fit)


def _absorbed(proposal: Proposal, error: float) -> EffectVerdict:
    names = (proposal.taken_up_by,) if proposal.taken_up_by else ()
    why = Reason(Because.TAKEN_UP, names)
    return EffectVerdict(proposal.name, "absorbed", error, error, 0.0, (), (), {}, why)


def _identified(
    system: System,
    proposals: Sequence[Proposal],
    selection: Selection,
    i: int,
    places: tuple[str, ...],
    scale: float,
    sure: float,
    before: float,
) -> EffectVerdict:
    best, chosen = selection.selected, selection.selected.fit.chosen
    others = tuple(k for k in chosen if k != i)
    without = score(system, solve_set(system, others))
    alternatives = [
        proposals[k].name
        for k in selection.singles
        if k not in chosen
        and not contains(system.candidates[k], system.candidates[i])
        and close(best, score(system, solve_set(system, (*others, k))))
    ]
    after = _error(system, best, scale)
    unsure = without.fit.held_out < sure**2 * best.fit.held_out
    why = Reason(Because.EXPLAINS, doubts=(Doubt.MUCH_LEFT,) if unsure else ())
    verdict: Verdict = "indistinguishable" if alternatives else "resembles" if unsure else "missing"
    return EffectVerdict(
        proposals[i].name,
        verdict,
        before,
        after,
        best.held_out - without.held_out,
        places,
        tuple(alternatives),
        {},
        why,
    )


def _other(
    system: System, proposals: Sequence[Proposal], selection: Selection, i: int, scale: float
) -> EffectVerdict:
    best, chosen = selection.selected, selection.selected.fit.chosen
    added = score(system, solve_set(system, (*chosen, i)))
    before, after = _error(system, best, scale), _error(system, added, scale)
    rivals = [
        proposals[k].name
        for k in chosen
        if not contains(system.candidates[i], system.candidates[k])
        and close(best, score(system, solve_set(system, (*(c for c in chosen if c != k), i))))
    ]
    if rivals:
        return EffectVerdict(
            proposals[i].name,
            "indistinguishable",
            before,
            after,
            added.held_out - best.held_out,
            (),
            tuple(rivals),
            {},
            Reason(Because.AS_GOOD),
        )
    nothing = after >= before or added.total + RULE.prior < best.total
    why = Reason(Because.GAINS_NOTHING if nothing else Because.GAINS_LITTLE)
    return EffectVerdict(
        proposals[i].name, "not supported", before, after, added.held_out - best.held_out, (), (), {}, why
    )
