"""A motor that moves relative to its joint: the common part of drive flexibility and backlash."""

from dataclasses import dataclass
from typing import ClassVar

import mujoco
import numpy as np
from numpy.typing import ArrayLike

from bench.basics.errors import BenchError
from bench.dataset.mjcf_neutral import neutral
from bench.truth.hidden.base import MOTOR_SIDE, Draft, JointEffect, refuse_fast_swing

NO_MASS = 1e-12  # kg and kg·m²: MuJoCo requires values; the rotor's inertia is its joint's armature


@dataclass(frozen=True)
class DriveTrain(JointEffect):
    """The motor's rotor, and a spring and a damper from it to the joint; the encoder is on the rotor.

    The armature that the joint has in the MJCF is the rotor's. The rotor is a separate body in the
    world, with its axis through its centre of mass, so that only its motor and its spring act on it.
    """

    positive: ClassVar[tuple[str, ...]] = ("stiffness",)
    not_negative = ("damping", "rotor_inertia")
    changes_drives = True

    def add_rotor(
        self, draft: Draft, stiffness: float, damping: float, rotor_inertia: float, play: float
    ) -> None:
        """Add the rotor; while motor and joint are less than play / 2 apart, only damping acts between them.

        stiffness, damping: at the joint.  rotor_inertia: in addition to the joint's armature.
        Raises BenchError if the joint already has such a drive, the rotor has no inertia, or it oscillates too fast.
        """
        spec, name = draft.spec, MOTOR_SIDE + self.joint
        joint = spec.joint(self.joint)
        if spec.joint(name) is not None:
            raise BenchError(f"{self.name}: joint {self.joint} already has a spring or play in its drive")
        inertia = float(joint.armature) + rotor_inertia
        if not inertia > 0:
            raise BenchError(f"{self.name}: joint {self.joint} has no rotor: rotor_inertia must be given")
        refuse_fast_swing(draft, self, stiffness, inertia)
        joint.armature = 0.0
        body = spec.worldbody.add_body(name=name)
        body.explicitinertial = True
        body.mass, body.inertia = NO_MASS, np.full(3, NO_MASS)
        rotor = body.add_joint(neutral(), name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 0.0, 1.0])
        rotor.armature = inertia
        tendon = spec.add_tendon(neutral(), name=name)
        tendon.wrap_joint(name, 1.0)
        tendon.wrap_joint(self.joint, -1.0)
        tendon.stiffness = _linear(tendon.stiffness, stiffness)
        tendon.damping = _linear(tendon.damping, damping)
        tendon.springlength = [-play / 2, play / 2]


def _linear(polynomial: ArrayLike, coefficient: float) -> ArrayLike:
    """A coefficient of MuJoCo's tendon, a polynomial or a number, with a linear term only."""
    return [coefficient, *np.zeros(np.size(polynomial) - 1)] if np.ndim(polynomial) else coefficient
