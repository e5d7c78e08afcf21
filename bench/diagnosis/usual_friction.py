"""Ensures that no answer is worse, on held-out recordings, than the usual first model: with viscous and Coulomb
friction and an offset at every motor.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

from bench.diagnosis.base_model import added_effects
from bench.diagnosis.evidence import answer_weight
from bench.diagnosis.ladder import fits_of
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.rounds import with_set
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.significance import wrong_signs
from bench.diagnosis.split_problem import SplitProblem
from bench.effects import EffectInstance
from bench.identification.chosen_band import usual_friction
from bench.identification.identify import fit, with_doubts_checked
from bench.identification.prepare import Prepared
from bench.identification.result import Identification


@dataclass(frozen=True)
class _WithFriction:
    """A model with some effects, and its answer. added: names of usual friction in it that the search did not select;
    searched: whether it has the search's selection.
    """

    model: Prepared
    after: Identification
    added: tuple[str, ...]
    searched: bool

    @property
    def error(self) -> float:
        """Relative error on recordings that were not fitted."""
        return self.after.error.validate or 0.0


def no_worse_than_usual(case: SplitProblem, finding: SearchResult, error: float) -> SearchResult | None:
    """The most probable result that is no worse than the usual friction, with as few additional effects as needed; None
    if the search has one. error: of its answer.
    """
    usual = {
        proposal.name: proposal.instances
        for proposal in finding.last.proposals
        if proposal.name in usual_friction(case.problem.catalogue) and not proposal.absorbed
    }
    every = [instance for instances in usual.values() for instance in instances]
    least = fit(finding.base_model.with_instances(every)).error.validate or 0.0
    if error <= least:
        return None
    best: _WithFriction | None = None
    for together in _more_and_more(finding, usual):
        tried = [_tried(finding, usual, names, searched=searched) for searched, names in together]
        able = [each for each in tried if each.error <= least]
        if able:
            samples = finding.last.system.samples
            best = max(able, key=lambda each: answer_weight(samples, each.model, each.after))
            break
        best = min([*tried, *([best] if best else [])], key=lambda each: each.error)
    return _as_result(case, finding, best) if best is not None and best.error < error else None


def _more_and_more(
    finding: SearchResult, usual: dict[str, tuple[EffectInstance, ...]]
) -> Iterator[list[tuple[bool, tuple[str, ...]]]]:
    """Sets of usual friction, grouped by size: with the search's selection, then without."""
    missing = [name for name in usual if name not in finding.names]
    for size in range(1, len(missing) + 1):
        yield [(True, names) for names in combinations(missing, size)]
    for size in range(1, len(usual) + 1):
        yield [(False, names) for names in combinations(usual, size)]


def _tried(
    finding: SearchResult,
    usual: dict[str, tuple[EffectInstance, ...]],
    names: tuple[str, ...],
    *,
    searched: bool,
) -> _WithFriction:
    """A model with these effects, if their sign is possible."""
    base_model = finding.base_model
    selected = added_effects(base_model, finding.model) if searched else ()
    joining = [instance for name in names for instance in usual[name]]
    model = base_model.with_instances([*selected, *joining])
    after = fit(model)
    every = added_effects(base_model, model)
    kept = [instance for instance in every if not wrong_signs(after, instance)]
    if len(kept) < len(every):
        model = base_model.with_instances(kept)
        after = fit(model)
    after = with_doubts_checked(model, after)
    there = {instance.name for instance in kept}
    before = finding.names if searched else ()
    return _WithFriction(model, after, tuple(n for n in names if n in there and n not in before), searched)


def _as_result(case: SplitProblem, finding: SearchResult, tried: _WithFriction) -> SearchResult:
    """The result of the search with another model."""
    sets = fits_of(case, finding.base_model, tried.model, tried.after)
    barred, last = dict(finding.barred), finding.last
    if not tried.searched:
        barred |= {name: Reason(Because.WORSE_THAN_USUAL) for name in finding.names if name not in sets.names}
        last = with_set(last, [i for i, each in enumerate(last.proposals) if each.name in sets.names])
    return replace(
        finding,
        last=last,
        model=tried.model,
        after=tried.after,
        new=sets.new,
        names=sets.names,
        fits=sets.fits,
        ladder=sets.ladder(case.before, whole=True),
        barred=barred,
        usual=tried.added if tried.searched else (),
    )
