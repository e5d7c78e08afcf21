"""Distance from a singularity: at home, along straight paths through the joint ranges, and by descent from the worst
poses on them.

With the motors held, the loop closures hold the rest of a parallel robot, unless their Jacobian with respect to the
passive joints loses rank. These singular poses also bound the poses reachable in the assembly mode of home.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from bench.basics.joint_units import units_of_gain, written_position
from bench.model.follow import Follower, Pose, advance, close, home_pose, make_follower
from bench.model.geometry import Geometry, to_mujoco
from bench.model.mobility import column_scales, scaled_jacobians, smallest_singular_values
from bench.model.nodes import robot_length
from bench.model.states import active_ranges
from bench.robot_check.bounds import SINGULARITY
from bench.robot_check.mobility import amplification, weakest_joints
from bench.robot_check.report import Singularity

SEED = 20120601


@dataclass(frozen=True)
class SingularitySweep:
    """Closed poses q (N, nq) on paths from home, and the number of each pose's path (N,).

    ends (P, nq): poses at which paths ended early, singular ones or the end of reach.
    """

    q: np.ndarray
    path: np.ndarray
    ends: np.ndarray


def sweep(geometry: Geometry) -> SingularitySweep:
    """Follow the closures from home along every axis, to corners and random points of the joint ranges.

    Raises BenchError if home is not assembled.
    """
    follower = make_follower(geometry)
    home = home_pose(follower)
    start = home.q[geometry.active_configuration]
    poses, paths, ends = [home.q], [0], []
    for number, target in enumerate(_targets(geometry, start), start=1):
        pose = home
        for step in range(1, SINGULARITY.steps + 1):
            pose, share = advance(follower, pose, start + (target - start) * step / SINGULARITY.steps)
            poses.append(pose.q)
            paths.append(number)
            if share < 1.0:
                ends.append(pose.q)
                break
    return SingularitySweep(np.array(poses), np.array(paths), np.array(ends).reshape(-1, geometry.nq))


def singularity_of(geometry: Geometry, swept: SingularitySweep) -> Singularity:
    """Distance from singularity at home and over a sweep."""
    values = smallest_singular_values(geometry, swept.q)
    singular = np.concatenate((swept.ends, swept.q[_crossings(geometry, swept)]))
    lowest_pose, lowest = swept.q[int(np.argmin(values))], float(values.min())
    if not len(singular):
        lowest_pose, lowest, reached = refined(geometry, swept.q, values)
        singular = lowest_pose[None] if reached else singular
    nearest, travel = None, None
    loose: tuple[str, ...] = ()
    if len(singular):
        q = _shortened(geometry, singular[np.argmin(_distance(geometry, singular))])
        nearest = _positions(geometry, q)
        home = _positions(geometry, geometry.home)
        travel = {name: value - home[name] for name, value in nearest.items()}
        loose = weakest_joints(geometry, q)
    return Singularity(
        length=robot_length(geometry),
        home=float(values[0]),
        amplification=amplification(geometry, geometry.home),
        poses=len(swept.q),
        lowest=lowest,
        lowest_at=_positions(geometry, lowest_pose),
        reach=_reach(geometry, swept),
        singular_at=nearest,
        travel=travel,
        loose=loose,
        units={motor.joint: units_of_gain(motor.gain_unit).position for motor in geometry.robot.actuators},
    )


def _targets(geometry: Geometry, start: np.ndarray) -> list[np.ndarray]:
    low, high = _ranges(geometry)
    n = len(start)
    targets = [np.where(np.arange(n) == joint, ends, start) for joint in range(n) for ends in (low, high)]
    if n > 1 and 2**n <= SINGULARITY.corners:
        targets += [np.array(corner) for corner in itertools.product(*zip(low, high, strict=True))]
    if n > 1:
        random = np.random.default_rng(SEED)
        targets += list(random.uniform(low, high, size=(SINGULARITY.directions, n)))
    return targets


def _ranges(geometry: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper positions (n,) of the active joints; a hinge, behind its gear, at most half a turn from home."""
    low, high = active_ranges(geometry)
    home = geometry.home[geometry.active_configuration]
    turns = np.array([joint.kind == "hinge" for joint in geometry.active_joints])
    turn = np.where(turns, np.pi * make_follower(geometry).units, np.inf)
    return np.maximum(low, home - turn), np.minimum(high, home + turn)


