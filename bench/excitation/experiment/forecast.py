"""Forecast of an experiment: standard errors, undetermined unknowns, and a sufficient payload."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.dataset.payload import Payload
from bench.effects.effect import unit_at
from bench.effects.select import ROBOT
from bench.excitation.bounds import FORECAST
from bench.excitation.experiment.covariance import Determined, determined
from bench.excitation.experiment.encoder import encoder_score
from bench.excitation.experiment.nominal import Nominal, equations, pooled_variance, seen
from bench.excitation.experiment.plan import ExperimentPlan
from bench.excitation.experiment.planned_log import PlannedRows, planned_rows, row_evidence
from bench.excitation.experiment.request import PAYLOAD
from bench.export.bodies import cad_prior
from bench.identification.layout import parameter_layout, payload_parameter_names
from bench.model.regressor import UNITS


@dataclass(frozen=True)
class Expected:
    """One unknown. kind: "gain", "parameter", "payload" or "effect"; value: nominal, NaN if unknown; std: its expected
    standard error, None if undetermined; size: its unit for relative errors.
    """

    name: str
    kind: str
    unit: str
    value: float
    std: float | None
    size: float
    grouping: str = ""

    @property
    def relative(self) -> float:
        """The standard error over the size; infinite if the unknown is undetermined."""
        return float("inf") if self.std is None else self.std / self.size


@dataclass(frozen=True)
class Enough:
    """What gives an accuracy of the gains.

    accuracy: requested; expected: worst relative standard error of the gains with the planned payload, None without
    one; seconds: of each recording with that payload, None if no reasonable time suffices; mass: kg, the lightest
    sufficient payload at the planned time, None if there is none within the limits.
    """

    accuracy: float
    expected: float | None
    seconds: float | None
    mass: float | None


@dataclass(frozen=True)
class Forecast:
    """unknowns in the order of the fit; together: names of unknowns that are not determined, or only together;
    coarse: whether the encoders' steps matter.
    """

    unknowns: tuple[Expected, ...]
    together: tuple[tuple[str, ...], ...]
    coarse: bool
    enough: Enough | None


def covariance_of(plan: ExperimentPlan, rows: Sequence[PlannedRows]) -> tuple[Determined, bool]:
    """Covariance (P, P) by current noise and encoder steps, and whether the steps matter."""
    search, nominal = plan.search, plan.nominal
    of_plan = [row_evidence(nominal, planned, load) for planned, load in zip(rows, search.loads, strict=True)]
    everything = [*search.known, *of_plan]
    fit = equations(everything)
    result = determined(fit)
    if not np.any(nominal.noise.encoder > 0.0):
        return result, False
    weights = 1.0 / pooled_variance(everything)
    extra = [
        encoder_score(nominal, trial.trajectory, load, weights)
        for trial, load in zip(plan.motions, search.loads, strict=True)
    ]
    both = determined(replace(fit, score=fit.score + np.sum(extra, axis=0)))
    stepped = np.diag(both.covariance) > FORECAST.encoder_steps**2 * np.diag(result.covariance)
    return both, bool(stepped[~result.undetermined].any())


def forecast(plan: ExperimentPlan, gain_accuracy: float | None = None) -> Forecast:
    """Standard errors of all unknowns, by current noise alone and with encoder steps.

    gain_accuracy: relative; if given, the sufficient payload mass and time are searched. Standard errors cover noise
    only, not effects that the model lacks.
    """
    rows = planned_rows(plan.nominal, [trial.trajectory for trial in plan.motions], plan.search.loads)
    result, stepped = covariance_of(plan, rows)
    std = np.sqrt(np.maximum(np.diag(result.covariance), 0.0))
    unknowns = tuple(
        replace(expected, std=None if result.undetermined[i] else float(std[i]), size=float(plan.sizes[i]))
        for i, expected in enumerate(described(plan.nominal))
    )
    together = tuple(tuple(unknowns[i].name for i in direction) for direction in result.directions)
    enough = None if gain_accuracy is None else enough_for(plan, rows, gain_accuracy)
    return Forecast(unknowns, together, stepped, enough)


def described(nominal: Nominal) -> Iterator[Expected]:
    """Every unknown of a machine, with no standard error yet."""
    base, layout, robot = nominal.model.base, nominal.layout, nominal.model.geometry.robot
    nan = float("nan")
    for i, (name, unit) in enumerate(zip(base.names, base.units, strict=True)):
        value = float(nominal.base[i])
        yield Expected(name, "parameter", unit, value, None, 1.0, base.descriptions[i])
    for payload, index in layout.payloads.items():
        for name, i in zip(payload_parameter_names(payload, index), index, strict=True):
            yield Expected(name, "payload", UNITS[i], nan, None, 1.0)
    kinds = {joint.name: joint.kind for joint in nominal.model.geometry.joints}
    for instance in nominal.effects:
        for parameter in instance.effect.parameters:
            rotates = kinds.get(instance.joint) != "slide"
            name = f"{instance.name}:{instance.joint or ROBOT}.{parameter.name}"
            yield Expected(name, "effect", unit_at(parameter.unit, rotates), nan, None, 1.0)
    if nominal.gains_fitted:
        for actuator in robot.actuators:
            yield Expected(actuator.joint, "gain", actuator.gain_unit, actuator.gain, None, 1.0)


def gain_error(plan: ExperimentPlan, rows: Sequence[PlannedRows], mass: float | None) -> float:
    """Worst relative standard error of the gains with another payload mass; infinite without one.

    The first planned motion is unloaded and the last one loaded; a single one is made twice.
    """
    nominal = _with_mass(plan.nominal, mass)
    evidence = []
    for planned, load in zip((rows[0], rows[-1]), (None, *nominal.payloads), strict=False):
        what = seen(nominal, planned.motion, load)
        if np.any(np.abs(what.current * nominal.gains) > plan.room.torque):
            return float("inf")
        evidence.append(row_evidence(nominal, planned, load))
    result = determined(equations(evidence))
    first = nominal.layout.size
    if not nominal.gains_fitted or result.undetermined[first:].any():
        return float("inf")
    return float((np.sqrt(np.diag(result.covariance))[first:] / nominal.gains).max())


def enough_for(plan: ExperimentPlan, rows: Sequence[PlannedRows], accuracy: float) -> Enough:
    """The time with the planned payload, and the lightest payload at the planned time, that give an accuracy."""
    robot = plan.robot
    if robot.tool_site is None:
        raise BenchError(f"gain accuracy: the robot {robot.name!r} has no [tool] site to fix a payload at")
    expected, seconds = None, None
    planned = plan.nominal.payloads.get(PAYLOAD)
    duration = plan.search.shape.duration
    if planned is not None:
        expected = gain_error(plan, rows, planned.mass)
        times = (expected / accuracy) ** 2
        seconds = duration * times if times <= FORECAST.longest else None
    moving = moving_mass(plan.nominal)
    mass = FORECAST.lightest * moving
    while mass <= FORECAST.heaviest * moving:
        if gain_error(plan, rows, mass) <= accuracy:
            return Enough(accuracy, expected, seconds, mass)
        mass *= FORECAST.masses
    return Enough(accuracy, expected, seconds, None)


def moving_mass(nominal: Nominal) -> float:
    """Mass of all bodies that move, kg, by the MJCF."""
    geometry = nominal.model.geometry
    masses = cad_prior(geometry).parameters[::10]
    return float(sum(masses[joint] for joint, _ in geometry.bodies))


def _with_mass(nominal: Nominal, mass: float | None) -> Nominal:
    """The machine with a payload of another mass and the same shape; a point at the tool if none was planned."""
    if mass is None:
        return nominal
    before = nominal.payloads.get(PAYLOAD)
    if before is None or before.mass is None:
        payload = Payload(PAYLOAD, mass, np.zeros(3), np.zeros(6))
    else:
        inertia = None if before.inertia is None else before.inertia * (mass / before.mass)
        payload = replace(before, mass=mass, inertia=inertia)
    payloads = {**nominal.payloads, PAYLOAD: payload}
    layout = parameter_layout(nominal.model, payloads, [None, *payloads], nominal.layout.effects)
    return replace(nominal, payloads=payloads, layout=layout, gains_fitted=True)
