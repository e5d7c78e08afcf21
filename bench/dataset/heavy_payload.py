"""A payload far heavier than the robot that carries it: grams typed as kilograms."""

from collections.abc import Iterable
from dataclasses import dataclass

from bench.dataset.payload import Payload
from bench.dataset.robot import Robot

HEAVY = 2.0  # times the mass of the robot's bodies: hardly a robot carries that
LIGHT = 5.0  # kg: lighter payloads are nothing to ask about, whatever an MJCF says of its bodies


@dataclass(frozen=True)
class HeavyPayload:
    """What is asked about. mass: as declared, kg; robot_mass: of the robot's bodies in its MJCF, kg."""

    name: str
    mass: float
    robot_mass: float

    @property
    def if_grams(self) -> float:
        """What it weighs if its mass was typed in grams, kg."""
        return self.mass / 1e3

    @property
    def words(self) -> str:
        """The question."""
        return (
            f"the payload {self.name} of {self.mass:g} kg is far heavier than the robot ({self.robot_mass:.3g} kg in "
            f"its MJCF): is that in grams, {self.if_grams:g} kg?"
        )


def heavy_payload(payload: Payload, robot: Robot) -> HeavyPayload | None:
    """Whether a payload's mass is one to ask about; None where it is not, or not known."""
    if payload.mass is None or payload.mass <= LIGHT:
        return None
    robot_mass = float(robot.mjcf_model().body_mass.sum())
    return HeavyPayload(payload.name, payload.mass, robot_mass) if payload.mass > HEAVY * robot_mass else None


def doubted(
    payloads: Iterable[Payload], loads: Iterable[tuple[str | None, Iterable[str]]], robot: Robot
) -> tuple[HeavyPayload, ...]:
    """The payloads whose mass is to be asked about. loads: of every log the payload that it carries, and what it is
    accepted with; a payload that one of them carries with its "mass" accepted is not asked about.
    """
    meant = {payload for payload, accepted in loads if "mass" in accepted}
    heavy = [heavy_payload(payload, robot) for payload in payloads if payload.name not in meant]
    return tuple(payload for payload in heavy if payload is not None)
