"""A spring between motor and joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft
from bench.truth.hidden.drive_train import DriveTrain


@dataclass(frozen=True)
class DriveFlexibility(DriveTrain):
    """τ_joint = stiffness (q_m - q) + damping (q̇_m - q̇),  τ_motor = J q̈_m + τ_joint; q_m is measured.

    J: rotor_inertia plus the joint's armature in the MJCF. A belt, a harmonic drive.

    stiffness: N·m/rad or N/m.  damping: N·m·s/rad or N·s/m, at least 0.
    rotor_inertia: kg·m² or kg, 0 if omitted.
    """

    name = "drive_flexibility"
    shares = (0.001, 0.008)
    law = "a spring and a damper between motor and joint, the encoder on the motor"
    stiffness: float
    damping: float
    rotor_inertia: float = 0.0

    def change(self, draft: Draft) -> None:
        self.add_rotor(draft, self.stiffness, self.damping, self.rotor_inertia, 0.0)
