"""The ranges of joints without a motor, if the MJCF has any.

A hinge or slide has a range of its position; a ball joint has a largest angle (0 to pi) of rotation from the reference
orientation, about any axis. A further rotation changes a ball joint's angle by no more than its angle.
"""

from dataclasses import dataclass

import numpy as np

from bench.model.geometry import Geometry


@dataclass(frozen=True)
class PassiveRange:
    """low, high: bounds, rad or m, in the tree's coordinates, in which a hinge or slide is zero at its reference; low
    is -inf for a ball joint. configuration, displacement: its indices among the positions and the velocities of the
    tree. offset: added by MuJoCo.
    """

    joint: str
    configuration: slice
    displacement: slice
    low: float
    high: float
    offset: float = 0.0

    def at(self, q: np.ndarray) -> np.ndarray:
        """The joint's position, or a ball joint's angle, (K,), at configurations (K, nq)."""
        coordinates = q[:, self.configuration]
        if coordinates.shape[1] == 1:
            return np.asarray(coordinates[:, 0])
        return np.asarray(
            2.0 * np.arctan2(np.linalg.norm(coordinates[:, :3], axis=1), np.abs(coordinates[:, 3]))
        )


def passive_ranges(geometry: Geometry) -> tuple[PassiveRange, ...]:
    """Those of hinges, slides and ball joints without a motor."""
    passive = set(geometry.passive.tolist())
    ranges = []
    for joint in geometry.joints:
        if joint.limits is None or joint.v.start not in passive:
            continue
        least = -np.inf if joint.kind == "ball" else joint.limits[0] - joint.offset
        most = max(joint.limits) if joint.kind == "ball" else joint.limits[1] - joint.offset
        ranges.append(PassiveRange(joint.name, joint.q, joint.v, least, most, joint.offset))
    return tuple(ranges)
