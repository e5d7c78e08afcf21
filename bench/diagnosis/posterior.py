"""How probable each effect is: a posterior over all sets of effects that a search has solved.

Its likelihood is coarsened (Miller and Dunson, "Robust Bayesian inference via coarsening", Journal of the American
Statistical Association 114, 2019): no model is exact, so that evidence does not grow without bound with the length of a
log. A motor's samples count in full where they are few, and never for more than COARSENING of them.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnosis.candidates import Proposal
from bench.diagnosis.normal_equations import SetFit, System
from bench.diagnosis.result import EffectVerdict, ProbableSet
from bench.diagnosis.search import MATERIAL, NEEDED, Found, earned, judged_error, possible, score

COARSENING = -NEEDED / np.log(1.0 - MATERIAL)
"""Independent samples: where they are many, an error that falls by MATERIAL is worth NEEDED nats."""
LEADING = 8  # sets that an answer lists
LOOKED_AT = 100  # sets of largest weight: of these the ones count in which every effect earns its place
EVEN = 0.5  # probability
DECIDED = ("missing", "resembles")
LIKELY = 0.01  # probability of such a set


@dataclass(frozen=True)
class Posterior:
    """probability (K,) of each candidate; sets: the leading ones, the most probable first. Both are of sets of the
    catalogue's effects: what is in no catalogue has no probability here.
    """

    probability: np.ndarray
    sets: tuple[ProbableSet, ...]


def posterior_of(
    system: System, found: Found, proposals: Sequence[Proposal], scale: float = 1.0
) -> Posterior:
    """Over the sets of usable effects that were solved, about one model, and in which every effect earns its place.

    With squares R of motor j, N samples that are independent, fitted and judged, and k unknowns, the logarithm of a
    set's weight is -1/2 sum_j z_j (N_j log R_j + N'_j log R'_j) - 1/2 k log(sum_j z_j N_j), less NEEDED for each
    effect, where z_j = COARSENING / (COARSENING + N_j + N'_j). scale: of errors, see `verdicts`.
    """
    usable = {*found.singles, *found.best.fit.chosen}
    solved = [
        fit for fit in system.solved.values() if usable.issuperset(fit.chosen) and possible(system, fit)
    ]
    order = np.argsort(-_weights(system, solved), kind="stable")[:LOOKED_AT]
    fits = [fit for fit in (solved[i] for i in order) if _stays(system, found, fit)]
    weights = _weights(system, fits)
    probability = np.zeros(len(proposals))
    for fit, weight in zip(fits, weights, strict=True):
        probability[list(fit.chosen)] += weight
    sets = tuple(
        ProbableSet(
            tuple(proposals[k].name for k in fit.chosen),
            float(weight),
            scale * judged_error(system, fit),
        )
        for fit, weight in zip(fits[:LEADING], weights, strict=False)
        if weight > LIKELY
    )
    return Posterior(np.minimum(probability, 1.0), sets)


def with_probability(
    verdict: EffectVerdict, probability: float | None, sets: Sequence[ProbableSet], told: Sequence[str]
) -> EffectVerdict:
    """The verdict with its probability; an effect of the answer that is less probable than not is undecided between it
    and what the leading sets without it have. told: names of all effects of the answer.
    """
    verdict = replace(verdict, probability=probability)
    if (
        verdict.effect not in told
        or probability is None
        or probability >= EVEN
        or verdict.verdict not in DECIDED
    ):
        return verdict
    without = [probable.effects for probable in sets if verdict.effect not in probable.effects]
    others = tuple(dict.fromkeys(name for effects in without for name in effects if name not in told))
    return replace(verdict, verdict="indistinguishable", alternatives=others) if others else verdict


def _stays(system: System, found: Found, fit: SetFit) -> bool:
    return (
        not fit.chosen
        or fit.chosen == found.best.fit.chosen
        or earned(system, score(system, fit, found.empty), found.empty)
    )


def _weights(system: System, fits: Sequence[SetFit]) -> np.ndarray:
    """The probability (S,) of each set."""
    together = system.memory * system.repeats
    fitted, judged = (part.rows_of_motor / together for part in (system.fitted, system.judged))
    share = COARSENING / (COARSENING + fitted + judged)
    squares = np.log(np.array([fit.by_motor for fit in fits]) + np.finfo(float).tiny)  # (S, 2, n)
    likelihood = -0.5 * (squares[:, 0] @ (share * fitted) + squares[:, 1] @ (share * judged))
    unknowns = np.array([len(fit.columns) for fit in fits])
    prior = np.array([NEEDED * len(fit.chosen) + system.prior_of(fit.chosen) for fit in fits])
    logarithm = likelihood - 0.5 * unknowns * np.log(max(float(share @ fitted), 1.0)) - prior
    weights = np.exp(logarithm - logarithm.max())
    return np.asarray(weights / weights.sum())
