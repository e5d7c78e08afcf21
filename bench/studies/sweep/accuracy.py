"""How near an identification came to the truth of its simulation."""

from collections.abc import Sequence

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.identification.result import CurrentSeries, Identification
from bench.signals.decimation import decimate
from bench.signals.processing import trim
from bench.signals.settings import FilterSettings
from bench.truth.machine import true_gains
from bench.truth.simulate import SimulatedRecording, Simulation

Metrics = dict[str, float]


def accuracy(simulation: Simulation, result: Identification) -> Metrics:
    """Errors of gains and currents, one number a name.

    gain_error: largest |gain / true gain - 1|, and gain_error.JOINT with its sign; gain_std.JOINT: relative;
    gain_within.JOINT: 1 where the 95 % interval holds the truth. noise_floor.identify and .validate: what a
    perfect model would leave of the currents, because their noise is all that it cannot know.
    """
    joints = list(result.drive_gains)
    truth = dict(zip(joints, true_gains(simulation.scenario), strict=True))
    metrics: Metrics = {}
    for joint, gain in result.drive_gains.items():
        error = gain.value / truth[joint] - 1.0
        metrics[f"gain_error.{joint}"] = error
        metrics[f"gain_std.{joint}"] = gain.std / truth[joint]
        metrics[f"gain_within.{joint}"] = float(abs(gain.value - truth[joint]) <= WITHIN_95 * gain.std)
    metrics["gain_error"] = max(abs(metrics[f"gain_error.{joint}"]) for joint in joints)
    metrics["scaled_condition"] = result.scaled_condition
    metrics["loop_gap"] = simulation.loop_gap
    for use, value in (("identify", result.error.identify), ("validate", result.error.validate)):
        if value is None:
            continue
        floor = noise_floor(simulation, result.recordings, result.settings, use)
        metrics[f"error.{use}"] = value
        metrics[f"noise_floor.{use}"] = floor
        metrics[f"{use}_error_over_noise_floor"] = value / floor if floor > 0 else float("inf")
    return metrics


def noise_floor(
    simulation: Simulation, series: Sequence[CurrentSeries], settings: FilterSettings, use: str
) -> float:
    """RMS of the currents' noise after the fit's filters, as a share of the RMS of the measured currents."""
    by_name = {trace.name: trace for trace in series if trace.use == use}
    noise = measured = 0.0
    for recording in simulation.recordings:
        name = f"{recording.name}.{simulation.scenario.settings.file_format}"
        if name not in by_name:
            continue
        moving = by_name[name].moving
        every, n = _current_noise(recording, settings), moving.shape[1]
        noise += float((every[:, :n][moving] ** 2).sum())
        if (sharing := by_name[name].sharing) is not None:
            noise += float(moving.sum(axis=0) @ (sharing**2 @ (every[:, n:] ** 2).mean(axis=0)))
        measured += float((by_name[name].measured[moving] ** 2).sum())
    return float(np.sqrt(noise / measured)) if measured else 0.0


def _current_noise(recording: SimulatedRecording, settings: FilterSettings) -> np.ndarray:
    return decimate(trim(recording.log.current - recording.current, settings), settings.decimation)
