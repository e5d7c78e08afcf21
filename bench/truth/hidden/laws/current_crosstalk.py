"""A torque from the currents of the other motors; not in the catalogue of effects."""

from dataclasses import dataclass

from bench.basics.errors import BenchError
from bench.truth.hidden.base import Draft, JointEffect, JointMovement, Law, Parameters, Signals, Sizes, rms


@dataclass(frozen=True)
class CurrentCrosstalk(JointEffect):
    """c · (sum of the torques of the other motors): drives that share a supply or a shield.

    c: dimensionless, either sign (1/m or m between a hinge and a slide).
    """

    name = "current_crosstalk"
    law = "c · (sum of the torques of the other motors)"
    needs = "motors"
    in_catalogue = False
    c: float

    def change(self, draft: Draft) -> None:
        if len(draft.robot.driven) < 2:
            raise BenchError(f"{self.name}: the robot {draft.robot.name!r} has one motor only")

    @staticmethod
    def torque(p: Parameters, s: Signals) -> Law:
        return lambda: p["c"] * (s.all_torques.sum(axis=1, keepdims=True) - s.torque)

    @staticmethod
    def sized(j: JointMovement, share: float) -> Sizes:
        if not rms(j.other_torques) > 0:
            raise BenchError("current_crosstalk: the robot has one motor only")
        return {"c": share * rms(j.torque) / rms(j.other_torques)}
