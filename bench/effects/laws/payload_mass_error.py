"""A payload that does not weigh what was declared."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import Effect, EffectParameter
from bench.effects.signals import RobotSignals


@dataclass(frozen=True)
class PayloadMassError(Effect):
    """A payload of mass m + dm, all its declared parameters larger by the same share.

    Valid for a payload whose shape is as declared. If the drive gains are fitted and this is the only payload of known
    mass, the gains absorb it. Source: Khalil, Gautier and Lemoine, "Identification of the payload inertial parameters
    of industrial manipulators", ICRA 2007.
    """

    name = "payload_mass_error"
    law = "τ = dm τ_L / m: a payload of mass m + dm, all its declared parameters larger by the same share."
    symbols = "dm: kg, of either sign; τ_L: torque of the payload as it was declared, with mass m."
    shown_by = "carry a second payload"
    seen = ("current",)
    in_key = ("there with a payload only",)
    parameters = (EffectParameter("dm", "kg"),)
    place = "payload"

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        if robot.payload != joint:
            return np.zeros((len(robot.time), len(robot.joints), 1))
        return (robot.payload_torque / robot.payload_mass)[:, :, None]
