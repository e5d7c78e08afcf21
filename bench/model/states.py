"""Random noise-free states of a robot: closed poses inside the joint limits, and how they move."""

import numpy as np

from bench.model.follow import Pose, advance, home_pose, make_follower
from bench.model.geometry import Geometry
from bench.model.motion import Motion, rates_at

LARGEST_AMPLIFICATION = 20.0  # poses nearer to a singularity say nothing more and cost digits
UNLIMITED = 0.8  # rad or m around home where the file gives no joint limits


def random_motion(geometry: Geometry, count: int, seed: int) -> Motion:
    """`count` states with active positions spread over the reachable part of the joint ranges.

    Every pose is reached from the last one along the closures, so all lie in home's assembly mode.
    Active velocities and accelerations are normal, of unit variance (times 5 for accelerations); behind a gear those
    of what the motor drives.
    """
    random = np.random.default_rng(seed)
    low, high = active_ranges(geometry)
    follower = make_follower(geometry)
    home = pose = home_pose(follower)
    poses: list[Pose] = []
    tries = 0
    while len(poses) < count and tries < 20 * count:
        tries += 1
        target = random.uniform(low, high)
        reached, _ = advance(follower, pose, pose.q[geometry.active_configuration] * 0.3 + target * 0.7)
        if np.abs(reached.amplification).max(initial=0.0) < LARGEST_AMPLIFICATION:
            pose = reached
            poses.append(pose)
        else:
            pose = home if not poses else poses[int(random.integers(len(poses)))]
    states = np.array([pose.q for pose in poses]).reshape(-1, geometry.nq)
    n = len(geometry.active)
    units = follower.units[:, None]
    velocity = units * random.normal(size=(n, len(poses)))
    acceleration = units * 5.0 * random.normal(size=(n, len(poses)))
    return rates_at(geometry, np.arange(len(poses), dtype=float), states, velocity.T, acceleration.T)


def active_ranges(geometry: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper positions (n,) of the active joints in Pinocchio's coordinates."""
    home = geometry.home[geometry.active_configuration]
    by_velocity = {joint.v.start: joint for joint in geometry.joints}
    reach = UNLIMITED * make_follower(geometry).units
    low, high = home - reach, home + reach
    for i, index in enumerate(geometry.active):
        joint = by_velocity[int(index)]
        if joint.limits is not None:
            low[i], high[i] = joint.limits[0] - joint.offset, joint.limits[1] - joint.offset
    return low, high
