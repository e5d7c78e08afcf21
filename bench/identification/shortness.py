"""Recordings that are short compared with the low-pass on positions."""

from collections.abc import Sequence

import numpy as np

from bench.dataset.recording import Recording
from bench.identification.finding import Code, Finding
from bench.identification.tolerances import TOLERANCES
from bench.signals.bounds import BANDS
from bench.signals.settings import FilterSettings


def short_recordings(recordings: Sequence[Recording], settings: FilterSettings) -> list[Finding]:
    """Where the ends that the filter disturbs are more than a twentieth of a fitted recording each."""
    settling = BANDS.settling / settings.position_cutoff
    short = {
        recording.name: float(np.ptp(recording.time))
        for recording in recordings
        if recording.use == "identify"
        and settling > TOLERANCES.findings.disturbed * float(np.ptp(recording.time))
    }
    if not short:
        return []
    numbers = {
        "shortest": min(short.values()),
        "cutoff": settings.position_cutoff,
        "settling": BANDS.settling,
        "needed": settling / TOLERANCES.findings.disturbed,
    }
    return [Finding(Code.SHORT, tuple(short), numbers=numbers)]
