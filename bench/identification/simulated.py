"""The observation matrix at the motion of a twin that follows the measured one: the motion, and not its noise."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.dataset.recording import Recording
from bench.identification.effect_columns import robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import Measured, measure
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.observation import observe
from bench.identification.prepare import Prepared
from bench.identification.tolerances import TOLERANCES
from bench.signals.settings import signal_bands


def simulated_columns(prepared: Prepared) -> np.ndarray:
    """[Phi, kappa] (M, n, p + 1) at the twin's motion, the rows of all fitted recordings in the order of the stack.

    The twin follows the measured positions up to twice the band of the motion, read off the spectra, whatever the
    filters of the fit.
    """
    fitted = [measurement for measurement in prepared.measured if measurement.recording.use == "identify"]
    recordings = [measurement.recording for measurement in fitted]
    cutoff = followed_band(recordings)
    parts = []
    for measurement in fitted:
        settings = replace(prepared.settings, position_cutoff=min(cutoff, 0.4 * measurement.recording.rate))
        motion = replace(measure(prepared.model, measurement.recording, settings), gaps=measurement.gaps)
        parts.append(columns_at(prepared, motion))
    return np.concatenate(parts)


def followed_band(recordings: Sequence[Recording]) -> float:
    """Up to which frequency the twin follows the recordings, Hz."""
    bands = signal_bands(
        [recording.position for recording in recordings],
        [recording.current for recording in recordings],
        recordings[0].rate,
    )
    return TOLERANCES.motion.twin_band * bands.motion


def columns_at(prepared: Prepared, measured: Measured) -> np.ndarray:
    """[Phi, kappa] (M, n, p + 1) of one recording at some motion, filtered and decimated as the fit's."""
    layout, payloads = prepared.layout, prepared.dataset.payloads
    signals = robot_signals(prepared.model, measured, prepared.present)
    effects = effect_rows(signals, prepared.settings.decimation, prepared.effects)
    rows = replace(observe(prepared.model, measured), effects=effects)
    phi, kappa = regressor_rows(rows, layout), known_rows(rows, payloads)
    return np.concatenate((phi, kappa[:, :, None]), axis=2)
