"""From poses that the motors hold badly to those near by that they hold worst: singular poses between scanned ones."""

import numpy as np

from bench.model.follow import Follower, Pose, advance, close, make_follower
from bench.model.geometry import Geometry
from bench.model.mobility import smallest_singular_values
from bench.model.states import active_ranges
from bench.robot_check.bounds import SINGULARITY

FIRST_STEP, LAST_STEP = 1.0 / 24.0, 1e-5  # of a motor's range


def refined(geometry: Geometry, poses: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float, bool]:
    """The pose (nq,) with the lowest smallest singular value, that value, and whether it counts as singular.

    poses (N, nq): closed ones, home first; values (N,): their smallest singular values. From the worst of them each
    motor is moved to and fro by steps that become smaller, as long as the value falls. A move that the closures
    end is a singular pose, too.
    """
    follower = make_follower(geometry)
    singular = SINGULARITY.singular * float(values[0])
    worst = int(np.argmin(values))
    best = (poses[worst], float(values[worst]), float(values[worst]) < singular)
    for number in _starts(geometry, poses, values):
        pose = close(follower, poses[number])
        if pose is None:
            continue
        q, value, ended = _downhill(follower, pose, float(values[number]))
        if ended or value < best[1]:
            best = (q, value, ended or value < singular)
        if best[2]:
            break
    return best


def _starts(geometry: Geometry, poses: np.ndarray, values: np.ndarray) -> list[int]:
    """Numbers of the worst poses, apart from one another."""
    low, high = active_ranges(geometry)
    places = poses[:, geometry.active_configuration] / (high - low)
    starts: list[int] = []
    for number in np.argsort(values, kind="stable"):
        if all(np.abs(places[number] - places[other]).max() >= SINGULARITY.apart for other in starts):
            starts.append(int(number))
        if len(starts) == SINGULARITY.starts:
            break
    return starts


def _downhill(follower: Follower, pose: Pose, value: float) -> tuple[np.ndarray, float, bool]:
    """The pose (nq,) at the bottom, its smallest singular value, and whether the closures ended on the way."""
    geometry = follower.geometry
    low, high = active_ranges(geometry)
    index = geometry.active_configuration
    step, ended = FIRST_STEP, False
    for _ in range(SINGULARITY.descent):
        if step < LAST_STEP:
            break
        changes = np.concatenate((np.diag(high - low), np.diag(low - high)))
        targets = np.clip(pose.q[index] + step * changes, low, high)
        reached = [advance(follower, pose, target) for target in targets]
        ended |= any(share < 1.0 for _, share in reached)
        values = smallest_singular_values(geometry, np.array([moved.q for moved, _ in reached]))
        lowest = int(np.argmin(values))
        if values[lowest] < value:
            pose, value = reached[lowest][0], float(values[lowest])
        else:
            step /= 2.0
    return pose.q, value, ended
