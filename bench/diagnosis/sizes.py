"""How large an effect is at each motor."""

import numpy as np

from bench.identification.prepare import Prepared
from bench.identification.result import Identification


def sizes_of(model: Prepared, result: Identification, effect: str) -> dict[str, float]:
    """RMS torque of an effect at each motor over the fitted recordings, N*m or N; nothing where it is not there."""
    at = 0
    joints = list(model.dataset.robot.joints)
    total = None
    for instance in model.effects:
        size = len(instance.effect.parameters)
        if instance.effect.name == effect:
            quantities = result.effect_parameters[effect][instance.place]
            values = np.array([quantities[parameter.name].value for parameter in instance.effect.parameters])
            torque = np.concatenate([seen.effects[:, :, at : at + size] @ values for seen in model.fitted])
            total = torque if total is None else total + torque
        at += size
    if total is None:
        return {}
    rms = np.sqrt((total**2).mean(axis=0))
    return {joint: float(value) for joint, value in zip(joints, rms, strict=True) if value > 0}
