"""What changes with nothing but the time is asked of long logs alone: in a short one any error looks like that."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.dataset.recording import Recording
from bench.diagnosis.reason import Because, Reason
from bench.effects import Effect
from bench.identification.tolerances import TOLERANCES


def too_short(recordings: Sequence[Recording]) -> float | None:
    """The length in s of the longest log, from when it began, where that is too short for effects of the time alone."""
    fitted = [recording for recording in recordings if recording.use == "identify"]
    ends = {recording.log: float(recording.time[-1]) - recording.began for recording in fitted}
    for recording in recordings:
        if recording.log in ends:
            ends[recording.log] = max(ends[recording.log], float(recording.time[-1]) - recording.began)
    longest = max(ends.values(), default=np.inf)
    return longest if longest < TOLERANCES.laws.of_time else None


def not_asked(
    recordings: Sequence[Recording], catalogue: Mapping[str, Effect], given: Sequence[str]
) -> dict[str, Reason]:
    """Effects that are not asked of such logs, unless they are given, and why: their time constant would be one of the
    recording, not of the machine.
    """
    length = too_short(recordings)
    if length is None:
        return {}
    return {
        name: Reason(Because.TOO_SHORT, (f"{length:.3g} s",))
        for name, effect in catalogue.items()
        if name not in given and any(parameter.scale == "duration" for parameter in effect.shape)
    }
