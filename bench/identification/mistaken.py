"""Whether the data are what they are declared to be: units, columns and loads."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.joint_units import drive_unit
from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.dataset.payload import Payload
from bench.identification.compressed import triangular_factors
from bench.identification.current_error import minimised, squared_errors
from bench.identification.filtered import Measured
from bench.identification.finding import Code, Finding
from bench.identification.layout import ParameterLayout, known_rows, regressor_rows
from bench.identification.observation import Observation, all_currents, observe
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, Identification, relative_error
from bench.identification.solution import scaled_lstsq, solved_gains, torque_system
from bench.identification.tolerances import TOLERANCES


def mistaken(
    problem: Problem, result: Identification, prepared: Prepared | None = None, deadline: Deadline = NEVER
) -> tuple[Finding, ...]:
    """What is probably declared wrongly. With currents in unlike units nothing else is looked for: all is off then.

    prepared: the problem's equations with the filters of the result, where they are at hand. Raises TimeUpError after
    the deadline.
    """
    heavy = heavy_payloads(problem.dataset)
    units = unlike_units(result)
    if units:
        return (*heavy, *units)
    swapped = swapped_columns(problem, result, prepared, deadline)
    return (*heavy, *swapped, *other_load(problem, result, prepared, deadline))


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


def friction_columns(observation: Observation) -> np.ndarray:
    """Dry and viscous friction of every motor at the fit's rate, (M, n, 2 n): nearly every machine has them."""
    motors = np.arange(observation.velocity.shape[1])
    columns = np.zeros((*observation.velocity.shape, 2 * len(motors)))
    columns[:, motors, 2 * motors] = np.sign(observation.velocity)
    columns[:, motors, 2 * motors + 1] = observation.velocity
    return columns


def with_friction(layout: ParameterLayout, motors: int) -> ParameterLayout:
    """The layout of equations in which every motor has dry and viscous friction, and no other effect."""
    return replace(layout, effects=2 * motors)


def rows_with_friction(
    observation: Observation, layout: ParameterLayout, payloads: Mapping[str, Payload]
) -> np.ndarray:
    """Rows (M, n, p + 1) of [phi, kappa] with friction; layout: from `with_friction`."""
    rows = np.empty((*observation.velocity.shape, layout.size + 1))
    rows[:, :, :-1] = regressor_rows(replace(observation, effects=friction_columns(observation)), layout)
    rows[:, :, -1] = known_rows(observation, payloads)
    return rows


@on_one_thread
def swapped_columns(
    problem: Problem, result: Identification, prepared: Prepared | None = None, deadline: Deadline = NEVER
) -> list[Finding]:
    """The two motors whose columns, exchanged, bring the error down most; none where none do.

    Tried one pair at a time, in all fitted recordings and in each of them, with the filters of the result, and with dry
    and viscous friction in addition to the rigid bodies, so that it does not hide the swap. The error must fall far
    below that of the result and below what friction alone makes of it. Where the error of the result is small, nothing
    is tried. prepared: the problem's equations with these filters, where they are at hand. Raises TimeUpError after the
    deadline.
    """
    error = result.error.identify
    joints = list(result.joints)
    if error is None or error < TOLERANCES.findings.large_error or len(joints) < 2:
        return []
    if prepared is None:
        prepared = prepare(
            replace(problem, effects=(), filters=result.settings, fit_gains=result.gains_fitted)
        )
    trial = _ColumnsTrial(prepared)

    def error_with(swap: tuple[tuple[str, ...], int, int]) -> float:
        deadline.check()
        return trial.error(trial.exchanged(*swap))

    names, a, b = min(_swaps(tuple(trial.parts), len(joints)), key=error_with)
    reached = trial.error(trial.exchanged(names, a, b), least=True)
    both = trial.error(trial.exchanged((), a, b), least=True)
    if not reached < TOLERANCES.findings.swapped_error * min(error, both, 1.0):
        return []
    first, second = joints[a], joints[b]
    where = () if len(names) == len(trial.parts) else (names[0],)
    return [Finding(Code.COLUMNS_SWAPPED, (first, second, *where), numbers={"error": reached})]


def _swaps(names: tuple[str, ...], motors: int) -> Iterator[tuple[tuple[str, ...], int, int]]:
    """Names of recordings, and the two motors whose columns may be exchanged in them."""
    for chosen in dict.fromkeys([names, *((name,) for name in names)]):
        for a, b in combinations(range(motors), 2):
            yield chosen, a, b


class _ColumnsTrial:
    """The equations of all fitted recordings with every motor's current for every motor's rows, and friction.

    parts: for each recording triangular factors (n, r, p + 1 + n) of [phi, kappa, all currents], formed once: an
    exchange only picks other ones of the currents. Currents are interpolated where the motor of the rows does not move.
    """

    def __init__(self, prepared: Prepared) -> None:
        n = len(prepared.dataset.robot.nominal_gains)
        layout = with_friction(prepared.layout, n)
        self.size = layout.size
        self.gains = prepared.gains
        self.parts: dict[str, np.ndarray] = {}
        for observation, measured in zip(prepared.observations, prepared.measured, strict=True):
            if observation.use != "identify":
                continue
            rows = np.empty((len(observation.time), n, self.size + 1 + n))
            rows[:, :, : self.size + 1] = rows_with_friction(observation, layout, prepared.dataset.payloads)
            rows[:, :, self.size + 1 :] = all_currents(measured)
            rows *= observation.moving[:, :, None]
            self.parts[observation.name] = triangular_factors(rows)

    def exchanged(self, names: Sequence[str], a: int, b: int) -> np.ndarray:
        """Factors (n, p + 2, p + 2) of [phi, kappa, current] with two motors' currents exchanged in some recordings."""
        motors = np.arange(len(self.gains.values))
        turned = motors.copy()
        turned[[a, b]] = b, a
        p = self.size
        picked = [
            np.concatenate(
                (
                    part[:, :, : p + 1],
                    part[motors, :, p + 1 + (turned if name in names else motors)][:, :, None],
                ),
                axis=2,
            )
            for name, part in self.parts.items()
        ]
        return triangular_factors(np.concatenate(picked, axis=1).swapaxes(0, 1))

    def error(self, factors: np.ndarray, *, least: bool = False) -> float:
        """Relative error of the currents by least squares in torque; or the least that there can be, from there."""
        rows, right = torque_system(factors, self.gains.held)
        solution = scaled_lstsq(rows, right)
        theta = solution[: self.size]
        gains = solved_gains(factors, self.gains.with_fitted(solution[self.size :]), self.gains.values)
        if least:
            theta, gains = minimised(factors, theta, gains, np.ones(len(gains)), self.gains.fitted)
        return float(np.sqrt(squared_errors(factors, theta, gains).sum() / (factors[:, :, -1] ** 2).sum()))


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
        prepared = prepare(replace(problem, effects=(), filters=result.settings, fit_gains=True))
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
        solution = scaled_lstsq(*torque_system(factors, gains.held))
        theta = solution[: self.layout.size]
        fitted_gains = solved_gains(factors, gains.with_fitted(solution[self.layout.size :]), gains.values)
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
