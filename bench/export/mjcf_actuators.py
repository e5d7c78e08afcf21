"""Motors of an MJCF whose control is the current reference of the drive."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.dataset.mjcf_neutral import neutral


@dataclass(frozen=True)
class DrivenJoint:
    """A motor: N*m or N per unit of current at its joint, and its load in addition to the motion, N*m or N."""

    joint: str
    gain: float
    offset: float


def set_motors(
    spec: mujoco.MjSpec, compiled: mujoco.MjModel, driven: Sequence[DrivenJoint], changed: list[str]
) -> list[mujoco.MjsActuator]:
    """One motor a joint: the file's where it has one, a new one otherwise.

    A torque at the joint is gain times control, less the offset. Limits of control and keyframes keep the torque that
    they meant; a servo becomes a motor. changed: for messages. Returns the motors in the order of the joints.
    """
    motors = []
    for driven_joint in driven:
        existing = [
            actuator
            for actuator in spec.actuators
            if actuator.target == driven_joint.joint and actuator.trntype == mujoco.mjtTrn.mjTRN_JOINT
        ]
        if not existing:
            motors.append(
                spec.add_actuator(
                    neutral(), name=_free_name(spec, driven_joint.joint), target=driven_joint.joint
                )
            )
            _fill(motors[-1], driven_joint, 1.0)
            continue
        motor, *others = existing
        for other in others:
            changed.append(
                f"actuator {other.name!r} is gone: {motor.name!r} drives joint {driven_joint.joint} too"
            )
            spec.delete(other)
        _refill(motor, compiled, driven_joint, changed)
        motor.name = motor.name or _free_name(spec, driven_joint.joint)
        motors.append(motor)
    for key in spec.keys:
        if len(key.ctrl):
            changed.append(f"keyframe {key.name!r}: its controls are gone, they had other units")
            key.ctrl = []
        if len(key.act):
            key.act = []
    return motors


def _refill(
    motor: mujoco.MjsActuator, compiled: mujoco.MjModel, driven: DrivenJoint, changed: list[str]
) -> None:
    """An actuator of the file with the identified gain; its limits keep their torque."""
    place, gear = motor.id, float(motor.gear[0])
    plain = (
        compiled.actuator_gaintype[place] == int(mujoco.mjtGain.mjGAIN_FIXED)
        and compiled.actuator_biastype[place] == int(mujoco.mjtBias.mjBIAS_NONE)
        and compiled.actuator_dyntype[place] == int(mujoco.mjtDyn.mjDYN_NONE)
    )
    limits = compiled.actuator_ctrlrange[place].copy()
    limited = bool(compiled.actuator_ctrllimited[place])
    before = float(compiled.actuator_gainprm[place, 0])
    if not plain:
        changed.append(f"actuator {motor.name!r} is a motor now, its control a current: the file had a servo")
    _fill(motor, driven, gear)
    motor.ctrllimited = limited and plain
    motor.ctrlrange = np.sort(limits * before * gear / driven.gain) if limited and plain else [0.0, 0.0]


def _fill(motor: mujoco.MjsActuator, driven: DrivenJoint, gear: float) -> None:
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    motor.dyntype = mujoco.mjtDyn.mjDYN_NONE
    motor.gaintype, motor.biastype = mujoco.mjtGain.mjGAIN_FIXED, mujoco.mjtBias.mjBIAS_AFFINE
    gains, biases = np.zeros(len(motor.gainprm)), np.zeros(len(motor.biasprm))
    gains[0], biases[0] = driven.gain / gear, -driven.offset / gear
    motor.gainprm, motor.biasprm = gains, biases
    motor.ctrllimited = False


def _free_name(spec: mujoco.MjSpec, joint: str) -> str:
    taken = {actuator.name for actuator in spec.actuators}
    return joint if joint not in taken else f"motor:{joint}"
