"""Few samples of a trajectory, whose loop closures are followed one after the other from home."""

from dataclasses import dataclass

import numpy as np

from bench.basics.errors import BenchError
from bench.model.bounds import CLOSURE
from bench.model.follow import Follower, Pose, advance, home_pose, make_follower
from bench.model.geometry import Geometry

Samples = slice | np.ndarray


class NearSingularError(BenchError):
    """At some time the loop closures do not, or hardly, determine the passive joints."""


def of_recording(name: str, error: BenchError) -> BenchError:
    """The same error with the recording's name and a remedy."""
    if isinstance(error, NearSingularError):
        cure = (
            "if the robot was elsewhere, check units, signs and zeros of its positions; if it was there, leave that "
            "part out by `exclude = [[start, end]]` under the file's name in dataset.toml"
        )
        return BenchError(f"{name}: {error}; {cure}")
    return BenchError(f"{name}: {error}")


@dataclass(frozen=True)
class Track:
    """The input: time (N,); of the active joints position as logged, velocity and acceleration, (N, n) each.

    offset (n,): logged positions at the model's zero.
    """

    time: np.ndarray
    logged: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    offset: np.ndarray

    def position(self, samples: Samples | int) -> np.ndarray:
        """Positions of the model's active joints at some of the samples, (K, n)."""
        return np.asarray(self.logged[samples] - self.offset)

    def at(self, samples: Samples) -> "Track":
        """The input at some of the samples."""
        return Track(
            self.time[samples],
            self.logged[samples],
            self.velocity[samples],
            self.acceleration[samples],
            self.offset,
        )


def robot_length(geometry: Geometry) -> float:
    """The largest distance within a link, or from the middle of the base [m], as a unit for a slide's travel.

    Independent of where the base is mounted.
    """
    places = [(joint.parent, joint.placement.translation) for joint in geometry.joints]
    places += [
        (anchor.joint, anchor.placement.translation)
        for loop in geometry.loops
        for anchor in (loop.first, loop.second)
    ]
    lengths = [float(np.linalg.norm(point)) for link, point in places if link >= 0]
    base = np.array([point for link, point in places if link < 0]).reshape(-1, 3)
    lengths.extend(np.linalg.norm(base - base.mean(axis=0), axis=1).tolist())
    return max(*lengths, 0.1)


def travel_of(geometry: Geometry, active: np.ndarray) -> np.ndarray:
    """Travel of the active joints (N, n) up to every sample: (N,), the length of their common path, in rad or robot
    lengths.

    With a gear, the travel of the driven joint.
    """
    slides = {joint.v.start for joint in geometry.joints if joint.kind == "slide"}
    scale = [1.0 / robot_length(geometry) if int(i) in slides else 1.0 for i in geometry.active]
    scale = np.array(scale) / make_follower(geometry).units
    steps = np.abs(np.diff(np.ascontiguousarray(active.T), axis=1))
    return np.append(0.0, np.cumsum(np.linalg.norm(scale[:, None] * steps, axis=0)))


def nodes_along(travel: np.ndarray, furthest: float, stride: int) -> np.ndarray:
    """Samples, with first and last, at most `stride` apart and with at most `furthest` travel between them, if sampling
    allows.
    """
    count = int(np.ceil(travel[-1] / furthest)) + 1
    last = len(travel) - 1
    chosen = np.minimum(np.searchsorted(travel, np.linspace(0.0, travel[-1], count)), last)
    return np.unique(np.concatenate((np.arange(0, last, stride), chosen, [last])))


def followed(geometry: Geometry, track: Track, nodes: np.ndarray, most: float = np.inf) -> np.ndarray:
    """Nearly closed poses (M, nq) at the nodes (sample indices), each reached from the one before. Raises BenchError if
    they cannot be closed, or passive joints certainly move more than `most` times as fast as the motors.
    """
    follower = make_follower(geometry)
    pose = home_pose(follower)
    poses = np.empty((len(nodes), geometry.nq))
    before = -1
    for i, node in enumerate(nodes):
        reached, share = advance(follower, pose, track.position(node), CLOSURE.nearly)
        if share < 1.0:
            reached = _followed_closely(follower, pose, track, range(before + 1, node + 1))
        if np.abs(reached.amplification).max(initial=0.0) > (1.0 + CLOSURE.correction) * most:
            raise NearSingularError(
                f"t = {track.time[node]:.4f} s: a joint of {geometry.robot.name} moves more than {most:.3g} times as "
                "fast as a motor"
            )
        poses[i], pose, before = reached.q, reached, node
    return poses


def _followed_closely(follower: Follower, pose: Pose, track: Track, samples: range) -> Pose:
    """The pose at the last of the samples, reached along all of them when the straight path fails."""
    for sample in samples:
        pose, share = advance(follower, pose, track.position(sample))
        if share < 1.0:
            reached = pose.q[follower.geometry.active_configuration]
            raise _unreachable(follower.geometry, track.time[sample], track.position(sample), reached)
    return pose


def _unreachable(geometry: Geometry, time: float, wanted: np.ndarray, reached: np.ndarray) -> BenchError:
    offset, names = geometry.active_offset, geometry.robot.joints
    at = ", ".join(f"{name} = {value:.4g}" for name, value in zip(names, wanted + offset, strict=True))
    near = ", ".join(f"{value:.4g}" for value in reached + offset)
    return BenchError(
        f"t = {time:.4f} s: the loops of {geometry.robot.name} cannot be closed at {at} "
        f"(singular or out of reach; last closed at {near})"
    )
