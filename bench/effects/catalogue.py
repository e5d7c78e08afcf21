"""Find effects by name: built-in ones, and those of a user's own file."""

from collections.abc import Sequence
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
    """An effect at one actuator; `request` is how the user named it."""

    effect: Effect
    joint: str
    request: str


def select_effects(requests: Sequence[str], joints: Sequence[str]) -> tuple[EffectInstance, ...]:
    """Effects named as EFFECT (at every actuator) or EFFECT:JOINT, in the order given.

    Raises BenchError that names an unknown effect or joint, or an effect given twice for one joint.
    """
    instances: list[EffectInstance] = []
    for request in requests:
        name, _, joint = request.partition(":")
        if name not in CATALOGUE:
            raise BenchError(f"unknown effect {name!r}; known: {', '.join(CATALOGUE)}")
        if joint and joint not in joints:
            raise BenchError(f"effect {request!r}: no actuated joint {joint!r}; joints: {', '.join(joints)}")
        for at in [joint] if joint else joints:
            if any(one.effect.name == name and one.joint == at for one in instances):
                raise BenchError(f"effect {name!r} is given twice for joint {at!r}")
            instances.append(EffectInstance(CATALOGUE[name], at, request))
    return tuple(instances)
