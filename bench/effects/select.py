"""Find effects by name, and where they sit."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.effects.catalogue import CATALOGUE
from bench.effects.effect import Effect, Place
from bench.effects.places import Places
from bench.errors import BenchError, meant

NOWHERE: dict[Place, str] = {
    "actuator": "the robot has no motor",
    "passive": "the robot has no joint without a motor",
    "body": "no body of the robot has a length",
    "payload": "the dataset has no payload of known mass",
}


@dataclass(frozen=True)
class EffectInstance:
    """An effect at one place (empty: the whole robot); `request` is how the user named it."""

    effect: Effect
    joint: str
    request: str


def select_effects(
    requests: Sequence[str], places: Places, catalogue: Mapping[str, Effect] = CATALOGUE
) -> tuple[EffectInstance, ...]:
    """Effects named as EFFECT (wherever it can sit) or EFFECT:PLACE, in the order given.

    Raises BenchError that names an unknown effect or place, or an effect given twice for one place.
    """
    instances: list[EffectInstance] = []
    for request in requests:
        name, _, joint = request.partition(":")
        if name not in catalogue:
            raise BenchError(f"unknown effect {name!r}; {meant(name, catalogue, 'known:')}")
        effect = catalogue[name]
        possible = places.of(effect.place)
        if joint and joint not in possible:
            known = ", ".join(one for one in possible if one) or "only the robot as a whole"
            what = "joint" if effect.place in ("actuator", "passive", "robot") else effect.place
            raise BenchError(f"effect {request!r}: no {what} {joint!r} where it can sit; there are: {known}")
        if not possible:
            raise BenchError(f"effect {request!r}: {NOWHERE[effect.place]}")
        for at in [joint] if joint else possible:
            if any(one.effect.name == name and one.joint == at for one in instances):
                raise BenchError(f"effect {name!r} is given twice for {at or 'the robot'!r}")
            instances.append(EffectInstance(effect, at, request))
    return tuple(instances)
