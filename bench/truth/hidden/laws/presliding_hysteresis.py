"""Friction that acts as a spring before sliding, as MuJoCo's LuGre model."""

from dataclasses import dataclass

from bench.truth.hidden.base import (
    Draft,
    JointEffect,
    JointMovement,
    Sizes,
    add_dc_motor,
    refuse_fast_swing,
    rms,
)


@dataclass(frozen=True)
class PreslidingHysteresis(JointEffect):
    """σ z, dz/dt = q̇ - σ |q̇| z / Fc (Dahl): σ (q - q_reversal) at first, Fc · sign(q̇) once it slides.

    LuGre with equal static and Coulomb friction. MuJoCo uses the state of the previous step. A bristle damping of σ
    times the step advances it to the present one, so that the torque is Dahl's at the present position.

    Dahl, "Solid friction damping of mechanical vibrations", AIAA Journal 14 (1976).

    Fc: N·m or N.  stiffness: σ, N·m/rad or N/m; the torque is nearly Fc after 3 Fc / σ.
    """

    name = "presliding_hysteresis"
    law = "Dahl: a spring until it slides with Fc"
    positive = ("Fc", "stiffness")
    Fc: float
    stiffness: float

    def change(self, draft: Draft) -> None:
        refuse_fast_swing(draft, self, self.stiffness, draft.motor_inertia(self.joint))
        lugre = [self.stiffness, self.stiffness * draft.step, self.Fc, self.Fc, 1.0]
        add_dc_motor(draft, self.name, draft.motor_side(self.joint), lugre=lugre)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        """The friction is nearly full after 3/50 of the span."""
        size = share * rms(j.torque)
        return {"Fc": size, "stiffness": size / (0.02 * j.span)}
