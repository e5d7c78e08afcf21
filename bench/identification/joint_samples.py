"""The signals that an effect at an actuated joint may use to search its shape."""

import numpy as np

from bench.effects import EffectInstance, JointSamples
from bench.identification.prepare import Prepared
from bench.signals.decimation import decimated_indices


def stands_still(prepared: Prepared, instance: EffectInstance) -> bool:
    """Whether an effect acts at a motor without fitted rows: it never moves, or is excluded."""
    joints = prepared.dataset.robot.joints
    if instance.joint not in joints:
        return False
    j = joints.index(instance.joint)
    return not any(observation.moving[:, j].any() for observation in prepared.fitted)


def joint_samples(
    prepared: Prepared, instance: EffectInstance, lacks: np.ndarray
) -> tuple[JointSamples, ...]:
    """The signals that an effect at an actuated joint may use to search its shape; () for others.

    lacks (M, n): torque that the model lacks at every motor, in the order of the stack.
    """
    names = list(prepared.dataset.robot.joints)
    if instance.joint in prepared.signals[0].redundant:
        return _at_redundant(prepared, instance.joint, lacks)
    if instance.joint not in names:
        return ()
    j = names.index(instance.joint)
    error = lacks[:, j]
    travel = np.ptp(np.concatenate([observation.position[:, j] for observation in prepared.fitted]))
    samples, start = [], 0
    for observation in prepared.fitted:
        measured = next(seen for seen in prepared.measured if seen.recording.name == observation.name)
        samples.append(
            JointSamples(
                position=observation.position[:, j],
                velocity=observation.velocity[:, j],
                motor_torque=observation.current[:, j] * prepared.present.gains[j],
                error=error[start : start + len(observation.time)] * observation.moving[:, j],
                duration=float(measured.time[-1] - measured.time[0]),
                speed=float(prepared.present.speeds[j]),
                travel=float(travel),
                band=prepared.settings.band(measured.recording.rate),
                rotates=prepared.signals[0].joints[instance.joint].rotates,
            )
        )
        start += len(observation.time)
    return tuple(samples)


def _at_redundant(prepared: Prepared, joint: str, lacks: np.ndarray) -> tuple[JointSamples, ...]:
    """The same at a redundant motor; its error is the torque there that best explains the others' errors."""
    index = prepared.model.geometry.redundant[list(prepared.signals[0].redundant).index(joint)]
    samples, start = [], 0
    travel = np.ptp(np.concatenate([seen.redundant[joint].position for seen in prepared.signals]))
    for seen, measured, observation in zip(
        prepared.signals, prepared.measured, prepared.observations, strict=True
    ):
        if observation.use != "identify":
            continue
        at = decimated_indices(len(measured.time), prepared.settings.decimation)
        signals, follow = seen.redundant[joint], seen.tree.jacobian[at, index]
        rows = slice(start, start + len(at))
        error = lacks[rows] * observation.moving
        power = (follow**2).sum(axis=1)
        samples.append(
            JointSamples(
                position=signals.position[at],
                velocity=signals.velocity[at],
                motor_torque=signals.motor_torque[at],
                error=np.divide(
                    (follow * error).sum(axis=1), power, out=np.zeros_like(power), where=power > 0.0
                ),
                duration=float(measured.time[-1] - measured.time[0]),
                speed=signals.speed,
                travel=float(travel),
                band=prepared.settings.band(measured.recording.rate),
                rotates=signals.rotates,
            )
        )
        start += len(at)
    return tuple(samples)
