"""Effects whose parameter is at its bound or beyond in a solution, or whose motor's gain has run away with them."""

from collections import Counter

import numpy as np

from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.prepare import Prepared
from bench.identification.solution import Solution


def out_of_bounds(prepared: Prepared, solution: Solution) -> tuple[EffectInstance, ...]:
    """The effects that have a bound and are at it or beyond; gain and effect grow together where the data tell only
    one of them.
    """
    robot = prepared.dataset.robot
    ratios = dict(zip(robot.joints, (solution.gains / robot.nominal_gains).tolist(), strict=True))
    outside, at = [], prepared.layout.size - prepared.layout.effects
    for instance in prepared.effects:
        bounds = [parameter.below for parameter in instance.effect.parameters]
        values = solution.theta[at : at + len(bounds)]
        at += len(bounds)
        if not np.any(np.isfinite(bounds)):
            continue
        wild = (
            prepared.fit_gains and not 1.0 / RULE.gain_far <= ratios.get(instance.joint, 1.0) <= RULE.gain_far
        )
        if wild or np.any(np.abs(values) >= bounds):
            outside.append(instance)
    return tuple(outside)


def staying(prepared: Prepared, solution: Solution, added_from: int) -> list[int]:
    """Which of a model's effects (indices) stay in a search that added those from `added_from` on.

    One that is out of bounds never settles, and takes its motor's gain with it, so that nothing can be determined with
    it. It leaves its place, but not the last place that it has.
    """
    outside = out_of_bounds(prepared, solution)
    remaining = Counter(instance.effect.name for instance in prepared.effects)
    stay = []
    for i, instance in enumerate(prepared.effects):
        if i < added_from or instance not in outside or remaining[instance.effect.name] == 1:
            stay.append(i)
        else:
            remaining[instance.effect.name] -= 1
    return stay
