"""Deviations that other answers to the same data ask for."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from bench.identification.result import Identification


def gains_widened(result: Identification, others: Sequence[Identification]) -> Identification:
    """The answer with deviations of its gains at least as large as what they differ from in the other answers.

    The covariance of a gain grows with its deviation, its correlations stay.
    """
    joints = list(result.drive_gains)
    gains, times = dict(result.drive_gains), {}
    for joint in joints:
        gain = gains[joint]
        apart = max((abs(other.drive_gains[joint].value - gain.value) for other in others), default=0.0)
        if apart > gain.std > 0.0:
            times[joint] = apart / gain.std
            gains[joint] = replace(gain, std=apart)
    if not times:
        return result
    scale = np.array(
        [
            times.get(unknown.place, 1.0) if unknown.kind == "gain" else 1.0
            for unknown in result.covariance_rows
        ]
    )
    covariance = result.covariance * np.outer(scale, scale)
    return replace(result, drive_gains=gains, covariance=covariance, std_from="models")


def all_widened(result: Identification, other: Identification) -> Identification:
    """The answer with standard errors of its gains and parameters at least as large as what they differ by in another
    one of the same equations; correlations stay.
    """
    there = {parameter.name: parameter.value for parameter in other.parameters}
    gains = {
        joint: replace(gain, std=max(gain.std, abs(other.drive_gains[joint].value - gain.value)))
        for joint, gain in result.drive_gains.items()
    }
    parameters = tuple(
        replace(
            parameter,
            std=max(parameter.std, abs(there.get(parameter.name, parameter.value) - parameter.value)),
        )
        for parameter in result.parameters
    )
    wanted = {("gain", joint): gain.std for joint, gain in gains.items()}
    wanted |= {("parameter", parameter.name): parameter.std for parameter in parameters}
    std = np.sqrt(np.maximum(np.diag(result.covariance), 0.0))
    wide = np.array(
        [
            wanted.get((unknown.kind, unknown.place if unknown.kind == "gain" else unknown.name), old)
            for unknown, old in zip(result.covariance_rows, std, strict=True)
        ]
    )
    if not (wide > std).any():
        return result
    known = std > 0.0
    times = np.divide(wide, std, out=np.ones_like(std), where=known)
    covariance = result.covariance * np.outer(times, times)
    covariance[np.diag_indices(len(std))] = np.where(known, np.diag(covariance), wide**2)
    return replace(result, drive_gains=gains, parameters=parameters, covariance=covariance, std_from="models")
