"""The columns of an effect, checked before they reach a fit."""

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.python_file import MISTAKES, described
from bench.effects.effect import ActuatorEffect
from bench.effects.select import EffectInstance
from bench.effects.signals import RobotSignals
from bench.effects.user_file import user_file_of


def effect_columns(instance: EffectInstance, robot: RobotSignals) -> np.ndarray:
    """Columns (N, n, p) of an effect at its place.

    Raises BenchError if they have another shape or are not finite, or if a user's code fails.
    """
    columns, motors = columns_at_motors(instance, robot)
    if len(motors) == len(robot.joints):
        return columns
    every = np.zeros((len(columns), len(robot.joints), columns.shape[2]))
    every[:, motors] = columns
    return every


def columns_at_motors(instance: EffectInstance, robot: RobotSignals) -> tuple[np.ndarray, np.ndarray]:
    """Columns (N, m, p) of an effect at the motors (m,) that it can affect: its motor, or all.

    Times the effect's share in this recording.

    Raises BenchError as `effect_columns` does.
    """
    effect = instance.effect
    file = user_file_of(effect)
    what = f"effect {instance.request!r}" if file is None else f"{file}: effect {instance.request!r}"
    motors = np.arange(len(robot.joints))
    try:
        alone = isinstance(effect, ActuatorEffect) and type(effect).columns is ActuatorEffect.columns
        if isinstance(effect, ActuatorEffect) and alone and instance.joint in robot.joints:
            motors = motors[[list(robot.joints).index(instance.joint)]]
            columns = np.asarray(effect.motor_column(robot, instance.joint))[:, None]
        else:
            columns = np.asarray(effect.columns(robot, instance.joint))
    except MISTAKES as error:
        if file is None:
            raise
        raise BenchError(described(error, file)) from None
    shape = len(robot.time), len(motors), len(effect.parameters)
    if columns.shape != shape or columns.dtype.kind not in "fiub":
        raise BenchError(f"{what}: its columns have the shape {columns.shape} instead of {shape}")
    if not np.isfinite(columns).all():
        sample, _, parameter = np.argwhere(~np.isfinite(columns))[0]
        raise BenchError(
            f"{what}: its column of {effect.parameters[parameter].name} is not finite at "
            f"t = {robot.time[sample]:.4f} s"
        )
    return columns if not instance.recording else instance.share(robot.log) * columns, motors
