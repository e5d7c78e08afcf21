"""Where currents are far from the model, so that the robust estimator lets them count little."""

from collections.abc import Sequence

import numpy as np

from bench.identification.finding import Code, Finding
from bench.identification.observation import Observation
from bench.identification.tolerances import TOLERANCES


def bad_stretches(
    observations: Sequence[Observation], row_weights: np.ndarray, joints: Sequence[str]
) -> list[Finding]:
    """A finding for each stretch of a recording in which a motor's current counts little, in the order of the logs.

    row_weights (M, n): what every row of all recordings counts, 1 where it fits. Rows of a joint at standstill are no
    finding.
    """
    bounds = TOLERANCES.findings
    findings: list[tuple[int, Finding]] = []
    start = 0
    for observation in observations:
        of_recording = row_weights[start : start + len(observation.time)]
        start += len(observation.time)
        for j, joint in enumerate(joints):
            little = np.flatnonzero((of_recording[:, j] < bounds.bad_weight) & observation.moving[:, j])
            for part in np.split(little, np.flatnonzero(np.diff(little) > bounds.bridged_rows) + 1):
                if len(part) >= bounds.bad_rows:
                    numbers = {
                        "start": float(observation.time[part[0]]),
                        "end": float(observation.time[part[-1]]),
                    }
                    findings.append(
                        (len(part), Finding(Code.BAD_STRETCH, (joint, observation.name), numbers=numbers))
                    )
    longest = sorted(range(len(findings)), key=lambda i: -findings[i][0])[: TOLERANCES.report.stretches]
    return [findings[i][1] for i in sorted(longest)]
