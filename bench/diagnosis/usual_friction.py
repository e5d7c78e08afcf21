"""No answer is worse, on recordings that were not fitted, than the model that everybody tries first: with viscous and
Coulomb friction and an offset at every motor.
"""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from itertools import combinations

from bench.diagnosis.evidence import answer_weight
from bench.diagnosis.ladder import fits_of, ladder_of, with_values_before
from bench.diagnosis.normal_equations import solve_set
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.rounds import Round
from bench.diagnosis.search import score
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.significance import wrong_sign
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import kept_and_new
from bench.diagnosis.values_by_log import values_by_log
from bench.effects import EffectInstance
from bench.identification.chosen_band import usual_friction
from bench.identification.errors_in_variables import with_errors_in_variables_checked
from bench.identification.identify import fit
from bench.identification.impossible_payload import with_possible_payloads
from bench.identification.prepare import Prepared
from bench.identification.result import Identification, relative_error


@dataclass(frozen=True)
class _WithFriction:
    """A model with some effects, and its answer. added: names of the usual friction in it that the search did not
    select; searched: whether what the search selected is in it.
    """

    model: Prepared
    after: Identification
    added: tuple[str, ...]
    searched: bool

    @property
    def error(self) -> float:
        """Relative error on recordings that were not fitted."""
        return judged_error(self.after)


def judged_error(result: Identification) -> float:
    """Relative error on recordings that were not fitted."""
    return relative_error([trace for trace in result.recordings if trace.use == "validate"]) or 0.0


def no_worse_than_usual(case: SplitProblem, finding: SearchResult, error: float) -> SearchResult | None:
    """The most probable result that is no worse than the usual friction, of those with as few effects more as that
    takes; None where the search has one. error: of its answer.
    """
    usual = {
        proposal.name: proposal.instances
        for proposal in finding.last.proposals
        if proposal.name in usual_friction(case.problem.catalogue) and not proposal.absorbed
    }
    every = [instance for instances in usual.values() for instance in instances]
    least = judged_error(fit(finding.base_model.with_instances(every)))
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
    """Sets of usual friction, those of one size together: with what the search selected, then without."""
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
    """A model with these effects where their sign is possible."""
    base_model = finding.base_model
    given = len(base_model.start.effects)
    selected = finding.model.effects[given:] if searched else ()
    joining = [instance for name in names for instance in usual[name]]
    model = base_model.with_instances([*selected, *joining])
    after = fit(model)
    kept = [instance for instance in model.effects[given:] if not wrong_sign(after, instance)]
    if len(kept) < len(model.effects) - given:
        model = base_model.with_instances(kept)
        after = fit(model)
    after = with_errors_in_variables_checked(model, with_possible_payloads(model, after, fit), fit)
    there = {instance.effect.name for instance in kept}
    before = finding.names if searched else ()
    return _WithFriction(model, after, tuple(n for n in names if n in there and n not in before), searched)


def _as_result(case: SplitProblem, finding: SearchResult, tried: _WithFriction) -> SearchResult:
    """The result of the search with another model."""
    base_model, given = finding.base_model, case.start.effects
    kept, new = kept_and_new(tried.model.effects[len(base_model.start.effects) :], given)
    names = tuple(dict.fromkeys(instance.effect.name for instance in new))
    each = dict.fromkeys(instance.request for instance in values_by_log(base_model.start, given))
    without = fit(base_model.with_instances(kept)) if each else case.before
    fits = fits_of(base_model, kept, new, without, tried.after)
    barred, last = dict(finding.barred), finding.last
    if not tried.searched:
        barred |= {name: Reason(Because.WORSE_THAN_USUAL) for name in finding.names if name not in names}
        last = _with_set(last, names)
    return replace(
        finding,
        last=last,
        model=tried.model,
        after=tried.after,
        new=new,
        names=names,
        fits=fits,
        ladder=with_values_before(ladder_of(names, fits), [*each], case.before),
        barred=barred,
        usual=tried.added if tried.searched else (),
    )


def _with_set(last: Round, names: Collection[str]) -> Round:
    """A round whose best set is that of these effects."""
    chosen = [i for i, proposal in enumerate(last.proposals) if proposal.name in names]
    selected = score(last.system, solve_set(last.system, chosen))
    return replace(last, selection=replace(last.selection, selected=selected))
