"""What may be wrong with positions along which the loops cannot be closed: a sign, or two exchanged columns."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.sentence import or_list
from bench.model.geometry import Geometry
from bench.model.motion import path_of


def closes_otherwise(
    geometry: Geometry, time: np.ndarray, position: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray
) -> str:
    """The changes of positions (N, n) with which the loops close at all times, in words; "" without any.

    Each sign, and each exchange of two joints that both turn or both slide, is tried. Of those with which loops close,
    as they may in a mirrored motion, the ones that come nearest to the home position count, within a factor of two.
    velocity, acceleration (N, n).
    """
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    possible: list[tuple[float, str]] = []
    for words, order, signs in _changes(geometry):
        changed = [signs * values[:, order] for values in (position, velocity, acceleration)]
        try:
            path_of(geometry, time, *changed)
        except BenchError:
            continue
        possible.append((float(np.abs(changed[0] - home).max(axis=1).min()), words))
    if not possible:
        return ""
    nearest = min(distance for distance, _ in possible)
    return (
        f"; they close with {or_list([words for distance, words in possible if distance <= 2.0 * nearest])}"
    )


def _changes(geometry: Geometry) -> Iterator[tuple[str, list[int], np.ndarray]]:
    """In words, the joint whose position each gets, and its sign."""
    joints = geometry.robot.joints
    kinds = [joint.kind for joint in geometry.active_joints]
    every = list(range(len(joints)))
    for j, joint in enumerate(joints):
        signs = np.where(np.arange(len(joints)) == j, -1.0, 1.0)
        yield f"the other sign of position.{joint} (import with `--scale position.{joint}=-1`)", every, signs
    for a, b in combinations(every, 2):
        if kinds[a] == kinds[b]:
            order = every.copy()
            order[a], order[b] = b, a
            yield f"position.{joints[a]} and position.{joints[b]} exchanged", order, np.ones(len(joints))
