"""Recordings that have no value of an effect with one value per recording."""

from dataclasses import replace

import numpy as np

from bench.effects.select import parameter_slices
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.layout import known_rows, regressor_rows
from bench.identification.observation import Observation
from bench.identification.prepare import Prepared
from bench.identification.solution import Solution


def columns_without_value(prepared: Prepared, observation: Observation) -> list[np.ndarray]:
    """For each effect parameter with one value per recording, but none for this one: its columns of theta."""
    (log,) = {seen.recording.log for seen in prepared.measured if seen.recording.name == observation.name}
    together: dict[tuple[str, str, int], list[int]] = {}
    first = prepared.layout.effect_slice.start
    for instance, part in parameter_slices(prepared.effects):
        if instance.recording and log not in instance.among:
            for k in range(part.start, part.stop):
                together.setdefault((*instance.seat, k - part.start), []).append(first + k)
    return [np.array(columns) for columns in together.values()]


def in_this_recording(prepared: Prepared, observation: Observation, solution: Solution) -> Solution:
    """The solution, with the best-fitting values where a recording has none.

    What differs from run to run is not judged.
    """
    together = columns_without_value(prepared, observation)
    if not together:
        return solution
    rows = regressor_rows(observation, prepared.layout)
    torque = rows @ solution.theta + known_rows(observation, prepared.dataset.payloads)
    error = (observation.current - torque / solution.gains) * observation.moving
    columns = np.stack([rows[:, :, indices].sum(axis=2) for indices in together], axis=2)
    columns *= (observation.moving / solution.gains)[:, :, None]
    shifts = np.linalg.lstsq(columns.reshape(-1, len(together)), error.ravel(), rcond=None)[0]
    theta = solution.theta.copy()
    for indices, shift in zip(together, shifts, strict=True):
        theta[indices] += shift
    return replace(solution, theta=theta)


def without_values_by_log(prepared: Prepared) -> list[Finding]:
    """Per effect, the recordings without a value and those that have one."""
    among = {instance.name: instance.among for instance in prepared.effects if instance.recording}
    findings = []
    for name, logs in among.items():
        others = tuple(
            measurement.recording.name
            for measurement in prepared.measured
            if measurement.recording.log not in logs
        )
        if others:
            of = tuple(Unknown("effect", "", log, name) for log in logs)
            findings.append(Finding(Code.NO_VALUE_OF_ITS_OWN, others, of))
    return findings
