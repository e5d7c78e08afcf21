"""Whether an identified effect shows at a joint."""

from collections.abc import Sequence
from math import log, prod

import numpy as np

from bench.basics.chi_squared import exceeded_with
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.finding import Unknown
from bench.identification.result import Identification


def is_significant(result: Identification, instance: EffectInstance) -> bool:
    """Whether an effect has a parameter there that is not zero, and none of an impossible sign; several parameters
    together, too, as a wave is no larger where its phase happens to be that of one of them.

    Deviations from zero are those at the effect's shape: an effect that is zero has none, and where size and shape
    go together, as those of a law that is nearly straight, the size by itself says nothing (Davies, "Hypothesis testing
    when a nuisance parameter is present only under the alternative", Biometrika 64, 1977). The best of many shapes fits
    the noise better than any one does, so that it must bring what every effect must, and the logarithm of how many were
    tried.
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
    """Covariance (p, p) of an effect's linear parameters where its shape is as it is."""
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
