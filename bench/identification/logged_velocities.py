"""Velocities that a controller logged with its positions: taken where they agree with these and have less noise."""

from collections.abc import Mapping, Sequence

import numpy as np

from bench.dataset.recording import Recording, velocity_column
from bench.identification.finding import Code, Finding
from bench.signals.logged_velocity import LoggedVelocity, compared_velocity
from bench.signals.settings import FilterSettings


def logged_velocities(
    recording: Recording, joints: Sequence[str], settings: FilterSettings
) -> dict[str, LoggedVelocity]:
    """How the velocities that a recording has compare with its positions, by joint."""
    compared = {}
    for j, joint in enumerate(joints):
        velocity = recording.extra.get(velocity_column(joint))
        if velocity is None or not np.all(np.isfinite(velocity)) or not np.any(velocity):
            continue
        compared[joint] = compared_velocity(recording.position[:, j], velocity, recording.rate, settings)
    return compared


def taken_velocities(
    recording: Recording, joints: Sequence[str], compared: Mapping[str, LoggedVelocity]
) -> np.ndarray | None:
    """The logged velocities (N, n) that are taken, NaN for the other joints; None where there is none."""
    taken = [joint for joint, velocity in compared.items() if velocity.taken]
    if not taken:
        return None
    velocities = np.full(recording.position.shape, np.nan)
    for joint in taken:
        velocities[:, list(joints).index(joint)] = recording.extra[velocity_column(joint)]
    return velocities


def velocity_noise(joints: Sequence[str], compared: Mapping[str, LoggedVelocity]) -> np.ndarray:
    """Density (n,) of the noise of every velocity that is taken, unit^2/s^2/Hz; infinite for the others."""
    return np.array(
        [
            compared[joint].density if joint in compared and compared[joint].taken else np.inf
            for joint in joints
        ]
    )


def velocity_findings(of: Sequence[tuple[str, Mapping[str, LoggedVelocity]]]) -> list[Finding]:
    """Which velocities are taken as logged, and which are not what the positions say. of: recordings by name."""
    taken = [(joint, velocity) for _, every in of for joint, velocity in every.items() if velocity.taken]
    findings = []
    if taken:
        quieter = float(np.median([1.0 / max(velocity.louder, 1e-12) for _, velocity in taken]))
        names = tuple(dict.fromkeys(joint for joint, _ in taken))
        findings.append(Finding(Code.VELOCITY_TAKEN, names, numbers={"quieter": quieter}))
    unlike = [
        (name, joint, velocity)
        for name, every in of
        for joint, velocity in every.items()
        if not velocity.agrees
    ]
    if unlike:
        name, joint, worst = max(unlike, key=lambda each: each[2].off)
        numbers = {"off": worst.off, "scale": worst.scale, "delay": worst.delay, "count": float(len(unlike))}
        findings.append(Finding(Code.VELOCITY_UNLIKE, (joint, name), numbers=numbers))
    return findings
