"""The columns of which an effect's are the sum: its columns, or in a search of two that are worked out once."""

from dataclasses import replace

import numpy as np

from bench.effects import EffectInstance, RobotSignals
from bench.identification.tolerances import TOLERANCES


def made_of(signals: RobotSignals, instance: EffectInstance) -> list[tuple[EffectInstance, float]]:
    """The effects of whose columns an effect's are the sum, with their shares: itself, or in a search of two about its
    nodes; of none where its value is that of another recording.
    """
    if instance.recording:
        share = instance.share(signals.log)
        return (
            [
                (effect_instance, share * factor)
                for effect_instance, factor in made_of(signals, instance.everywhere())
            ]
            if share
            else []
        )
    nodes = instance.effect.nodes(signals, instance.joint) if signals.expands else None
    if nodes is None:
        return [(instance, 1.0)]
    ((name, value),) = instance.effect.about_values().items()
    furthest = TOLERANCES.shapes.expansion * nodes[1]
    share = (float(np.clip(value, -furthest, furthest)) - nodes[0]) / (nodes[1] - nodes[0])
    low, high = (replace(instance, effect=instance.effect.about({name: node})) for node in nodes)
    return [(low, 1.0 - share), (high, share)]
