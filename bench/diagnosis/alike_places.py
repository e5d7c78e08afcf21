"""Places at which an identified effect would explain the data as well, as in joints that move alike."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from bench.diagnosis.evidence import Samples, residual_squares
from bench.diagnosis.significance import wrong_sign
from bench.effects import EffectInstance, places_in
from bench.identification.decision import RULE
from bench.identification.identify import fit
from bench.identification.prepare import Prepared, with_effects

AT_MOTORS = ("actuator", "robot", "payload")  # where each has separate equations, or there is one place


def alike_places(
    model: Prepared, identified: Sequence[EffectInstance], samples: Samples
) -> Mapping[str, Mapping[str, tuple[str, ...]]]:
    """For every effect, by name, and each of its places: others, at which a model with it is hardly less probable.

    identified: effects of the model. Those in motors are omitted: each motor has a separate current.
    """
    places = places_in(model.model.geometry, model.dataset.weighed)
    there = {(instance.effect.name, instance.joint) for instance in model.effects}
    least = residual_squares(model, 0.0).weight(samples) - RULE.undecided
    by_effect: dict[str, dict[str, tuple[str, ...]]] = {}
    for instance in identified:
        effect = instance.effect
        if effect.place in AT_MOTORS or instance.recording:
            continue
        others = [
            joint
            for joint in places.where(effect)
            if (effect.name, joint) not in there and _as_probable(model, instance, joint, samples, least)
        ]
        if others:
            by_effect.setdefault(effect.name, {})[instance.joint] = tuple(others)
    return by_effect


def _as_probable(
    model: Prepared, instance: EffectInstance, joint: str, samples: Samples, least: float
) -> bool:
    """Whether the model with an effect moved to another place is that probable, and no sign is impossible there."""
    moved = replace(instance, joint=joint, request=f"{instance.effect.name}:{joint}")
    effects = [moved if each == instance else each for each in model.effects]
    there = with_effects(model, effects)
    return residual_squares(there, 0.0).weight(samples) > least and not wrong_sign(fit(there), moved)
