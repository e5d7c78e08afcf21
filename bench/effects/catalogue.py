"""Find effects by name."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.effects.constant_offset import ConstantOffset
from bench.effects.coulomb_friction import CoulombFriction
from bench.effects.effect import Effect
from bench.effects.viscous_friction import ViscousFriction
from bench.errors import BenchError

CATALOGUE: dict[str, Effect] = {
    "constant_offset": ConstantOffset(),
    "coulomb_friction": CoulombFriction(),
    "viscous_friction": ViscousFriction(),
}


@dataclass(frozen=True)
class EffectInstance:
    """An effect at one joint (empty: the whole robot); `request` is how the user named it."""

    effect: Effect
    joint: str
    request: str


def places_of(effect: Effect, actuated: Sequence[str], passive: Sequence[str]) -> tuple[str, ...]:
    """The joints at which an effect can sit; one empty name for an effect of the whole robot."""
    if effect.place == "robot":
        return ("",)
    return tuple(actuated if effect.place == "actuator" else passive)


def select_effects(
    requests: Sequence[str],
    actuated: Sequence[str],
    passive: Sequence[str] = (),
    catalogue: Mapping[str, Effect] = CATALOGUE,
) -> tuple[EffectInstance, ...]:
    """Effects named as EFFECT (at every joint where it can sit) or EFFECT:JOINT, in the order given.

    Raises BenchError that names an unknown effect or joint, or an effect given twice for one joint.
    """
    instances: list[EffectInstance] = []
    for request in requests:
        name, _, joint = request.partition(":")
        if name not in catalogue:
            raise BenchError(f"unknown effect {name!r}; known: {', '.join(catalogue)}")
        effect = catalogue[name]
        places = places_of(effect, actuated, passive)
        if joint and joint not in places:
            known = ", ".join(places) or "none"
            raise BenchError(f"effect {request!r}: no joint {joint!r} where it can sit; there are: {known}")
        if not places:
            raise BenchError(f"effect {request!r}: the robot has no joint without a motor")
        for at in [joint] if joint else places:
            if any(one.effect.name == name and one.joint == at for one in instances):
                raise BenchError(f"effect {name!r} is given twice for joint {at!r}")
            instances.append(EffectInstance(effect, at, request))
    return tuple(instances)
