"""Whether the data are what they are declared to be: units, columns and loads."""

from dataclasses import replace

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.joint_units import drive_unit
from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.identification.compressed import triangular_factors
from bench.identification.current_error import minimised, squared_errors
from bench.identification.filtered import Measured
from bench.identification.finding import Code, Finding
from bench.identification.observation import observe
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, Identification, relative_error
from bench.identification.reversed_currents import reversed_currents
from bench.identification.reversed_positions import reversed_positions
from bench.identification.swapped_columns import (
    ColumnsTrial,
    least_squares,
    rigid_equations,
    rows_with_friction,
    swapped_columns,
    with_friction,
)
from bench.identification.tolerances import TOLERANCES
from bench.identification.undeclared_load import undeclared_load


@on_one_thread
def mistaken(
    problem: Problem, result: Identification, prepared: Prepared | None = None, deadline: Deadline = NEVER
) -> tuple[Finding, ...]:
    """What is probably declared wrongly. With currents in unlike units, or of the wrong sign, nothing else is looked
    for: all is off then.

    prepared: the problem's equations with the filters of the result, where they are at hand. Raises TimeUpError after
    the deadline.
    """
    heavy = heavy_payloads(problem.dataset)
    units = unlike_units(result)
    if units:
        return (*heavy, *units)
    error = result.error.identify
    if error is None or error < TOLERANCES.findings.large_error:
        return (*heavy, *other_load(problem, result, prepared, deadline))
    if prepared is None:
        prepared = rigid_equations(replace(problem, fit_gains=result.gains_fitted), result)
    trial = ColumnsTrial(prepared)
    reversed_ = reversed_currents(result, trial, deadline)
    if reversed_:
        left = min(finding.numbers["after"] for finding in reversed_)
        better = reversed_positions(problem, result, trial, deadline, other=left)
        return (*heavy, *(better or reversed_))
    swapped = swapped_columns(problem, result, prepared, deadline, trial)
    loads = other_load(problem, result, prepared, deadline)
    if not (swapped or loads):
        loads = undeclared_load(problem, result, trial, deadline)
    positions = [] if swapped or loads else reversed_positions(problem, result, trial, deadline)
    return (*heavy, *swapped, *loads, *positions)


def heavy_payloads(dataset: Dataset) -> tuple[Finding, ...]:
    """What is asked of payloads that are declared far heavier than the robot."""
    return tuple(
        Finding(
            Code.PAYLOAD_HEAVY,
            (heavy.name,),
            numbers={"mass": heavy.mass, "own": heavy.robot_mass},
            unit="kg",
        )
        for heavy in dataset.doubted
    )


def unlike_units(result: Identification) -> list[Finding]:
    """The recordings whose currents are about a thousand times those of the others at every motor; [] where none are.

    names: a recording with the small currents, then those with the large ones. What is compared is the RMS of every
    motor's measured current, fitted or not.
    """
    sizes = {series.name: _sizes(series) for series in result.recordings}
    known = {name: size for name, size in sizes.items() if np.isfinite(size).all()}
    order = sorted(known, key=lambda name: float(known[name].mean()))
    if len(order) < 2:
        return []
    steps = np.diff([known[name].mean() for name in order])
    at = int(np.argmax(steps)) + 1
    low, high = (np.mean([known[name] for name in part], axis=0) for part in (order[:at], order[at:]))
    if np.abs(high - low - TOLERANCES.findings.thousand).max() > TOLERANCES.findings.near_decades:
        return []
    times = float(10.0 ** (high - low).mean())
    unit = drive_unit(next(iter(result.drive_gains.values())).unit)
    return [
        Finding(Code.UNITS_UNLIKE, (order[at - 1], *sorted(order[at:])), numbers={"times": times}, unit=unit)
    ]


def _sizes(series: CurrentSeries) -> np.ndarray:
    """Decades (n,) of the RMS of every motor's current; infinite where one has none."""
    rms = np.sqrt((series.measured**2).mean(axis=0))
    return np.log10(rms, out=np.full(len(rms), -np.inf), where=rms > 0.0)


@on_one_thread
def other_load(
    problem: Problem, result: Identification, prepared: Prepared | None = None, deadline: Deadline = NEVER
) -> list[Finding]:
    """The recording that carries another load than declared, if with that load some motor's error falls far, and no
    other's rises; none where nothing does.

    All recordings are fitted together, also those for validation, with dry and viscous friction in addition to the
    rigid bodies; in one after the other the load is omitted, or another that the fitted recordings carry is put in.
    Judged motor by motor, since an effect that is missing at one hides what the load does there and not at the others.
    Where no motor's error is large in any recording, nothing is tried. prepared: the problem's equations with the
    filters of the result. Raises TimeUpError after the deadline.
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
        theta, fitted_gains = minimised(
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
