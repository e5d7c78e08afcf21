"""Encoders of redundant motors: each measures what the loop closures make of the other joints' positions."""

from collections.abc import Sequence
from math import tau

import numpy as np

from bench.basics.joint_units import joint_units
from bench.dataset.recording import position_column
from bench.identification.decision import RULE
from bench.identification.filtered import Measured
from bench.identification.finding import Code, Finding
from bench.identification.tolerances import TOLERANCES
from bench.model.geometry import Geometry, Joint
from bench.signals.filtering import low_pass
from bench.signals.processing import trim
from bench.signals.settings import signal_bands


def contradicted_closures(geometry: Geometry, measured: Sequence[Measured]) -> tuple[Finding, ...]:
    """Joints of redundant motors that were logged elsewhere than the loop closures put them, the worst recording each.

    Reported where the difference, filtered as the positions are, is more than the encoders' noise and than tolerances
    are. Joints of which a recording has no position are passed over.
    """
    findings = []
    for actuator in geometry.robot.redundant:
        joint = geometry.joints[geometry.joint_index(actuator.joint)]
        logged = [
            measurement
            for measurement in measured
            if position_column(actuator.joint) in measurement.recording.extra
        ]
        each = [_contradiction(joint, measurement) for measurement in logged]
        clear = [finding for finding in each if finding is not None]
        if clear:
            findings.append(max(clear, key=lambda finding: finding.numbers["difference"]))
    return tuple(findings)


def _contradiction(joint: Joint, measured: Measured) -> Finding | None:
    recording, settings = measured.recording, measured.settings
    logged = recording.extra[position_column(joint.name)]
    filtered = low_pass(logged, recording.rate, settings.position_cutoff, settings.filter_order)
    closed = measured.tree.q[:, joint.q.start] + joint.offset
    difference = trim(filtered, settings) - closed
    if joint.kind != "slide":
        difference = difference - tau * np.round(np.median(difference) / tau)
    size, travel = float(np.sqrt((difference**2).mean())), float(np.ptp(closed))
    if size <= max(
        TOLERANCES.findings.closure_error * travel, RULE.certain * _noise(joint, measured, logged)
    ):
        return None
    return Finding(
        Code.CLOSURE_CONTRADICTED,
        (joint.name, recording.name),
        numbers={"difference": size, "mean": float(difference.mean()), "travel": travel},
        unit=joint_units(joint.kind != "slide").position,
    )


def _noise(joint: Joint, measured: Measured, logged: np.ndarray) -> float:
    """RMS of the noise that the filter lets through, of this encoder and, through the closures, of the others."""
    recording = measured.recording
    positions = np.column_stack((recording.position, logged))
    density = signal_bands([positions], [recording.current], recording.rate).position_noise
    follow = (measured.tree.jacobian[:, joint.v.start] ** 2).mean(axis=0)
    return float(np.sqrt((follow @ density[:-1] + density[-1]) * measured.settings.position_cutoff))
