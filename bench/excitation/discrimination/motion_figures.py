"""Comparable figures of motions."""

from collections.abc import Sequence

import numpy as np

from bench.excitation.bounds import DISCRIMINATION
from bench.excitation.discrimination.result import MotionFacts

States = Sequence[np.ndarray]
"""Positions, velocities and accelerations of the motors in a motion, (N, n) each."""


def motion_facts(motions: Sequence[States], seconds: float, joints: Sequence[str]) -> dict[str, MotionFacts]:
    """Facts of motions that last `seconds` together, by joint."""
    return {
        joint: _facts([[state[:, j] for state in states] for states in motions], seconds)
        for j, joint in enumerate(joints)
    }


def _facts(motions: Sequence[States], seconds: float) -> MotionFacts:
    position, speed, acceleration = ([states[order] for states in motions] for order in range(3))
    fastest = max(float(np.abs(values).max()) for values in speed)
    count, turning = 0, []
    for v, a in zip(speed, acceleration, strict=True):
        fast = np.flatnonzero(np.abs(v) > DISCRIMINATION.slow * fastest)
        turns = fast[:-1][np.diff(np.sign(v[fast])) != 0]
        count += len(turns)
        turning += np.abs(a[turns]).tolist()
    return MotionFacts(
        low=min(float(values.min()) for values in position),
        high=max(float(values.max()) for values in position),
        speed=fastest,
        acceleration=max(float(np.abs(values).max()) for values in acceleration),
        reversals=count / seconds,
        turning=float(np.median(turning)) if turning else 0.0,
    )
