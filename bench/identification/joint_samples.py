"""What an effect at an actuated joint may look at when it looks for its shape."""

import numpy as np

from bench.effects import EffectInstance, JointSamples
from bench.identification.partial_regression import PartialRegression
from bench.identification.prepare import Prepared


def joint_samples(
    prepared: Prepared, instance: EffectInstance, partial: PartialRegression
) -> tuple[JointSamples, ...]:
    """What an effect at an actuated joint may look at when it looks for its shape; nothing for the others."""
    names = list(prepared.dataset.robot.joints)
    if instance.joint not in names:
        return ()
    j = names.index(instance.joint)
    error = -partial.remainder[:, j] / partial.weights[j]
    travel = np.ptp(np.concatenate([one.position[:, j] for one in prepared.fitted]))
    found, start = [], 0
    for one in prepared.fitted:
        own = next(seen for seen in prepared.measured if seen.recording.name == one.name)
        found.append(
            JointSamples(
                position=one.position[:, j],
                velocity=one.velocity[:, j],
                motor_torque=one.current[:, j] * prepared.present.gains[j],
                error=error[start : start + len(one.time)] * one.moving[:, j],
                duration=float(own.time[-1] - own.time[0]),
                speed=float(prepared.present.speeds[j]),
                travel=float(travel),
                band=prepared.settings.band(own.recording.rate),
                rotates=prepared.signals[0].joints[instance.joint].rotates,
            )
        )
        start += len(one.time)
    return tuple(found)
