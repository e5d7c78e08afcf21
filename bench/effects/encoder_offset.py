"""A joint position whose zero is wrong."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter, step_about
from bench.effects.signals import RobotSignals
from bench.errors import BenchError

SMALLEST, LARGEST = 1e-3, 0.2  # rad (m for a slide, a tenth of that): step of the difference
SLIDE = 0.1


@dataclass(frozen=True)
class EncoderOffset(Effect):
    """A joint that stands at q - offset where q was logged: tau = tau(q - offset) - tau(q), loops closed.

    offset: rad or m, of either sign, constant. The column is a difference quotient of the present model's torque.
    Valid for small offsets; that of the last joint of an open chain turns a body about its joint, which the
    body's own parameters take up. Source: Khalil and Dombre, "Modeling, Identification and Control of Robots",
    2002, chapter 11 (geometric calibration).
    """

    name = "encoder_offset"
    parameters = (EffectParameter("offset", "{angle}"),)
    depends_on_model = True

    offset: float = 0.0

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        unit = 1.0 if robot.joints[joint].rotates else SLIDE
        step = step_about(self.offset, SMALLEST * unit, LARGEST * unit)
        shift = np.zeros((3, *robot.coarse.position.shape))
        at = list(robot.joints).index(joint)
        try:
            shift[0, :, at] = -step
            change = robot.torque_change(shift)
        except BenchError:  # out of reach with this offset
            step = -np.sign(step) * SMALLEST * unit
            shift[0, :, at] = -step
            change = robot.torque_change(shift)
        return (change / step)[:, :, None]
