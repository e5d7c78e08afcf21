"""Random noise-free states of a robot: closed poses inside the joint limits, and their rates."""

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.shell_word import quoted
from bench.model.bounds import CLOSURE, RANDOM_POSES
from bench.model.follow import Pose, advance, home_pose, make_follower
from bench.model.geometry import Geometry
from bench.model.mobility import column_scales, smallest_singular_values
from bench.model.motion import Motion, rates_at
from bench.model.nodes import NearSingularError


class LoosePosesError(BenchError):
    """In poses within the joint ranges, the loop closures do not, or hardly, determine the passive joints."""


def random_motion(geometry: Geometry, count: int, seed: int) -> Motion:
    """`count` states with active positions spread over the reachable part of the joint ranges.

    Every pose is reached from the last one along the closures, so all lie in home's assembly mode. More are reached
    than returned: those nearest to a singularity are omitted. Active velocities and accelerations are normal, of unit
    variance (times 5 for accelerations); with a gear, those of the driven joint. Raises LoosePosesError.
    """
    random = np.random.default_rng(seed)
    low, high = active_ranges(geometry)
    follower = make_follower(geometry)
    home = pose = home_pose(follower)
    poses: list[Pose] = []
    scales = column_scales(geometry)
    largest = RANDOM_POSES.amplification * scales[follower.passive, None] / scales[geometry.active]
    wanted = round(count / (1.0 - RANDOM_POSES.near_singular)) if geometry.closed else count
    tries = 0
    while len(poses) < wanted and tries < 20 * wanted:
        tries += 1
        target = random.uniform(low, high)
        towards = pose.q[geometry.active_configuration] * 0.3 + target * 0.7
        reached, _ = advance(follower, pose, towards, CLOSURE.nearly)  # `rates_at` closes them to rounding
        if np.all(np.abs(reached.amplification) < largest):
            pose = reached
            poses.append(pose)
        else:
            pose = home if not poses else poses[int(random.integers(len(poses)))]
    states = np.array([pose.q for pose in poses]).reshape(-1, geometry.nq)
    if geometry.closed:
        held = smallest_singular_values(geometry, states)
        states = states[
            np.sort(
                np.argsort(-held, kind="stable")[: round(len(states) * (1.0 - RANDOM_POSES.near_singular))]
            )
        ]
    n = len(geometry.active)
    units = follower.units[:, None]
    velocity = units * random.normal(size=(n, len(states)))
    acceleration = units * 5.0 * random.normal(size=(n, len(states)))
    try:
        return rates_at(geometry, np.arange(len(states), dtype=float), states, velocity.T, acceleration.T)
    except NearSingularError:
        raise LoosePosesError(
            f"robot {geometry.robot.name}: in poses within the joint ranges, the loop closures do not determine the "
            f"passive joints; bench robot check {quoted(geometry.robot.folder)} names the reason"
        ) from None


def active_ranges(geometry: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper positions (n,) of the active joints in Pinocchio's coordinates."""
    home = geometry.home[geometry.active_configuration]
    reach = RANDOM_POSES.unlimited * make_follower(geometry).units
    low, high = home - reach, home + reach
    for i, joint in enumerate(geometry.active_joints):
        if joint.limits is not None:
            low[i], high[i] = joint.limits[0] - joint.offset, joint.limits[1] - joint.offset
    return low, high
