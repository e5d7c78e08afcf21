"""Probability of each effect: a posterior over all sets of effects that a search has solved."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import exp, isinf, log

import numpy as np
from scipy.special import expit

from bench.diagnosis.candidates import Proposal
from bench.diagnosis.evidence import Samples
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import EffectVerdict, ProbableSet, Unexplained
from bench.diagnosis.search import Selection, held_out_error, log_posterior, possible
from bench.diagnosis.system import System
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES

DECIDED = ("missing", "resembles")


@dataclass(frozen=True)
class Posterior:
    """probability (K,) of each candidate; sets: the leading ones, the most probable first. Both are conditional on a
    set of the catalogue's effects being right. leading: probability of the best set, likewise.
    """

    probability: np.ndarray
    sets: tuple[ProbableSet, ...]
    leading: float


def posterior_of(
    system: System,
    selection: Selection,
    proposals: Sequence[Proposal],
    scale: float = 1.0,
    excess: float = 0.0,
) -> Posterior:
    """Over the possible sets of usable effects that were solved, about one model: see `Samples.log_posterior`.

    Sets that seem more probable than the best are excluded: converged, they were not. scale: of errors, see `verdicts`.
    excess: see `Unexplained.excess`; if it is large, the model is wrong, few samples are independent, and a subset of
    the best set may be more probable.
    """
    best = selection.selected
    usable = {*selection.singles, *best.fit.chosen}
    samples = system.samples.beyond(excess)
    most = log_posterior(system, best.fit, samples)
    weighed = [
        (total, fit)
        for fit in system.solved.values()
        if usable.issuperset(fit.chosen)
        and possible(system, fit)
        and log_posterior(system, fit, system.samples) <= best.total
        and ((total := log_posterior(system, fit, samples)) <= most or {*fit.chosen} < {*best.fit.chosen})
    ]
    weighed.sort(key=lambda pair: -pair[0])
    fits, weights = [fit for _, fit in weighed], shares_of([total for total, _ in weighed])
    probability = np.zeros(len(proposals))
    for fit, weight in zip(fits, weights, strict=True):
        probability[list(fit.chosen)] += weight
    sets = tuple(
        ProbableSet(
            tuple(proposals[k].name for k in fit.chosen), float(weight), scale * held_out_error(system, fit)
        )
        for fit, weight in zip(fits[: TOLERANCES.report.sets], weights, strict=False)
        if weight > TOLERANCES.report.set_probability
    )
    return Posterior(np.minimum(probability, 1.0), sets, float(weights[0]))


def something_else(posterior: Posterior, samples: Samples, unexplained: Unexplained) -> float:
    """Probability that something acts outside all sets: a law with a few more unknowns at each motor that leaves only
    noise, against all sets.

    samples: independent samples (n,) of the motors. unexplained: the answer's residual. Its prior is that of an effect:
    see `DecisionRule.prior`.
    """
    falls = max(unexplained.excess - log(RULE.beyond_noise), 0.0)
    if isinf(falls):
        return 1.0
    motors = len(samples.fitted)
    gained = samples.log_posterior(
        np.full((2, motors), exp(-2.0 * falls)), TOLERANCES.search.smooth_unknowns * motors, RULE.prior
    ) - samples.log_posterior(np.ones((2, motors)), 0, 0.0)
    return float(expit(gained + log(posterior.leading)))


def with_probability(
    verdict: EffectVerdict, probability: float | None, sets: Sequence[ProbableSet], reported: Sequence[str]
) -> EffectVerdict:
    """The verdict with its probability, undecided if sets with and without the effect are probable.

    An uncertain effect of the answer is indistinguishable from effects that leading sets without it have instead; if
    these have none and it is less probable than not, or sets with neither are more probable, it only resembles what is
    missing. Another effect that is not improbable is indistinguishable from those that the leading set with it lacks.
    reported: names of all effects of the answer.
    """
    verdict = replace(verdict, probability=probability)
    if probability is None or probability >= RULE.sure:
        return verdict
    with_it = [probable.effects for probable in sets if verdict.effect in probable.effects]
    if verdict.effect in reported and verdict.verdict in (*DECIDED, "indistinguishable"):
        without = [probable.effects for probable in sets if probable.effects not in with_it]
        names = (*verdict.alternatives, *(name for effects in without for name in effects))
        others = tuple(dict.fromkeys(name for name in names if name not in reported))
        neither = sum(each.probability for each in sets if not {verdict.effect, *others} & {*each.effects})
        if others and neither > RULE.even:
            return replace(verdict, verdict="resembles", alternatives=())
        if others:
            return replace(verdict, verdict="indistinguishable", alternatives=others)
        return replace(verdict, verdict="resembles") if probability < RULE.even else verdict
    if verdict.verdict == "not supported" and probability > 1.0 - RULE.sure and with_it:
        others = tuple(name for name in reported if name not in with_it[0])
        if others:
            why = Reason(Because.AS_GOOD)
            return replace(verdict, verdict="indistinguishable", alternatives=others, why=why)
    return verdict


def shares_of(totals: Sequence[float]) -> np.ndarray:
    """Probabilities (S,) of sets with these log weights."""
    weights = np.exp(np.array(totals) - max(totals))
    return np.asarray(weights / weights.sum())
