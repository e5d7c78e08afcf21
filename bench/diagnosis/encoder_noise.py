"""The error of the currents that encoder noise alone causes."""

from dataclasses import replace

import numpy as np

from bench.identification.column_errors import perturbed
from bench.identification.effect_columns import robot_signals
from bench.identification.effect_rows import effect_rows
from bench.identification.filtered import measure
from bench.identification.observation import observe
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import modelled_series
from bench.signals.settings import signal_bands

SEED = 20120608


def encoder_error(model: Prepared) -> float:
    """RMS change of the current errors over the RMS of measured currents, on held-out recordings.

    As in `bench.identification.column_errors`, the noise of the positions is read off their spectra above the band of
    the motion, and the same amount is added to them, with a fixed seed; the change of the errors estimates the
    influence of the measured noise.
    """
    _, solution = solved_quickly(model)
    random = np.random.default_rng(SEED)
    change = measured = 0.0
    for seen, rows in zip(model.measured, model.observations, strict=True):
        recording = seen.recording
        if recording.use != "validate":
            continue
        bands = signal_bands([recording.position], [recording.current], recording.rate)
        moved = measure(model.model, perturbed(recording, bands.position_noise, random), model.settings)
        signals = robot_signals(model.model, moved, model.present)
        effects = effect_rows(signals, model.settings.decimation, model.effects)
        before = modelled_series(model, rows, solution)
        after = modelled_series(model, replace(observe(model.model, moved), effects=effects), solution)
        moving = before.moving & after.moving
        change += float((((after.error - before.error) * moving) ** 2).sum())
        measured += float(((before.measured * moving) ** 2).sum())
    return float(np.sqrt(change / measured)) if measured else 0.0
