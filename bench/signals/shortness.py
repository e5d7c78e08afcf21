"""Recordings that are short beside the low-pass on positions, and what to say of them."""

from collections.abc import Sequence

import numpy as np

from bench.recording import Recording
from bench.signals.settings import SETTLING, FilterSettings

DISTURBED = 0.05  # of a recording: more at either end is much, and no more is dropped unasked


def shortness_notes(recordings: Sequence[Recording], settings: FilterSettings) -> list[str]:
    """A note where the ends that the filter disturbs are more than a twentieth of a fitted recording each."""
    settling = SETTLING / settings.position_cutoff
    short = {
        one.name: float(np.ptp(one.time))
        for one in recordings
        if one.use == "identify" and settling > DISTURBED * float(np.ptp(one.time))
    }
    if not short:
        return []
    shortest = min(short.values())
    many = len(short) > 1
    note = (
        f"{', '.join(short)} {'last' if many else 'lasts'} {shortest:.2g} s{' and more' if many else ''}, "
        f"{shortest * settings.position_cutoff:.0f} periods of the filter on positions "
        f"({settings.position_cutoff:.3g} Hz), which needs {SETTLING:g} to settle at either end: a tenth of the rows "
        f"and more are disturbed. Record {settling / DISTURBED:.2g} s at least."
    )
    return [note]
