"""Comparable figures of motions."""

from collections.abc import Sequence

import numpy as np

from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.result import MotionFacts
from bench.identification.filtered import Measured
from bench.scenario.trajectory import FourierTrajectory


def recorded_facts(measured: Sequence[Measured], joints: Sequence[str]) -> dict[str, MotionFacts]:
    """Facts of recordings, by joint."""
    return {
        joint: _facts(
            [measurement.position[:, j] for measurement in measured],
            [measurement.velocity[:, j] for measurement in measured],
            [measurement.acceleration[:, j] for measurement in measured],
            sum(float(np.ptp(measurement.time)) for measurement in measured),
        )
        for j, joint in enumerate(joints)
    }


def planned_facts(trajectory: FourierTrajectory, joints: Sequence[str]) -> dict[str, MotionFacts]:
    """Facts of a trajectory, by joint."""
    time = np.arange(int(trajectory.duration * DISCRIMINATION.rate) + 1) / DISCRIMINATION.rate
    position, velocity, acceleration = trajectory.evaluate(time)
    return {
        joint: _facts([position[:, j]], [velocity[:, j]], [acceleration[:, j]], trajectory.duration)
        for j, joint in enumerate(joints)
    }


def _facts(
    position: Sequence[np.ndarray],
    velocity: Sequence[np.ndarray],
    acceleration: Sequence[np.ndarray],
    seconds: float,
) -> MotionFacts:
    speed = max(float(np.abs(values).max()) for values in velocity)
    count, turning = 0, []
    for v, a in zip(velocity, acceleration, strict=True):
        fast = np.flatnonzero(np.abs(v) > DISCRIMINATION.slow * speed)
        turns = fast[:-1][np.diff(np.sign(v[fast])) != 0]
        count += len(turns)
        turning += np.abs(a[turns]).tolist()
    return MotionFacts(
        low=min(float(values.min()) for values in position),
        high=max(float(values.max()) for values in position),
        speed=speed,
        acceleration=max(float(np.abs(values).max()) for values in acceleration),
        reversals=count / seconds,
        turning=float(np.median(turning)) if turning else 0.0,
    )