def _crossings(geometry: Geometry, swept: SingularitySweep) -> np.ndarray:
    """Indices of poses with a singularity between them and the pose before on their path; see `_lost_rank`."""
    jacobian = scaled_jacobians(geometry, swept.q)[:, :, geometry.passive]
    before = np.arange(len(swept.q)) - 1
    before[np.flatnonzero(np.diff(swept.path)) + 1] = 0  # a path starts at home
    return np.flatnonzero(_lost_rank(jacobian[before[1:]], jacobian[1:])) + 1


def _shortened(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """A singular pose (nq,) with the motors on which it does not depend back at home."""
    follower, index = make_follower(geometry), geometry.active_configuration
    home = home_pose(follower)
    for motor in index[np.argsort(-np.abs(q[index] - home.q[index]))]:
        without = q.copy()
        without[motor] = home.q[motor]
        reached, share = advance(follower, home, without[index])
        jacobian = scaled_jacobians(geometry, np.array([home.q, reached.q]))[:, :, geometry.passive]
        if share < 1.0 or _lost_rank(jacobian[:1], jacobian[1:]).any():
            q = min(q, reached.q, key=lambda pose: float(_distance(geometry, pose[None])[0]))
    return q


def _lost_rank(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Whether Jacobians (N, m, np) lost rank an odd number of times between the poses before and after: (N,).

    Then J' J, of the Jacobian before and the one after, has a determinant that is not positive.
    """
    return np.asarray(np.linalg.slogdet(before.transpose(0, 2, 1) @ after)[0] <= 0)


def _reach(geometry: Geometry, swept: SingularitySweep) -> dict[str, tuple[float, float]]:
    """Each motor's positions at the ends of the first paths, on which it moves alone, down and up."""
    reach = {}
    for i, name in enumerate(geometry.robot.joints):
        low, high = (swept.q[np.flatnonzero(swept.path == 2 * i + k)[-1]] for k in (1, 2))
        reach[name] = _positions(geometry, low)[name], _positions(geometry, high)[name]
    return reach


def _distance(geometry: Geometry, q: np.ndarray) -> np.ndarray:
    """Travel of the motors (N,) from home to q (N, nq): rad, slides in units of the robot's length."""
    index = geometry.active_configuration
    travel = (q[:, index] - geometry.home[index]) / column_scales(geometry)[geometry.active]
    return np.asarray(np.linalg.norm(travel, axis=1))


def _positions(geometry: Geometry, q: np.ndarray) -> dict[str, float]:
    """Positions of the actuated joints as they are logged, rad or m."""
    qpos = to_mujoco(geometry.joints, q[None])[0]
    return {
        name: written_position(float(qpos[index]))
        for name, index in zip(geometry.robot.joints, geometry.active_configuration, strict=True)
    }


FIRST_STEP, LAST_STEP = 1.0 / 24.0, 1e-5  # of a motor's range


def refined(geometry: Geometry, poses: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, float, bool]:
    """The pose (nq,) with the lowest smallest singular value, that value, and whether it counts as singular.

    poses (N, nq): closed ones, home first; values (N,): their smallest singular values. The search descends from the
    worst poses: each motor moves both ways, the best move is taken while the value falls, and then the step is halved.
    If the closures end a move, the pose counts as singular too.
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
    """Indices of the worst poses, at least `SINGULARITY.apart` from one another."""
    low, high = _ranges(geometry)
    places = poses[:, geometry.active_configuration] / (high - low)
    starts: list[int] = []
    for number in np.argsort(values, kind="stable"):
        if all(np.abs(places[number] - places[other]).max() >= SINGULARITY.apart for other in starts):
            starts.append(int(number))
        if len(starts) == SINGULARITY.starts:
            break
    return starts


def _downhill(follower: Follower, pose: Pose, value: float) -> tuple[np.ndarray, float, bool]:
    """The pose (nq,) at the minimum, its smallest singular value, and whether the closures ended a move."""
    geometry = follower.geometry
    low, high = _ranges(geometry)
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
