"""Whether a recording carries another load than declared, or an undeclared one."""

from dataclasses import replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.errors import BenchError
from bench.basics.threads import on_one_thread
from bench.dataset.payload import Payload
from bench.identification.compressed import triangular_factors
from bench.identification.current_error import minimum_on_factors, squared_errors
from bench.identification.filtered import Measured
from bench.identification.finding import Code, Finding
from bench.identification.observation import observe
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import Identification, relative_error
from bench.identification.swapped_columns import (
    ColumnsTrial,
    least_squares,
    rigid_equations,
    rows_with_friction,
    with_friction,
)
from bench.identification.tolerances import TOLERANCES

LOAD = "an undeclared load"


@on_one_thread
def undeclared_load(
    problem: Problem, result: Identification, trial: ColumnsTrial, deadline: Deadline = NEVER
) -> list[Finding]:
    """The fitted recording without a payload that an unknown payload explains, and its mass; empty if there is none.

    Tried recording by recording, with nominal gains and dry and viscous friction. Of two recordings, the one whose load
    has a positive mass is named. If another one has a payload of known mass, that mass may be wrong, and nothing is
    tried. trial: equations with the filters of the result. Raises TimeUpError after the deadline.
    """
    bounds, dataset = TOLERANCES.findings, problem.dataset
    fitted = [recording for recording in dataset.recordings if recording.use == "identify"]
    weighed = any(recording.payload in dataset.weighed for recording in fitted)
    if dataset.robot.tool_site is None or len(fitted) < 2 or weighed:
        return []
    before = trial.error(trial.reversed_in((), ()), nominal=True)
    if before < bounds.large_error:
        return []
    best: tuple[float, float, str] | None = None
    for name in [recording.name for recording in fitted if recording.payload is None]:
        deadline.check()
        try:
            after, mass = _with_load(problem, result, name)
        except BenchError:
            continue
        if mass > 0.0 and (best is None or after < best[0]):
            best = after, mass, name
    if best is None or not best[0] < min(bounds.swapped_error * before, bounds.large_error):
        return []
    after, mass, name = best
    return [
        Finding(Code.LOAD_UNDECLARED, (name,), (), {"before": before, "after": after, "mass": mass}, "kg")
    ]


def _with_load(problem: Problem, result: Identification, name: str) -> tuple[float, float]:
    """Error with an unknown payload on the tool in one recording, and its mass, kg."""
    dataset = problem.dataset
    recordings = tuple(
        replace(recording, payload=LOAD) if recording.name == name else recording
        for recording in dataset.recordings
    )
    payloads = {**dataset.payloads, LOAD: Payload(LOAD, None)}
    loaded = replace(dataset, recordings=recordings, payloads=payloads)
    prepared = rigid_equations(replace(problem, dataset=loaded, fit_gains=False), result)
    index = prepared.layout.payloads.get(LOAD, np.empty(0))
    if 0 not in index:
        return np.inf, 0.0  # no motion of this robot determines a payload's mass
    trial = ColumnsTrial(prepared)
    factors = trial.reversed_in((), ())
    theta, _ = trial.solved(factors, nominal=True)
    return trial.error(factors, nominal=True), float(theta[prepared.layout.payload_slice(LOAD)][0])


@on_one_thread
def other_load(
    problem: Problem, result: Identification, prepared: Prepared | None = None, deadline: Deadline = NEVER
) -> list[Finding]:
    """The recording that carries another load than declared, if with that load some motor's error falls far and no
    other rises; else empty.

    All recordings are fitted together, also those for validation, with dry and viscous friction in addition to the
    rigid bodies; in one after the other the load is omitted, or replaced by another of the fitted recordings. Judged
    motor by motor, since a missing effect hides the load only at its motor. If no motor's error is large in any
    recording, nothing is tried. prepared: the problem's equations with the filters of the result. Raises TimeUpError
    after the deadline.
    """
    if not _large(result) or not result.gains_fitted:
        return []
    if prepared is None:
        prepared = rigid_equations(replace(problem, fit_gains=True), result)
    trial, bounds = _LoadTrial(prepared), TOLERANCES.findings
    declared = {
        measurement.recording.name: measurement.recording.payload for measurement in prepared.measured
    }
    before = trial.errors(declared)
    best: tuple[float, str, str | None, np.ndarray] | None = None
    for name, load in declared.items():
        for other in (None, *prepared.layout.payloads):
            deadline.check()
            loads = {**declared, name: other}
            if other == load or None not in loads.values() or set(loads.values()) == {None}:
                continue
            ratios = np.divide(trial.errors(loads), before, out=np.ones_like(before), where=before > 0.0)
            score = float(np.log(ratios).sum())
            better = ratios.min() < bounds.swapped_error and ratios.max() < bounds.other_motors
            if better and (best is None or score < best[0]):
                best = score, name, other, ratios
    if best is None:
        return []
    _, name, other, ratios = best
    j = int(ratios.argmin())
    numbers = {"before": float(before[j]), "after": float(before[j] * ratios[j])}
    names = (name, result.joints[j], declared[name] or "", other or "")
    return [Finding(Code.OTHER_LOAD, names, numbers=numbers)]


