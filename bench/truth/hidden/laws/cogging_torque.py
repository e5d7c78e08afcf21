"""A torque that is periodic in the position of the motor, as MuJoCo's cogging."""

from dataclasses import dataclass

import numpy as np

from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Sizes, add_dc_motor, rms


@dataclass(frozen=True)
class CoggingTorque(JointEffect):
    """a · cos(2π q / period) + b · sin(2π q / period), independent of the current: magnets over slots. q: of the
    motor, if there is a spring or play between motor and joint.

    a, b: N·m or N.  period: rad or m.
    """

    name = "cogging_torque"
    law = "a cos(2πq / period) + b sin(2πq / period)"
    positive = ("period",)
    a: float
    b: float
    period: float

    def change(self, draft: Draft) -> None:
        size, phase = np.hypot(self.a, self.b), np.arctan2(-self.a, -self.b)
        add_dc_motor(
            draft, self.name, draft.motor_side(self.joint), cogging=[size, 2 * np.pi / self.period, phase]
        )

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        return {"a": 0.0, "b": np.sqrt(2) * share * rms(j.torque), "period": j.span / 6}
