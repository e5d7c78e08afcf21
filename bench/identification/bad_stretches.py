"""Where currents are far from the model, so that the robust estimator lets them count little."""

from collections.abc import Sequence

import numpy as np

from bench.identification.finding import Code, Finding
from bench.identification.observation import Observation

LITTLE = 0.1  # of what a row counts that fits
FEWEST = 5  # rows of a stretch
BRIDGED = 3  # rows between two stretches that are one
MOST = 8  # stretches that are reported, the longest


def bad_stretches(
    observations: Sequence[Observation], row_weights: np.ndarray, joints: Sequence[str]
) -> list[Finding]:
    """A finding for each stretch of a recording in which a motor's current counts little, in the order of the logs.

    row_weights (M, n): what every row of all recordings counts, 1 where it fits. Rows of a joint at standstill are no
    finding.
    """
    findings: list[tuple[int, Finding]] = []
    start = 0
    for observation in observations:
        of_recording = row_weights[start : start + len(observation.time)]
        start += len(observation.time)
        for j, joint in enumerate(joints):
            little = np.flatnonzero((of_recording[:, j] < LITTLE) & observation.moving[:, j])
            for part in np.split(little, np.flatnonzero(np.diff(little) > BRIDGED) + 1):
                if len(part) >= FEWEST:
                    numbers = {
                        "start": float(observation.time[part[0]]),
                        "end": float(observation.time[part[-1]]),
                    }
                    findings.append(
                        (len(part), Finding(Code.BAD_STRETCH, (joint, observation.name), numbers=numbers))
                    )
    longest = sorted(range(len(findings)), key=lambda i: -findings[i][0])[:MOST]
    return [findings[i][1] for i in sorted(longest)]
