"""How far effects too small to be named may have moved the drive gains.

Each candidate effect is added to the answer with random, not fitted, sizes: at every place the torque of an effect has
the same standard deviation s, so that many places cost no more than one (a random-effects model; Gelman and Hill, "Data
Analysis Using Regression and Multilevel/Hierarchical Models", 2007, chapter 12). The data weight every s, and the
effects against each other and against none.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.diagnosis.candidates import Proposal
from bench.diagnosis.evidence import Samples
from bench.diagnosis.motor_products import products_of_sets
from bench.diagnosis.system import SetFit, System
from bench.identification.bilinear import OnProducts
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class RandomEffect:
    """An effect with random sizes. evidence: logarithm of its marginal likelihood over that of the model without it,
    averaged over s; squares (n,): mean square of its shift of each drive gain.
    """

    evidence: float
    squares: np.ndarray


def unnamed_spread(
    system: System, fit: SetFit, proposals: Sequence[Proposal], samples: Samples
) -> np.ndarray:
    """Standard deviation (n,) of the drive gains due to effects that a set's fit lacks.

    samples: reduced if more than noise remains. Prior: one acts or none does, at even odds, and all are equally
    probable.
    """
    others = [
        i
        for i, proposal in enumerate(proposals)
        if not proposal.absorbed and i not in fit.chosen and len(system.candidates[i].columns)
    ]
    if not others:
        return np.zeros_like(fit.gains)
    columns = np.concatenate([fit.columns, *(system.candidates[i].columns for i in others)])
    values = np.concatenate((fit.values, np.zeros(len(columns) - len(fit.values))))
    normal, right = _weighted_equations(system, fit, samples, columns, values)
    known = np.r_[: len(fit.values), len(columns) : len(normal)]
    inverse = _inverse(normal[np.ix_(known, known)])
    effects, at = [], len(fit.values)
    for i in others:
        added = np.arange(at, at + len(system.candidates[i].columns))
        at += len(added)
        across = normal[np.ix_(known, added)]
        by_unit = -(inverse @ across)[len(fit.values) :]
        own = normal[np.ix_(added, added)] - across.T @ inverse @ across
        score = right[added] - across.T @ (inverse @ right[known])
        lengths = system.candidates[i].lengths
        sizes = np.divide(1.0, lengths, out=np.zeros(len(lengths)), where=lengths > 0.0)
        effects.append(_random_effect(own * np.outer(sizes, sizes), score * sizes, by_unit * sizes))
    weights = np.exp(
        [effect.evidence - max(0.0, *(e.evidence for e in effects)) for effect in effects]
    ) / len(effects)
    none = np.exp(-max(0.0, *(effect.evidence for effect in effects)))
    squares = np.array([effect.squares for effect in effects])
    return np.asarray(np.sqrt(weights @ squares / (none + weights.sum())))


def _weighted_equations(
    system: System, fit: SetFit, samples: Samples, columns: np.ndarray, values: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Normal equations of a set's fit and further columns, in units of the noise of independent samples."""
    start = system.start
    count = samples.fitted * (samples.coarsening / RULE.coarsening)
    precision = np.sqrt(count / np.maximum(fit.by_motor[0], np.finfo(float).tiny))
    products = products_of_sets(
        system.fitted, system.base, [columns[system.base :]], len(columns) - system.base
    )
    point = OnProducts.at(products, start.gains, start.gains_fitted, values[None], fit.gains[None])
    (normal,), (right,) = point.equations(precision)
    return normal, right


def _inverse(normal: np.ndarray) -> np.ndarray:
    """Pseudo-inverse of normal equations, scaled to a unit diagonal."""
    lengths = np.sqrt(np.maximum(normal.diagonal(), np.finfo(float).tiny))
    scaled = normal / np.outer(lengths, lengths)
    inverse = np.linalg.pinv(scaled, rcond=TOLERANCES.rank.products, hermitian=True)
    return np.asarray(inverse / np.outer(lengths, lengths))


def _random_effect(own: np.ndarray, score: np.ndarray, by_unit: np.ndarray) -> RandomEffect:
    """A random effect from the information on its k sizes (k, k), their score (k,), and the change of the gains per
    unit of each (n, k).
    """
    information, turned = np.linalg.eigh(own)
    information = np.maximum(information, 0.0)
    if information[-1] <= 0.0:
        return RandomEffect(-np.inf, np.zeros(len(by_unit)))
    score, by_unit = turned.T @ score, by_unit @ turned
    least, most = TOLERANCES.search.random_sizes
    variance = (np.geomspace(least, most, TOLERANCES.search.random_steps) ** 2 / information[-1])[:, None]
    shrunk = variance / (1.0 + variance * information)
    log_likelihood = 0.5 * (shrunk * score**2 - np.log1p(variance * information)).sum(axis=1)
    weights = np.exp(log_likelihood - log_likelihood.max())
    evidence = float(np.log(weights.mean()) + log_likelihood.max())
    squares = shrunk @ (by_unit**2).T + ((shrunk * score) @ by_unit.T) ** 2
    return RandomEffect(evidence, weights @ squares / weights.sum())
