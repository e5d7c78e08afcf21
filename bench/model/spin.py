"""Rods with ball joints at both ends, each in the tree or a loop closure, which may spin about their line.

No loop closure holds such a spin and no motor drives it. With the mass on the line and frictionless joints, no torque
acts about it, so the absolute angular velocity along the line stays zero. Friction or armature in the ball joints
drives the spin, see `bench.model.body_rates`.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.model.bounds import BODIES, MEMORY
from bench.model.geometry import Geometry, Joint


@dataclass(frozen=True)
class Spin:
    """The body on `joint` (a ball or free joint) has no angular velocity along `axis` (3,), in its frame.

    ends: the ball joints of the tree at its other end, each with that axis (3,) in its frame before it turns.
    """

    joint: int
    axis: np.ndarray
    ends: tuple[tuple[int, np.ndarray], ...] = ()


@lru_cache(maxsize=MEMORY.geometries)
def idle_spins(geometry: Geometry) -> tuple[Spin, ...]:
    """The spins of a robot's rods, one equation each."""
    spins = []
    for index, joint in enumerate(geometry.joints):
        if joint.kind in ("ball", "free"):
            carried = _carried(geometry, index)
            axis = _line(geometry, joint, carried)
            if axis is not None:
                spins.append(Spin(index, axis, _ends(geometry, axis, carried)))
    return tuple(spins)


@dataclass(frozen=True)
class _Carried:
    """What moves with a joint: by joint, including itself, its pose (4, 4) in the joint's frame with all slides at zero
    and the axes of these slides, None behind a hinge or ball; and the carrier of each ball joint at its ends.
    """

    places: dict[int, tuple[np.ndarray, list[np.ndarray]] | None]
    ends: dict[int, int]


def _ends(geometry: Geometry, axis: np.ndarray, carried: _Carried) -> tuple[tuple[int, np.ndarray], ...]:
    ends = []
    for ball, holder in carried.ends.items():
        place = carried.places[holder]
        if place is not None:  # always, on a line
            turned = place[0][:3, :3] @ geometry.joints[ball].placement.rotation
            ends.append((ball, turned.T @ axis))
    return tuple(ends)


def _line(geometry: Geometry, joint: Joint, carried: _Carried) -> np.ndarray | None:
    """The line (3,) about which all that a joint carries can turn with closed loops; None if there is none."""
    if geometry.tool is not None and geometry.tool.joint in carried.places:
        return None
    holders = [(end, geometry.joints[ball].placement.translation) for ball, end in carried.ends.items()]
    for loop in geometry.loops:
        inside = [anchor for anchor in (loop.first, loop.second) if anchor.joint in carried.places]
        if len(inside) != 1:
            continue
        if loop.kind == "weld":
            return None
        holders.append((inside[0].joint, inside[0].placement.translation))
    points = [np.zeros(3)] if joint.kind == "ball" else []
    slides: list[np.ndarray] = []
    for holder, place in holders:
        carrier = carried.places[holder]
        if carrier is None:
            return None
        pose, axes = carrier
        points.append((pose @ np.append(place, 1.0))[:3])
        slides += axes
    line = max((second - points[0] for second in points[1:]), key=_length, default=np.zeros(3))
    if _length(line) < BODIES.point:
        return None
    off = [_length(np.cross(line, point - points[0])) / _length(line) for point in points]
    off += [_length(np.cross(line, axis)) for axis in slides]
    return line / _length(line) if max(off) < BODIES.on_line * _length(line) else None


def _carried(geometry: Geometry, index: int) -> _Carried:
    carried = _Carried({index: (np.eye(4), [])}, {})
    for i, joint in enumerate(geometry.joints):
        if joint.parent not in carried.places or i in carried.places:
            continue
        before = carried.places[joint.parent]
        if joint.kind == "ball":
            carried.ends[i] = joint.parent
        elif before is None or joint.kind != "slide":
            carried.places[i] = None
        else:
            place = np.eye(4)
            place[:3, :3], place[:3, 3] = joint.placement.rotation, joint.placement.translation
            pose = before[0] @ place
            carried.places[i] = (pose, [*before[1], pose[:3, :3] @ joint.axis])
    return carried


def _length(vector: np.ndarray) -> float:
    return float(np.linalg.norm(vector))
