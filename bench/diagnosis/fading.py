"""Effects of time alone are searched only in long logs: in a short log, any error looks like one."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.dataset.recording import Recording
from bench.diagnosis.reason import Because, Reason
from bench.effects import Effect
from bench.identification.tolerances import TOLERANCES


def too_short(recordings: Sequence[Recording]) -> float | None:
    """Length in s of the longest log, from its start, if it is too short for effects of time alone."""
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
    """Effects that are not searched in such logs, unless given, and why: their time constant would be that of the
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
