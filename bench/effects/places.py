"""Places of effects in a robot."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from functools import cached_property

from bench.effects.body_length import lengths
from bench.effects.effect import ActuatorEffect, Effect, Place
from bench.model.geometry import Geometry
from bench.model.reaction import undetermined_by


@dataclass(frozen=True)
class Places:
    """Names of all that can have an effect: joints with and without a motor, bodies with a length, payloads.

    passive: hinges and slides; balls: ball joints, which some effects of passive joints can have, too. redundant:
    joints with a motor that do not move independently. geometry: determines `bearing`.
    """

    actuator: tuple[str, ...]
    passive: tuple[str, ...]
    body: tuple[str, ...]
    payload: tuple[str, ...]
    redundant: tuple[str, ...] = ()
    balls: tuple[str, ...] = ()
    geometry: Geometry | None = field(default=None, compare=False, repr=False)

    @cached_property
    def bearing(self) -> tuple[str, ...]:
        """The passive joints whose force the motion determines."""
        geometry = self.geometry
        return tuple(
            name
            for name in self.passive
            if geometry is not None and not undetermined_by(geometry, geometry.joint_index(name))
        )

    @property
    def names(self) -> frozenset[str]:
        """All of them."""
        return frozenset(
            (*self.actuator, *self.redundant, *self.passive, *self.balls, *self.body, *self.payload)
        )

    def where(self, effect: Effect) -> tuple[str, ...]:
        """Places of an effect. At a redundant motor, only effects on its motor's torque that need no model."""
        alone = isinstance(effect, ActuatorEffect) and type(effect).columns is ActuatorEffect.columns
        more = self.redundant if alone and not effect.depends_on_model else ()
        if effect.place == "passive" and effect.in_balls:
            more = self.balls
        if effect.place == "robot" and self.geometry is not None:
            more = tuple(effect.in_joints_of(self.geometry))
        return (*self.of(effect.place), *more)

    def effect_at(self, effect: Effect, place: str) -> Effect:
        """The effect in its form at one of its places."""
        if effect.place != "robot" or not place or self.geometry is None:
            return effect
        return effect.in_joints_of(self.geometry)[place]

    def of(self, place: Place) -> tuple[str, ...]:
        """Places for effects of that kind; one empty name for the whole robot."""
        if place == "bearing":  # slow, and rarely needed
            return self.bearing
        everywhere: dict[Place, tuple[str, ...]] = {
            "actuator": self.actuator,
            "passive": self.passive,
            "body": self.body,
            "payload": self.payload,
            "robot": ("",),
        }
        return everywhere[place]


def places_in(geometry: Geometry, payloads: Iterable[str]) -> Places:
    """The places of a robot; payloads: those of known mass, by name."""
    return Places(
        actuator=tuple(actuator.joint for actuator in geometry.robot.actuators),
        passive=passive_joints(geometry),
        body=tuple(lengths(geometry)),
        payload=tuple(payloads),
        redundant=tuple(actuator.joint for actuator in geometry.robot.redundant),
        balls=tuple(joint.name for joint in geometry.joints if joint.kind == "ball"),
        geometry=geometry,
    )


def passive_joints(geometry: Geometry) -> tuple[str, ...]:
    """Hinges and slides without a motor, by name."""
    active = {int(index) for index in (*geometry.active, *geometry.redundant)}
    return tuple(
        joint.name
        for joint in geometry.joints
        if joint.kind in ("hinge", "slide") and joint.v.start not in active
    )
