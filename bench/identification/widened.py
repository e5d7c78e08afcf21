"""Deviations that other answers to the same data ask for."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.identification.result import Identification


def gains_widened(result: Identification, others: Sequence[Identification]) -> Identification:
    """The answer with deviations of its gains at least as large as what they differ from in the other answers.

    The covariance of a gain grows with its deviation, its correlations stay.
    """
    joints = list(result.drive_gains)
    gains, times = dict(result.drive_gains), {}
    for joint in joints:
        gain = gains[joint]
        apart = max((abs(other.drive_gains[joint].value - gain.value) for other in others), default=0.0)
        if apart > gain.std > 0.0:
            times[joint] = apart / gain.std
            gains[joint] = replace(gain, std=apart)
    if not times:
        return result
    scale = np.array(
        [times.get(one.place, 1.0) if one.kind == "gain" else 1.0 for one in result.covariance_rows]
    )
    covariance = result.covariance * np.outer(scale, scale)
    return replace(result, drive_gains=gains, covariance=covariance, std_from="models")
