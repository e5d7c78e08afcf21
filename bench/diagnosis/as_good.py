"""Models that explain the data as well as the identified one, and their influence on its drive gains."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.evidence import answer_weight
from bench.diagnosis.result import Unexplained
from bench.diagnosis.round import Round, usable
from bench.diagnosis.search import Scored, close, scored
from bench.diagnosis.unnamed_effects import unnamed_spread
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.findings import runaway
from bench.identification.identify import fit
from bench.identification.model_averaged import gains_model_averaged, gains_spread
from bench.identification.prepare import Prepared
from bench.identification.result import Identification
from bench.identification.tolerances import TOLERANCES


def with_spread_over_models(
    base_model: BaseModel, last: Round, model: Prepared, after: Identification, unexplained: Unexplained
) -> Identification:
    """The identified model's answer; standard errors of its gains cover the gains of equally good models.

    Effects too small to be named make a gain less certain. If an error remains unexplained, models with one effect
    more, or another in place of an identified one, represent similar unmodelled torques, whatever their sign. model:
    with the identified effects at their places; unexplained: its remaining error; beyond noise, fewer samples count.
    Raises TimeUpError after the deadline.
    """
    if not after.gains_fitted:
        return after
    fewer = last.system.samples.beyond(unexplained.excess)
    spread = unnamed_spread(last.system, last.selection.selected.fit, last.proposals, fewer)
    after = gains_spread(after, dict(zip(after.joints, spread.tolist(), strict=True)))
    if not (unexplained.significant or unexplained.much):
        return after
    at_noise = replace(last.system, excess=0.0)  # how certain names are must not make a gain more certain
    samples = at_noise.samples
    least = answer_weight(samples, model, after) - RULE.undecided
    others, added = [], added_effects(base_model, model)
    for chosen in _as_good(replace(last, system=at_noise)):
        instances = [
            instance for i in chosen for instance in _instances(last.proposals[i], i in last.chosen, added)
        ]
        base_model.deadline.check()
        wider = base_model.warm_started(model, instances)
        other = fit(wider)
        if runaway(other) is None and answer_weight(samples, wider, other) > least:
            others.append(other)
    return gains_model_averaged(after, others)


def _as_good(last: Round) -> Iterator[tuple[int, ...]]:
    """Sets one effect away from the identified one that the data support as well: the best with one more, and for each
    identified effect the best with another in its place.
    """
    system = last.system
    (best,) = scored(system, [last.chosen])
    others = [i for i in usable(last.proposals, ()) if i not in last.chosen]

    def best_first(sets: Sequence[tuple[int, ...]]) -> list[Scored]:
        return sorted(scored(system, sets), key=lambda each: -each.total)

    more = best_first([(*last.chosen, i) for i in others])
    candidates = [larger for larger in more if larger.total + RULE.prior > best.total][
        : TOLERANCES.search.one_more
    ]
    for k in last.chosen:
        swaps = best_first([(*(c for c in last.chosen if c != k), i) for i in others])
        candidates += [swap for swap in swaps if close(best, swap)][:1]
    for candidate in candidates:
        yield candidate.fit.chosen


def _instances(
    proposal: Proposal, in_model: bool, added: Sequence[EffectInstance]
) -> Sequence[EffectInstance]:
    """An effect at the places where it was identified, or everywhere."""
    return (
        [instance for instance in added if instance.name == proposal.name] if in_model else proposal.instances
    )
