"""The equations of motions that are logged once more: where only the currents are new, only these are filtered."""

from dataclasses import replace

import numpy as np

from bench.dataset.dataset import Dataset
from bench.identification.prepare import Prepared
from bench.identification.standstill import interpolated
from bench.signals.decimation import decimate
from bench.signals.processing import trim
from bench.signals.settings import choose_settings, signal_bands


def with_other_currents(prepared: Prepared, dataset: Dataset) -> Prepared | None:
    """What `prepare` makes of a dataset whose recordings are all fitted, from another one with the same positions.

    None where it would make something else: other positions, recordings or filters, effects, redundant motors.
    """
    before = [measured.recording for measured in prepared.measured]
    recordings = dataset.recordings
    if prepared.effects or dataset.robot.redundant or len(recordings) != len(before):
        return None
    for recording, known in zip(recordings, before, strict=True):
        same = recording.use == known.use == "identify" and recording.payload == known.payload
        if not same or recording.extra or not np.array_equal(recording.position, known.position):
            return None
    positions = [recording.position for recording in recordings]
    currents = [recording.current for recording in recordings]
    bands = signal_bands(positions, currents, recordings[0].rate)
    settings = prepared.settings
    if choose_settings(positions, currents, recordings[0].rate, bands) != settings:
        return None
    measured = tuple(
        replace(entry, recording=recording, current=trim(recording.current, settings))
        for entry, recording in zip(prepared.measured, recordings, strict=True)
    )
    observations = tuple(
        replace(observation, current=decimate(interpolated(entry.current, entry.gaps), settings.decimation))
        for observation, entry in zip(prepared.observations, measured, strict=True)
    )
    return replace(
        prepared, dataset=dataset, measured=measured, observations=observations, bands=bands, kept={}
    )
