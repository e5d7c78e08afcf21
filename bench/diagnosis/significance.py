"""Whether an identified effect acts at a joint."""

from collections.abc import Sequence
from math import log, prod

import numpy as np

from bench.basics.chi_squared import exceeded_with
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.finding import Unknown
from bench.identification.result import Identification


def is_significant(result: Identification, instance: EffectInstance) -> bool:
    """Whether an effect has a nonzero parameter there and none of an impossible sign; parameters are also tested
    together, since a wave's significance must not depend on its phase.

    Deviations from zero are taken at the effect's shape: an effect of zero has no shape, and if size and shape are
    correlated, as in a nearly straight law, the size alone is not informative (Davies, "Hypothesis testing when a
    nuisance parameter is present only under the alternative", Biometrika 64, 1977). The best of many shapes fits noise
    better than a given one, so it must bring the prior of an effect plus the logarithm of the number of shapes tried.
    """
    values = result.effect_parameters[instance.name][instance.place]
    parameters = instance.effect.parameters
    if wrong_signs(result, instance):
        return False
    estimates = np.array([values[parameter.name].value for parameter in parameters])
    covariance = _at_its_shape(result, instance)
    if not np.any(np.abs(estimates) > RULE.shows * np.sqrt(np.diag(covariance))):
        return False
    known = np.isfinite(np.diag(covariance)) & (np.diag(covariance) > 0.0)
    if known.sum() < 2:
        return True
    tried = prod(parameter.unlike for parameter in instance.effect.shape)
    needed = 2.0 * (RULE.prior + log(tried)) if tried > 1 else exceeded_with(RULE.by_chance, int(known.sum()))
    inverse = np.linalg.pinv(covariance[np.ix_(known, known)], hermitian=True)
    return bool(estimates[known] @ inverse @ estimates[known] > needed)


def wrong_signs(result: Identification, instance: EffectInstance) -> list[str]:
    """The parameters that must be positive and are clearly negative there."""
    values = result.effect_parameters[instance.name][instance.place]
    return [
        parameter.name
        for parameter in instance.effect.parameters
        if parameter.positive and values[parameter.name].value < -RULE.shows * values[parameter.name].std
    ]


def _at_its_shape(result: Identification, instance: EffectInstance) -> np.ndarray:
    """Covariance (p, p) of an effect's linear parameters at its present shape."""
    rows = {unknown: i for i, unknown in enumerate(result.covariance_rows)}
    name, place = instance.name, instance.place
    values = result.effect_parameters[name][place]

    def rows_of(names: Sequence[str]) -> list[int | None]:
        return [rows.get(Unknown("effect", parameter, place, name)) for parameter in names]

    shape = [i for i in rows_of([parameter.name for parameter in instance.effect.shape]) if i is not None]
    shape = [i for i in shape if result.covariance[i, i] > 0.0]
    stds = np.array([values[parameter.name].std for parameter in instance.effect.parameters])
    covariance = np.diag(stds**2)
    of_parameters = rows_of([parameter.name for parameter in instance.effect.parameters])
    there = [(k, i) for k, i in enumerate(of_parameters) if i is not None and np.isfinite(stds[k])]
    places, at = [k for k, _ in there], [i for _, i in there]
    within = np.linalg.pinv(result.covariance[np.ix_(shape, shape)], hermitian=True)
    along = result.covariance[np.ix_(at, shape)]
    conditional = result.covariance[np.ix_(at, at)] - along @ within @ along.T
    np.fill_diagonal(conditional, np.maximum(stds[places] ** 2 - np.diag(along @ within @ along.T), 0.0))
    covariance[np.ix_(places, places)] = conditional
    return covariance