def exchanged_loads(problem: Problem, result: Identification) -> list[Finding]:
    """The two loads of the fitted recordings, if they are exchanged; to be asked where all drive gains are negative.

    With the signs of all currents reversed they are negative, too, and the error is the same. But friction takes power
    from the motors: if the currents, as logged and with nominal gains, supply power in every fitted recording, their
    signs are right. Empty if not, or without two loads.
    """
    fitted = [series for series in result.recordings if series.use == "identify"]
    loads = sorted({series.payload or "" for series in fitted}, reverse=True)
    gains = problem.dataset.robot.nominal_gains
    supplied = [float(np.mean(series.measured * gains * series.velocity)) for series in fitted]
    if len(loads) != 2 or min(supplied) <= 0.0:
        return []
    return [Finding(Code.LOADS_EXCHANGED, tuple(loads))]


def _large(result: Identification) -> bool:
    """Whether some motor's error is large in some recording."""
    motors = range(len(result.joints))
    return any(
        (relative_error([trace], j) or 0.0) > TOLERANCES.findings.large_error
        for trace in result.recordings
        for j in motors
    )


class _LoadTrial:
    """The equations of every recording with each load, formed once each, as triangular factors (n, p + 2, p + 2) of
    [phi, kappa, current].
    """

    def __init__(self, prepared: Prepared) -> None:
        self.prepared = prepared
        n = len(prepared.dataset.robot.nominal_gains)
        self.layout = with_friction(prepared.layout, n)
        self.of = {measurement.recording.name: measurement for measurement in prepared.measured}
        self.declared = {observation.name: observation for observation in prepared.observations}
        self.parts: dict[tuple[str, str | None], np.ndarray] = {}

    def errors(self, loads: dict[str, str | None]) -> np.ndarray:
        """Relative error (n,) of every motor's current over all recordings, each with its load."""
        parts = [self._part(name, load) for name, load in loads.items()]
        factors = triangular_factors(np.concatenate(parts, axis=1).swapaxes(0, 1))
        gains = self.prepared.gains
        theta, fitted_gains = least_squares(factors, gains)
        theta, fitted_gains = minimum_on_factors(
            factors, theta, fitted_gains, np.ones(len(fitted_gains)), gains.fitted
        )
        whole = (factors[:, :, -1] ** 2).sum(axis=1)
        squares = squared_errors(factors, theta, fitted_gains)
        return np.sqrt(np.divide(squares, whole, out=np.zeros_like(whole), where=whole > 0.0))

    def _part(self, name: str, load: str | None) -> np.ndarray:
        if (name, load) not in self.parts:
            self.parts[name, load] = self._factors(self.of[name], load)
        return self.parts[name, load]

    def _factors(self, measured: Measured, load: str | None) -> np.ndarray:
        recording = measured.recording
        if load == recording.payload:
            seen = self.declared[recording.name]
        else:
            loaded = replace(measured, recording=replace(recording, payload=load))
            seen = observe(self.prepared.model, loaded)
        rows = np.empty((*seen.current.shape, self.layout.size + 2))
        rows[:, :, :-1] = rows_with_friction(seen, self.layout, self.prepared.dataset.payloads)
        rows[:, :, -1] = seen.current
        return triangular_factors(rows * seen.moving[:, :, None])
