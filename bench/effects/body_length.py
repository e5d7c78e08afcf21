"""The lengths of a robot's bodies, and the geometry with one of them changed."""

from dataclasses import dataclass, replace

import numpy as np

from bench.model.geometry import Anchor, Geometry, Placement

WORLD = "world"
NEGLIGIBLE = 1e-6  # m: shorter is no length
ONE_SIDED = 0.5  # of the longest distance: a farther mean gives the body a direction


@dataclass(frozen=True)
class BodyLength:
    """The length of a body: from its joint to the farthest joint, loop anchor or tool that is fixed to it, m.

    center (3,): its joint's position, or for the world the middle of the joints on it. direction (3,): towards the
    points fixed to the body, if these lie to one side, perpendicular to the axis of a hinge; None for a platform or the
    world, which grow in all directions.
    """

    joint: int
    length: float
    center: np.ndarray
    direction: np.ndarray | None

    def moved(self, placement: Placement, change: float) -> Placement:
        """A placement on the body after its length has grown by `change` m."""
        if self.direction is None:
            shift = (placement.translation - self.center) * (change / self.length)
        else:
            shift = self.direction * change
            if np.linalg.norm(placement.translation) < NEGLIGIBLE:
                return placement
        return Placement(placement.rotation, placement.translation + shift)


def lengths(geometry: Geometry) -> dict[str, BodyLength]:
    """The bodies that have a length, by name, the world included."""
    every = {name: _length(geometry, index) for index, name in ((-1, WORLD), *geometry.bodies)}
    return {name: length for name, length in every.items() if length is not None}


def length_of(geometry: Geometry, body: str) -> BodyLength:
    """The length of a body that has one."""
    index = -1 if body == WORLD else next(index for index, name in geometry.bodies if name == body)
    length = _length(geometry, index)
    assert length is not None
    return length


def _length(geometry: Geometry, index: int) -> BodyLength | None:
    points = _fixed_points(geometry, index)
    if not points:
        return None
    center = np.mean(points, axis=0) if index < 0 else np.zeros(3)
    distance = np.linalg.norm(np.array(points) - center, axis=1)
    length = float(distance.max())
    if length < NEGLIGIBLE:
        return None
    mean = np.mean([point for point, far in zip(points, distance, strict=True) if far > NEGLIGIBLE], axis=0)
    one_sided = index >= 0 and np.linalg.norm(mean) > ONE_SIDED * length
    return BodyLength(index, length, center, mean / np.linalg.norm(mean) if one_sided else None)


def with_length(geometry: Geometry, body: BodyLength, change: float) -> Geometry:
    """The geometry with a body longer by `change` m; all that is fixed to it moves along."""

    def moved(anchor: Anchor) -> Anchor:
        if anchor.joint != body.joint:
            return anchor
        return replace(anchor, placement=body.moved(anchor.placement, change))

    joints = tuple(
        replace(joint, placement=body.moved(joint.placement, change))
        if joint.parent == body.joint and joint.kind != "free"
        else joint
        for joint in geometry.joints
    )
    loops = tuple(
        replace(loop, first=moved(loop.first), second=moved(loop.second)) for loop in geometry.loops
    )
    tool = None if geometry.tool is None else moved(geometry.tool)
    return replace(geometry, joints=joints, loops=loops, tool=tool)


def _fixed_points(geometry: Geometry, joint: int) -> list[np.ndarray]:
    """Points of joints, loop anchors and the tool on the body of a joint (-1: the world), (3,) each."""
    points = [
        other.placement.translation
        for other in geometry.joints
        if other.parent == joint and other.kind != "free"
    ]
    anchors = [anchor for loop in geometry.loops for anchor in (loop.first, loop.second)]
    if geometry.tool is not None:
        anchors.append(geometry.tool)
    return points + [anchor.placement.translation for anchor in anchors if anchor.joint == joint]
