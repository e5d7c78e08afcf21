"""Which effects of the catalogue a model lacks, judged on recordings that were not fitted."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

from bench.basics.deadline import NEVER, Deadline, TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.diagnosis.alike_places import alike_places
from bench.diagnosis.as_good import with_spread_over_models
from bench.diagnosis.base_model import BaseModel, base_model_of
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.differs import differing
from bench.diagnosis.elsewhere import differing_elsewhere, worse_elsewhere
from bench.diagnosis.encoder_noise import encoder_error
from bench.diagnosis.evidence import Samples, answer_squares, answer_weight
from bench.diagnosis.extrapolated import without_extrapolation
from bench.diagnosis.ladder import (
    Fits,
    ends_of_ladder,
    errors_nearly_without,
    errors_without,
    fits_of,
    ladder_of,
    step_of,
)
from bench.diagnosis.mounting import mounted_otherwise
from bench.diagnosis.normal_equations import System
from bench.diagnosis.place_shares import place_shares
from bench.diagnosis.posterior import posterior_of, something_else, with_probability
from bench.diagnosis.pruning import (
    gain_like_effect,
    refused,
    superfluous_effect,
)
from bench.diagnosis.reason import Reason
from bench.diagnosis.result import (
    Diagnosis,
    Differing,
    EffectVerdict,
    LadderStep,
    Superfluous,
    Unfinished,
)
from bench.diagnosis.rounds import Round, first_round, searched, staying
from bench.diagnosis.search import Selection, held_out_error
from bench.diagnosis.sizes import sizes_of
from bench.diagnosis.split import with_held_out_parts
from bench.diagnosis.starting import given_wholly, kept_and_new, leaving, origins_of
from bench.diagnosis.unexplained import excess, unexplained
from bench.diagnosis.values_by_log import (
    Place,
    explains_more,
    leading,
    places_of,
    values_by_log,
    with_common_values,
    with_values_by_log,
)
from bench.diagnosis.verdicts import undecided, verdicts
from bench.diagnosis.where_possible import where_possible
from bench.diagnosis.without_log import without_logs
from bench.effects import EffectInstance
from bench.identification.bandwidth import with_band_checked
from bench.identification.chosen_band import prepare_checked
from bench.identification.errors_in_variables import with_errors_in_variables_checked
from bench.identification.finding import Finding
from bench.identification.findings import with_other_values
from bench.identification.identify import fit
from bench.identification.impossible_payload import with_possible_payloads
from bench.identification.model_averaged import gains_model_averaged
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import Identification, relative_error

NONE_BARRED: Mapping[str, Reason] = {}
OWN_VALUES_TRIED = 3  # sets of values for each recording with which effects are searched


@dataclass(frozen=True)
class SplitProblem:
    """A problem that is diagnosed: in parts to fit and to judge on, its starting model, and that model's fit.

    deadline: after which the best answer so far is given. extrapolated: of rows that are not judged.
    """

    problem: Problem
    held_out: float
    start: Prepared
    before: Identification
    deadline: Deadline = NEVER
    extrapolated: tuple[Finding, ...] = ()


@dataclass(frozen=True)
class SearchResult:
    """The result of a search. new: beyond what the starting model has; names: of their effects; fits: see `fits_of`;
    barred: effects that may not be selected, and why. differs: what differs from run to run, and differently: the
    answer with a value of it for each; compared: whether they are known. unfinished: what the deadline kept from being
    looked at.
    """

    base_model: BaseModel
    last: Round
    model: Prepared
    after: Identification
    new: tuple[EffectInstance, ...]
    names: tuple[str, ...]
    fits: Fits
    ladder: tuple[LadderStep, ...]
    superfluous: tuple[Superfluous, ...]
    barred: Mapping[str, Reason]
    compared: bool = False
    differs: tuple[Differing, ...] = ()
    differently: Identification | None = None
    unfinished: tuple[Unfinished, ...] = ()

    def weight_by(self, samples: Samples) -> float:
        """Log weight of the identified model, its laws as improbable as proposed: see `Samples.log_posterior`."""
        effects = self.model.effects
        return answer_squares(effects, self.after.recordings, self.last.prior_of(effects)).weight(samples)

    def excess(self, case: SplitProblem) -> float:
        """Excess of the identified model: see `unexplained.excess`."""
        recordings = case.problem.dataset.recordings
        return excess(self.after, recordings, partial(encoder_error, self.model))

    def more_probable_than(self, other: "SearchResult", excess: float) -> bool:
        """Whether the identified model is more probable than that of another search, which leaves so much more than
        noise, as a logarithm.
        """
        samples = self.last.system.samples.beyond(excess)
        return self.weight_by(samples) > other.weight_by(samples)


@on_one_thread
def diagnose_with_catalogue(problem: Problem, progress: Progress = SILENT) -> Diagnosis:
    """Compare a model with the data, and find the effects of the catalogue that it lacks, and no law beyond it.

    Evidence is a likelihood ratio on recordings that were not fitted (or, where there are none, on the last
    part of each), with as many samples as are independent of each other. All sets of up to three effects
    compete; each must earn its place.
    """
    case = split_and_fitted(problem, progress)
    finding = search_catalogue(case, progress)
    return band_checked(finding, answered(case, finding, progress))


def split_and_fitted(
    problem: Problem, progress: Progress = SILENT, deadline: Deadline = NEVER
) -> SplitProblem:
    """Set parts aside to judge on, prepare the problem and fit the model as it is, however long that takes."""
    progress.phase("preparing the recordings")
    dataset, held_out = with_held_out_parts(problem.dataset)
    problem = replace(problem, dataset=dataset)
    start = prepare_checked(problem)
    progress.phase("fitting the model as it is")
    start, extrapolated = without_extrapolation(converged(start))
    return SplitProblem(problem, held_out, start, fit(start), deadline, extrapolated)


def search_catalogue(case: SplitProblem, progress: Progress = SILENT) -> SearchResult:
    """Search from the starting model; where values for each recording take most of a motor's error away, of fitted
    recordings or of others, together with them.

    One value for all recordings, where it differs, moves the gains and looks like other effects. Values for each are
    part of the answer where, with the effects identified with them, they explain clearly more of parts that are not
    fitted, no less of other recordings with values of theirs, and still differ. After the deadline the best so far is
    the answer.
    """
    plain = _search_with_values(case, case.start, case.before, progress)
    if case.deadline.passed:
        return replace(plain, unfinished=(*plain.unfinished, Unfinished.OWN_VALUES))
    plain = _compared(case, plain)
    result, tried = plain, list[frozenset[Place]]()
    while len(tried) < OWN_VALUES_TRIED:
        wanted = places_of(result.differs)
        if not leading(result.differs):
            wanted |= differing_elsewhere(result.model, result.after, case.problem.catalogue)
            if wanted == places_of(result.differs):
                break
        if wanted in tried:
            break
        tried.append(wanted)
        start = with_values_by_log(case.start, wanted, case.problem.catalogue)
        result = _search_with_values(case, start, fit(start), progress)
        if result.unfinished or case.deadline.passed:
            return replace(plain, unfinished=(Unfinished.OWN_VALUES,))
        result = _compared(case, result)
        if places_of(result.differs) == wanted:
            better = explains_more(result.model, plain.model) and not worse_elsewhere(
                result.model, result.after, plain.after, wanted
            )
            return result if better else plain
    return plain


def _search_with_values(
    case: SplitProblem, model: Prepared, before: Identification, progress: Progress
) -> SearchResult:
    """Search from a model that has this model's effects, or some of them: the others are to be identified.

    before: the answer of `model` as it is.
    """
    for start in origins_of(model):
        base_model = base_model_of(start, case.deadline)
        first = first_round(base_model, case.problem.catalogue, progress)
        finding = search_from(case, base_model, first, progress)
        samples = finding.last.system.samples
        if start is model or finding.weight_by(samples) >= answer_weight(samples, model, before):
            break
    return finding


def _compared(case: SplitProblem, finding: SearchResult) -> SearchResult:
    """With the effects that differ by recording in the identified model, or would differ, and the answer with these."""
    model = with_common_values(finding.model, case.start.effects)
    differs, differently = differing(model, case.problem.catalogue)
    return replace(finding, compared=True, differs=differs, differently=differently)


def search_from(
    case: SplitProblem,
    base_model: BaseModel,
    first: Round,
    progress: Progress = SILENT,
    barred: Mapping[str, Reason] = NONE_BARRED,
    *,
    wholly: bool = False,
) -> SearchResult:
    """Search from a first round on until every identified effect is possible and needed.

    barred: effects that may not be selected, and why. After the deadline the best set so far is the answer, brought to
    its end; wholly: TimeUpError is raised instead.
    """
    known, given = dict(barred), case.start.effects
    given_count, cut = len(base_model.start.effects), False
    searching, base_model = base_model, base_model.at_leisure
    given_round = [first]
    del first  # handed on without a name, so that its system is gone before the next is built
    while True:
        this_round = given_round.pop()
        last = (
            staying(base_model, this_round, known)
            if cut
            else searched(searching, this_round, known, progress)
        )
        cut = last.cut
        if cut and wholly:
            raise TimeUpError
        progress.phase("fitting what was found")
        model, after, out = where_possible(base_model, last.model, given, last.system.samples)
        exact = base_model.exactly(last.model) if out else last.model
        if exact is not last.model:  # nothing goes because of what is only nearly so
            model, after, out = where_possible(base_model, exact, given, last.system.samples)
        if not out:
            model, after, superfluous = leaving(base_model, model, after, given, last.system.samples)
            kept, new = kept_and_new(model.effects[given_count:], given)
            names = tuple(dict.fromkeys(instance.effect.name for instance in new))
            each = dict.fromkeys(instance.request for instance in values_by_log(base_model.start, given))
            without = fit(base_model.with_instances(kept)) if each else case.before
            fits = fits_of(base_model, kept, new, without, after)
            ladder = ends_of_ladder(names, fits) if cut else ladder_of(names, fits)
            if not cut:
                error_excess = partial(
                    excess, after, case.problem.dataset.recordings, partial(encoder_error, model)
                )
                out = superfluous_effect(fits, names, last.system.samples)
                out = out or gain_like_effect(fits, names, last.system.samples, after, error_excess)
            if each:
                ladder = (
                    step_of((), case.before.recordings),
                    *(replace(s, effects=(*each, *s.effects)) for s in ladder),
                )
        if not out:
            missed = (Unfinished.SETS,) if cut else ()
            return SearchResult(
                searching,
                last,
                model,
                after,
                new,
                names,
                fits,
                ladder,
                superfluous,
                known,
                unfinished=missed,
            )
        known |= out
        given_round.append(last)


def answered(case: SplitProblem, finding: SearchResult, progress: Progress = SILENT) -> Diagnosis:
    """The result of a search, with a verdict on every effect."""
    progress.phase("judging every effect")
    dataset, start = case.problem.dataset, case.start
    model = finding.model
    after = with_errors_in_variables_checked(model, with_possible_payloads(model, finding.after, fit), fit)
    proposals, system, best = finding.last.proposals, finding.last.system, finding.last.selection
    places: dict[str, tuple[str, ...]] = {}
    for instance in finding.new:
        at = (instance.joint,) if instance.joint else dataset.robot.joints
        places[instance.effect.name] = (*places.get(instance.effect.name, ()), *at)
    scale = _relative(after, system, best)
    unfinished = list(finding.unfinished)
    if Unfinished.SETS in unfinished:
        without = errors_nearly_without(finding.names, finding.last, scale)
    else:
        without = errors_without(finding.names, finding.fits)
    others = differing_elsewhere(model, after, case.problem.catalogue)
    if others:
        after = with_other_values(after, [f"{effect}:{joint}" for effect, joint in sorted(others)])
    remaining = unexplained(after, dataset.recordings, lambda: encoder_error(model))
    if model.fit_gains:
        progress.phase("fitting models that are as good")
        try:
            remains = remaining.significant or remaining.much
            after = with_spread_over_models(finding.base_model, finding.last, model, after, remains=remains)
        except TimeUpError:
            unfinished.append(Unfinished.AS_GOOD)
    if not finding.compared and not unfinished:
        finding = _compared(case, finding)
    if finding.differently is not None and not {each.request for each in finding.differs} <= {*after.effects}:
        # values for each recording explain the data, too
        after = gains_model_averaged(after, [finding.differently])
    ranking = verdicts(
        system, proposals, best, _shown_places(proposals, best, places), scale, remaining, without
    )
    known = {*given_wholly(start.effects, proposals), *_shown_places(proposals, best, {})} - {*places}
    ranking = tuple(
        refused(verdict, finding.barred.get(verdict.effect))
        for verdict in ranking
        if verdict.effect not in known and not (Unfinished.SETS in unfinished and undecided(verdict))
    )
    alike = alike_places(model, finding.new, system.samples)
    shares = place_shares(system, best.selected.fit.chosen, finding.new, alike)
    posterior = posterior_of(system, best, proposals, scale)
    probability = {proposals[i].name: float(posterior.probability[i]) for i in best.singles}
    ranking = tuple(
        with_probability(
            replace(
                verdict,
                size=sizes_of(model, after, verdict.effect),
                alike=alike.get(verdict.effect, {}),
                places=shares.get(verdict.effect, {}),
            ),
            probability.get(verdict.effect),
            posterior.sets,
            finding.names,
        )
        for verdict in ranking
    )
    missing = tuple(verdict.effect for verdict in _by_strength(ranking) if verdict.effect in places)
    return Diagnosis(
        robot=dataset.robot.name,
        held_out=case.held_out,
        missing=missing,
        ladder=finding.ladder,
        ranking=ranking,
        unexplained=remaining,
        before=case.before,
        after=replace(after, findings=(*mounted_otherwise(model), *case.extrapolated, *after.findings)),
        differs=finding.differs,
        superfluous=finding.superfluous,
        unfinished=tuple(unfinished),
        sets=posterior.sets,
        without_logs=without_logs(model, system, best, proposals),
        something_else=something_else(posterior, system.samples, remaining),
    )


def band_checked(finding: SearchResult, diagnosis: Diagnosis) -> Diagnosis:
    """The answer with standard errors that hold what it is in half of the band."""
    return replace(diagnosis, after=with_band_checked(finding.model, diagnosis.after, fit))


def _relative(after: Identification, system: System, selection: Selection) -> float:
    """Error of the converged model over that of its set in the system, so that the errors of sets end where it does."""
    error = relative_error([trace for trace in after.recordings if trace.use == "validate"]) or 0.0
    selected_error = held_out_error(system, selection.selected.fit)
    return error / selected_error if selected_error > 0 else 0.0


def _shown_places(
    proposals: Sequence[Proposal], selection: Selection, places: Mapping[str, tuple[str, ...]]
) -> dict[str, tuple[str, ...]]:
    return {proposals[i].name: places.get(proposals[i].name, ()) for i in selection.selected.fit.chosen}


def _by_strength(ranking: Sequence[EffectVerdict]) -> list[EffectVerdict]:
    return sorted(ranking, key=lambda verdict: -verdict.evidence)
