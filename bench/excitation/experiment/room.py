"""The room of a motion: all limits together, and whether a trajectory keeps them."""

from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.excitation.bounds import LIMITS
from bench.excitation.experiment.between_samples import extremes
from bench.excitation.experiment.request import (
    Box,
    ExperimentTable,
    assumed_ranges,
    assumed_units,
    check_joint,
    joint_values,
    with_units,
)
from bench.excitation.limits import Limits, keeps_clear, limits_of, passive_room, reached_motion
from bench.model.geometry import Geometry
from bench.model.kinematics import ancestors, end_of, end_point, frames_of, link_of
from bench.model.motion import Motion, motion_of
from bench.model.passive_ranges import passive_ranges
from bench.model.scalars import Rows, Vector
from bench.robot_check.bounds import PLAUSIBLE
from bench.robot_check.home import home_at_range_end
from bench.robot_check.words import detail_of
from bench.scenario.trajectory import FourierTrajectory


@dataclass(frozen=True)
class Room:
    """joint: ranges (n,), largest loop amplification, least singular value of closures; velocity, acceleration, torque
    (n,) of the motors, the last inf if unlimited; assumed: limits that were not given, in words; unranged: joints whose
    ranges are among them.
    """

    home: np.ndarray
    joint: Limits
    velocity: np.ndarray
    acceleration: np.ndarray
    torque: np.ndarray
    boxes: tuple[Box, ...]
    assumed: tuple[str, ...] = ()
    unranged: tuple[str, ...] = ()


def room_of(geometry: Geometry, table: ExperimentTable) -> Room:
    """All limits of a robot and of its user. Raises BenchError naming those that leave no room."""
    joints = geometry.robot.joints
    limits = limits_of(geometry)
    home = geometry.home[geometry.active_configuration] + geometry.active_offset
    low, high = limits.low.copy(), limits.high.copy()
    ranges = {name: joint.limits for name, joint in zip(joints, geometry.active_joints, strict=True)}
    without_range = [name for name, limit in ranges.items() if limit is None]
    for joint, (least, most) in table.position.items():
        check_joint("position", joint, joints)
        j = joints.index(joint)
        if joint in without_range:
            low[j], high[j] = least, most
        else:
            low[j], high[j] = max(low[j], least), min(high[j], most)
        if not low[j] < home[j] < high[j]:
            raise BenchError(
                f"position.{joint}: home, {home[j]:.4g}, from which every motion starts, is not between {least:g} and "
                f"{most:g} with a margin to the end stops"
            )
    for j, joint in enumerate(joints):
        if not low[j] < home[j] < high[j]:
            raise _home_refused(geometry, joint)
    amplification = limits.amplification if table.amplification is None else table.amplification
    limits = replace(limits, low=low, high=high, amplification=amplification)
    unranged = tuple(joint for joint in without_range if joint not in table.position)
    assumed = [assumed_ranges(geometry.robot, unranged, low, high)] if unranged else []

    def rates(key: str, default: np.ndarray, why: str) -> np.ndarray:
        """The given speeds or accelerations (n,), or else the default ones."""
        if (given := getattr(table, key)) is None:
            assumed.append(f"{why} ({with_units(key, default, geometry.robot)})")
            return default
        assumed.extend(assumed_units(key, given, geometry.robot))
        return joint_values(key, given, joints)

    why = f"speed: the joint's range in {LIMITS.crossing:g} s"
    velocity = rates("velocity", (high - low) / LIMITS.crossing, why)
    why = f"acceleration: the largest speed within {LIMITS.reaching:g} s"
    acceleration = rates("acceleration", velocity / LIMITS.reaching, why)
    torque = np.full(len(joints), np.inf)
    if table.torque is not None:
        torque = joint_values("torque", table.torque, joints)
    if table.current is not None:
        by_current = joint_values("current", table.current, joints) * geometry.robot.nominal_gains
        torque = np.minimum(torque, by_current)
    room = Room(home, limits, velocity, acceleration, torque, table.workspace, tuple(assumed), unranged)
    _check_home(geometry, room)
    return room


