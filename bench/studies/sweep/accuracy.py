"""Errors of an identification relative to the truth of its simulation, and the true values of its parameters."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.identification.result import CurrentSeries, Identification
from bench.model.model import IdentificationModel
from bench.model.regressor import moved_parameters, projected_regressor
from bench.model.states import random_motion
from bench.signals.decimation import decimate
from bench.signals.processing import trim
from bench.signals.settings import FilterSettings
from bench.truth.machine import true_gains
from bench.truth.simulate import SimulatedRecording, Simulation

Metrics = dict[str, float]
SEED = 20120605
STATES = 80


def accuracy(simulation: Simulation, result: Identification) -> Metrics:
    """Errors of gains and currents, condition number and loop gap, one number by name.

    gain_error: largest |gain / true gain - 1|, and gain_error.JOINT with its sign; gain_std.JOINT: over the true
    gain; gain_within.JOINT: 1 if the 95 % interval contains the truth. noise_floor.identify and .validate: relative
    error of a perfect model, due only to the noise of the currents.
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


def true_base_parameters(model: IdentificationModel, truth: Mapping[str, Any]) -> np.ndarray:
    """Base parameters (nb,) of the simulated machine, from the contents of its truth file.

    Bodies fixed to others are merged with them. Rotor inertias (armature) are distributed to base parameters by least
    squares at random noise-free states.
    """
    geometry = model.geometry
    standard = np.zeros(10 * len(geometry.joints))
    for name, body in truth["bodies"].items():
        if name not in geometry.body_frames:
            continue
        carrier, frame = geometry.body_frames[name]
        if carrier >= 0:
            standard[10 * carrier : 10 * carrier + 10] += moved_parameters(
                _standard(body), frame.rotation, frame.translation
            )
    motion = random_motion(geometry, STATES, SEED)
    torque = projected_regressor(geometry, motion) @ standard
    for joint in geometry.joints:
        armature = truth["joints"].get(joint.name, {}).get("armature", 0.0)
        if armature:
            torque += motion.jacobian[:, joint.v.start] * (armature * motion.a[:, joint.v.start])[:, None]
    rows = projected_regressor(geometry, motion, model.base.columns)
    scale = np.linalg.norm(rows.reshape(-1, rows.shape[2]), axis=0)
    solution = np.linalg.lstsq(rows.reshape(-1, rows.shape[2]) / scale, torque.reshape(-1))[0]
    return np.asarray(solution / scale)


def _standard(body: Mapping[str, Any]) -> np.ndarray:
    """Standard parameters (10,) about the body frame's origin, from mass, centre of mass and central inertia."""
    xx, yy, zz, xy, xz, yz = body["inertia"]
    central = np.array([0.0, 0.0, 0.0, 0.0, xx, xy, yy, xz, yz, zz])
    mass = np.zeros(10)
    mass[0] = body["mass"]
    shifted = moved_parameters(mass, np.eye(3), np.asarray(body["center_of_mass"], dtype=float))
    return central + shifted


def true_values(model: IdentificationModel, truth: Mapping[str, Any]) -> dict[str, float]:
    """True drive gains by joint and base parameters by name, for comparison with an identification."""
    values = {joint: float(gain["true"]) for joint, gain in truth["drive_gains"].items()}
    names = model.base.names
    return values | dict(zip(names, map(float, true_base_parameters(model, truth)), strict=True))
