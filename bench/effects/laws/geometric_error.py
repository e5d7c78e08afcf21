"""A length in the kinematic model that is wrong."""

from dataclasses import dataclass

import numpy as np

from bench.effects.body_length import length_of, with_length
from bench.effects.effect import Effect, EffectParameter
from bench.effects.secant import secant
from bench.effects.signals import RobotSignals
from bench.model.geometry import Geometry

SMALLEST, NEAR, LARGEST = 1e-3, 0.01, 0.05  # of the length: step of the difference


@dataclass(frozen=True)
class GeometricError(Effect):
    """A body longer by dl than the model says: tau = tau(L + dl) - tau(L), through the loop closures.

    The column is a difference quotient of the present model's torque. Valid for small errors of one length with which
    the loops still close (otherwise the column is zero), with unchanged joint axes. Source: Khalil and Dombre,
    "Modeling, Identification and Control of Robots", 2002, chapter 11 (geometric calibration); Merlet, "Parallel
    Robots", 2006.
    """

    name = "geometric_error"
    law = "A body longer by dl than the model says: τ = τ(L + dl) − τ(L), through the loop closures."
    symbols = (
        "dl: m, of either sign. L: distance from the body's joint to the farthest joint, loop anchor or "
        "tool on it; these move along the body, or away from its middle where they stand around it (a "
        'platform; the base, by the name "world").'
    )
    shown_by = "move over the whole range"
    seen = ("position",)
    in_key = ("small, and grows with acceleration too",)
    parameters = (EffectParameter("dl", "m"),)
    place = "body"
    depends_on_model = True
    bends = True
    changes_machine = True

    dl: float = 0.0

    def furthest(self, geometry: Geometry, joint: str) -> float:
        return LARGEST * length_of(geometry, joint).length

    def nodes(self, robot: RobotSignals, joint: str) -> tuple[float, float] | None:
        size = NEAR * length_of(robot.geometry, joint).length
        return -size, size

    def machine(self, geometry: Geometry, joint: str, values: np.ndarray) -> Geometry:
        return with_length(geometry, length_of(geometry, joint), float(values[0]))

    def columns(self, robot: RobotSignals, joint: str) -> np.ndarray:
        body = length_of(robot.geometry, joint)

        def change(error: float) -> np.ndarray:
            return robot.torque_change(geometry=with_length(robot.geometry, body, error))

        return secant(robot, self.dl, SMALLEST * body.length, LARGEST * body.length, change)
