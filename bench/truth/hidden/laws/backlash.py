"""Play between motor and joint."""

from dataclasses import dataclass

from bench.truth.hidden.base import Draft
from bench.truth.hidden.drive_train import DriveTrain


@dataclass(frozen=True)
class Backlash(DriveTrain):
    """With d = q_m - q: τ_joint = damping · ḋ + stiffness · (d ∓ play / 2) beyond ± play / 2, no spring within.

    τ_motor = J q̈_m + τ_joint, J: rotor_inertia plus the joint's armature in the MJCF; q_m is measured. Teeth in
    contact are a stiff spring; the damping (oil) also acts without contact.

    play: rad or m, from flank to flank.  stiffness: N·m/rad or N/m.  damping: N·m·s/rad or N·s/m, at least 0.
    rotor_inertia: kg·m² or kg, 0 if omitted.
    """

    name = "backlash"
    shares = (0.002, 0.02)
    law = "play between motor and joint, with flanks as stiff as given"
    positive = ("play", "stiffness")
    play: float
    stiffness: float
    damping: float
    rotor_inertia: float = 0.0

    def change(self, draft: Draft) -> None:
        self.add_rotor(draft, self.stiffness, self.damping, self.rotor_inertia, self.play)
