"""The ranges of joints without a motor, where the MJCF has some.

A hinge or slide has a range of its position; a ball joint one of the angle, 0 to pi, by which it is turned from the
reference orientation about any axis, of which the MJCF gives the largest. Turned on by an angle, a ball joint's angle
changes by no more than that.
"""

from dataclasses import dataclass

import numpy as np

from bench.model.geometry import Geometry


@dataclass(frozen=True)
class PassiveRange:
    """low, high: between which the joint stays, rad or m, by configurations, in which a hinge or slide is zero at its
    reference; low is -inf for a ball joint. configuration, displacement: where it is among the positions and the
    velocities of the tree. offset: added by MuJoCo.
    """

    joint: str
    configuration: slice
    displacement: slice
    low: float
    high: float
    offset: float = 0.0

    def at(self, q: np.ndarray) -> np.ndarray:
        """Where in its range the joint is, (K,), at configurations (K, nq): its position, or a ball joint's angle."""
        coordinates = q[:, self.configuration]
        if coordinates.shape[1] == 1:
            return np.asarray(coordinates[:, 0])
        return np.asarray(
            2.0 * np.arctan2(np.linalg.norm(coordinates[:, :3], axis=1), np.abs(coordinates[:, 3]))
        )


def passive_ranges(geometry: Geometry) -> tuple[PassiveRange, ...]:
    """Those of hinges, slides and ball joints that no motor of the robot's joints moves."""
    passive = set(geometry.passive.tolist())
    ranges = []
    for joint in geometry.joints:
        if joint.limits is None or joint.v.start not in passive:
            continue
        least = -np.inf if joint.kind == "ball" else joint.limits[0] - joint.offset
        most = max(joint.limits) if joint.kind == "ball" else joint.limits[1] - joint.offset
        ranges.append(PassiveRange(joint.name, joint.q, joint.v, least, most, joint.offset))
    return tuple(ranges)