def _check_home(geometry: Geometry, room: Room) -> None:
    if room.boxes and geometry.tool is None:
        raise BenchError(
            f"workspace: the robot {geometry.robot.name!r} has no [tool] site that could keep it"
        )
    for i, box in enumerate(room.boxes):
        if not all(a < b for a, b in zip(box.low, box.high, strict=True)):
            raise BenchError(f"workspace[{i}]: low must be below high along every axis")
    zero = np.zeros((1, len(room.home)))
    at_home = motion_of(geometry, np.zeros(1), room.home[None], zero, zero)
    if (largest := np.abs(at_home.jacobian).max()) > (most := room.joint.amplification):
        raise BenchError(f"amplification: {most:g} leaves no room, home has {largest:.3g} already")
    for limit in passive_ranges(geometry):
        if not limit.low + PLAUSIBLE.still < limit.at(at_home.q)[0] < limit.high - PLAUSIBLE.still:
            raise _home_refused(geometry, limit.joint)
    for i, box in enumerate(room.boxes):
        point = tool_positions(geometry, at_home)
        if outside(box, point)[0] >= 0.0:
            place = ", ".join(f"{x:.3g}" for x in point[0])
            raise BenchError(f"workspace[{i}]: the tool is at {place} m at home, which that does not allow")


def _home_refused(geometry: Geometry, joint: str) -> BenchError:
    """A home at the end of the range of this joint, in the words of the robot's check."""
    for note in home_at_range_end(geometry):
        return BenchError(f"robot {geometry.robot.name}: {detail_of(note)}")
    return BenchError(
        f"robot {geometry.robot.name}: home is at the end of the range of {joint!r}: motions start at home, put it "
        "further inside"
    )


def tool_positions(geometry: Geometry, motion: Motion) -> np.ndarray:
    """Tool positions along a motion, (N, 3) m."""
    point = tool_point(geometry, np.ascontiguousarray(motion.q.T))
    return np.stack([np.broadcast_to(x, len(motion.time)) for x in point], axis=1)


def tool_point(geometry: Geometry, q: Rows) -> Vector:
    """The tool's position, m, at configurations q (nq,) of numbers, arrays or balls."""
    if geometry.tool is None:
        raise BenchError(f"robot {geometry.robot.name}: there is no [tool] site")
    links = tuple(link_of(i, geometry.joints[i]) for i in ancestors(geometry, geometry.tool.joint))
    return end_point(frames_of(links, q), end_of(geometry.tool))


def outside(box: Box, points: np.ndarray) -> np.ndarray:
    """Violation (N,) m of the box by each of the points (N, 3); negative if the point keeps it."""
    beyond = np.maximum(np.asarray(box.low) - points, points - np.asarray(box.high)).max(axis=1)
    return np.asarray(beyond if box.keep == "inside" else -beyond)


def filled(room: Room, trajectory: FourierTrajectory, *, grow: bool = False) -> FourierTrajectory:
    """Scaled, joint by joint, to keep ranges, speeds and accelerations at all times; grow: enlarged up to them, too."""
    reach = extremes(trajectory)
    up, down = room.joint.high - room.home, room.home - room.joint.low
    shares = np.max(
        [
            (reach.high - room.home) / up,
            (room.home - reach.low) / down,
            reach.velocity / room.velocity,
            reach.acceleration / room.acceleration,
        ],
        axis=0,
    )
    shares = np.where(shares > 0.0, shares, 1.0)
    scale = 1.0 / (shares if grow else np.maximum(shares, 1.0))
    return trajectory.scaled(scale[:, None])


def keeps_joints(room: Room, trajectory: FourierTrajectory) -> bool:
    """Whether ranges, speeds and accelerations are kept at all times, also between samples."""
    reach = extremes(trajectory)
    slack = 1.0 + 1e-9
    width = 1e-9 * (room.joint.high - room.joint.low)
    within = (reach.low >= room.joint.low - width) & (reach.high <= room.joint.high + width)
    slow = (reach.velocity <= room.velocity * slack) & (reach.acceleration <= room.acceleration * slack)
    return bool(np.all(within & slow))


def robot_motion(
    geometry: Geometry,
    room: Room,
    trajectory: FourierTrajectory,
    time: np.ndarray,
    *,
    near: Motion | None = None,
) -> Motion | None:
    """The motion of the whole robot if, at these times, loops close and it keeps off singular poses, passive stops and
    boxes; or None.
    """
    motion = reached_motion(geometry, room.joint.amplification, time, trajectory.evaluate(time), near)
    if motion is None or not keeps_clear(geometry, room.joint, motion):
        return None
    for limit in passive_room(geometry):
        at = limit.at(motion.q)
        if at.min() <= limit.low or at.max() >= limit.high:
            return None
    if room.boxes:
        points = tool_positions(geometry, motion)
        if any(outside(box, points).max() >= 0.0 for box in room.boxes):
            return None
    return motion
