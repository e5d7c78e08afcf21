"""A rough guess of standard parameters from geometry alone, for the torques of a planned motion."""

import numpy as np

from bench.model.bounds import BODIES
from bench.model.geometry import Geometry


def guessed_parameters(geometry: Geometry) -> np.ndarray:
    """Standard parameters (10 * joints,) of equal bars from each joint to what it carries.

    A body's bar ends at the mean of the joints and loop anchors that are fixed to it; if none is away from its joint,
    the bar is short and along the joint frame's x axis.
    """
    parameters = np.zeros(10 * len(geometry.joints))
    for index, _ in geometry.bodies:
        ends = [joint.placement.translation for joint in geometry.joints if joint.parent == index]
        anchors = [anchor for loop in geometry.loops for anchor in (loop.first, loop.second)]
        if geometry.tool is not None:
            anchors.append(geometry.tool)
        ends += [anchor.placement.translation for anchor in anchors if anchor.joint == index]
        bar = np.mean(ends, axis=0) if ends else np.zeros(3)
        if np.linalg.norm(bar) < BODIES.shortest:
            bar = bar + np.array([BODIES.shortest, 0.0, 0.0])
        square = float(bar @ bar)
        mass = BODIES.mass
        inertia = mass * (square * np.eye(3) - np.outer(bar, bar)) / 3.0 + mass * 0.02 * square * np.eye(3)
        parameters[10 * index : 10 * index + 10] = np.concatenate(
            ([mass], mass * bar / 2.0, inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]])
        )
    return parameters
