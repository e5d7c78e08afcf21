"""Whether a found effect shows at a joint."""

import numpy as np

from bench.diagnosis.pruning import SHOWS
from bench.effects import EffectInstance
from bench.identification.finding import Unknown
from bench.identification.result import Identification


def shows(result: Identification, instance: EffectInstance) -> bool:
    """Whether an effect has a parameter there that is not zero, and none of an impossible sign.

    Deviations from zero are those at the effect's own shape: an effect that is zero has none, and where size and shape
    go together, as those of a law that is nearly straight, the size by itself says nothing (Davies, "Hypothesis testing
    when a nuisance parameter is present only under the alternative", Biometrika 64, 1977).
    """
    values = result.effect_parameters[instance.effect.name][instance.place]
    parameters = instance.effect.parameters
    if any(
        parameter.positive and values[parameter.name].value < -SHOWS * values[parameter.name].std
        for parameter in parameters
    ):
        return False
    return any(
        abs(values[parameter.name].value) > SHOWS * std
        for parameter, std in zip(parameters, _at_its_shape(result, instance), strict=True)
    )


def _at_its_shape(result: Identification, instance: EffectInstance) -> list[float]:
    """Deviations of an effect's linear parameters where its shape is as it is."""
    rows = {unknown: i for i, unknown in enumerate(result.covariance_rows)}
    name, place = instance.effect.name, instance.place
    values = result.effect_parameters[name][place]
    shape = [
        rows[unknown]
        for parameter in instance.effect.shape
        if (unknown := Unknown("effect", parameter.name, place, name)) in rows
    ]
    shape = [i for i in shape if result.covariance[i, i] > 0.0]
    within = (
        np.linalg.pinv(result.covariance[np.ix_(shape, shape)], hermitian=True) if shape else np.zeros((0, 0))
    )
    found = []
    for parameter in instance.effect.parameters:
        std, at = values[parameter.name].std, rows.get(Unknown("effect", parameter.name, place, name))
        if at is None or not np.isfinite(std):
            found.append(std)
            continue
        along = result.covariance[at, shape]
        found.append(float(np.sqrt(max(std**2 - along @ within @ along, 0.0))))
    return found
