"""A solution in the user's words: gains, parameters, effects and errors with their names and units."""

from collections.abc import Sequence

import numpy as np

from bench.basics.joint_units import drive_unit
from bench.effects import EffectInstance
from bench.effects.select import ROBOT as ROBOT
from bench.effects.select import parameter_slices
from bench.identification.by_recording import in_this_recording, without_values_by_log
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.findings import with_findings
from bench.identification.identifiability_of_effects import collinear, unsettled
from bench.identification.layout import known_rows, payload_parameters, regressor_rows
from bench.identification.observation import Observation
from bench.identification.prepare import Prepared
from bench.identification.result import (
    CurrentSeries,
    DriveGain,
    Identification,
    Parameter,
    Quantity,
    error_summary,
)
from bench.identification.scale_words import scale_findings
from bench.identification.solution import Solution
from bench.identification.standard_errors import Deviations, Uncertainty
from bench.identification.velocity_findings import velocity_findings


def summarise(
    prepared: Prepared,
    method: str,
    solution: Solution,
    spread: Uncertainty,
    deviations: Deviations,
    kept: np.ndarray,
    outside: Sequence[EffectInstance] = (),
) -> Identification:
    """The answer. spread: covariance of [theta, gains, shape parameters]; kept: columns not omitted; outside: effects
    that the data push beyond their bounds.
    """
    robot, layout, base = prepared.dataset.robot, prepared.layout, prepared.model.base
    series = tuple(modelled_series(prepared, observation, solution) for observation in prepared.observations)
    std = np.sqrt(np.maximum(np.diag(spread.covariance), 0.0))
    p, n = layout.size, len(solution.gains)
    effects = layout.effect_slice
    loose = unsettled(prepared.effects, solution.theta[effects], std[effects])
    kept = np.setdiff1d(kept, [effects.start + i for i, _ in loose])
    rows = np.any([observation.moving.any(axis=0) for observation in prepared.fitted], axis=0)
    untold = solution.gains_fitted & ((std[p : p + n] == 0.0) | ~rows)
    of_gains = np.where(untold, np.inf, std[p : p + n])
    gains = {
        actuator.joint: DriveGain(
            float(solution.gains[j]), float(of_gains[j]), actuator.gain_unit, actuator.gain
        )
        for j, actuator in enumerate(robot.actuators)
    }
    if robot.redundant:
        gains |= redundant_gains(prepared, solution, std)
    names = list(zip(base.names, base.units, base.descriptions, strict=True))
    for payload, index in layout.payloads.items():
        for symbol, unit in payload_parameters(index):
            names.append((f"{symbol}({payload})", unit, f"{symbol} of payload {payload} in the tool frame"))
    parameters = tuple(
        Parameter(float(solution.theta[i]), float(std[i]), unit, name, grouping)
        for i, (name, unit, grouping) in enumerate(names)
        if i in kept
    )
    joints = [actuator.joint for actuator in robot.actuators]
    rows = _rows(prepared, [name for name, _, _ in names])
    return with_findings(
        Identification(
            robot=robot.name,
            robot_folder=str(robot.folder),
            method=method,
            effects=tuple(dict.fromkeys(instance.request for instance in prepared.effects)),
            drive_gains=gains,
            gains_fitted=bool(np.any(solution.gains_fitted)),
            parameters=parameters,
            effect_parameters=_effects(prepared, solution, std, kept, p + n),
            covariance=spread.covariance,
            covariance_rows=rows,
            rank=spread.rank,
            unknowns=spread.unknowns,
            condition=spread.condition,
            scaled_condition=spread.scaled_condition,
            error=error_summary(series, joints),
            settings=prepared.settings,
            deviations=deviations,
            recordings=series,
            left_out=tuple(name for i, (name, _, _) in enumerate(names) if i not in kept),
            findings=(),
            std_from=spread.std_from,
            redundant=tuple(actuator.joint for actuator in robot.redundant),
            locked=robot.locked,
        ),
        prepared.unusable,
        outside,
        [
            *prepared.contradicted,
            *velocity_findings(robot, [(seen.recording, seen.logged) for seen in prepared.measured]),
            *_repeated_rows(prepared),
            *without_values_by_log(prepared),
            *([Finding(Code.NOT_SETTLED, of=tuple(unknown for _, unknown in loose))] if loose else []),
            *collinear(prepared.effects, spread.covariance, rows),
        ],
        scale_findings(prepared.scale),
        prepared.dataset.payloads,
    )


def _repeated_rows(prepared: Prepared) -> list[Finding]:
    """Logs with rows that repeat the previous one."""
    held = {
        seen.recording.log: seen.recording.held for seen in prepared.measured if seen.recording.held > 0.0
    }
    return [Finding(Code.ROWS_REPEATED, tuple(held), (), {"share": max(held.values())})] if held else []


def redundant_gains(prepared: Prepared, solution: Solution, std: np.ndarray) -> dict[str, DriveGain]:
    """Drive gains of the redundant motors; std: of [theta, ...]."""
    layout, actuators = prepared.layout, prepared.dataset.robot.redundant
    changes, spreads = np.zeros(len(actuators)), np.zeros(len(actuators))
    if layout.redundant:
        changes, spreads = solution.theta[layout.redundant_slice], std[layout.redundant_slice]
    return {
        actuator.joint: DriveGain(
            actuator.gain + float(change), float(spread), actuator.gain_unit, actuator.gain
        )
        for actuator, change, spread in zip(actuators, changes, spreads, strict=True)
    }


def modelled_current(prepared: Prepared, observation: Observation, solution: Solution) -> np.ndarray:
    """Modelled currents (M, n) of one recording, drive units; see `in_this_recording`."""
    return _current(prepared, observation, in_this_recording(prepared, observation, solution))


def _current(prepared: Prepared, observation: Observation, solution: Solution) -> np.ndarray:
    torque = regressor_rows(observation, prepared.layout) @ solution.theta
    torque += known_rows(observation, prepared.dataset.payloads)
    return np.asarray(torque / solution.gains)


def modelled_series(prepared: Prepared, observation: Observation, solution: Solution) -> CurrentSeries:
    """Measured and modelled currents of one recording."""
    solution = in_this_recording(prepared, observation, solution)
    return CurrentSeries(
        name=observation.name,
        use=observation.use,
        payload=observation.payload_name,
        time=observation.time,
        measured=observation.current,
        modelled=_current(prepared, observation, solution),
        position=observation.position,
        velocity=observation.velocity,
        acceleration=observation.acceleration,
        moving=observation.moving,
        by_effect=_effect_torques(prepared, observation, solution),
        sharing=_sharing(prepared, observation.name, solution),
    )


def _sharing(prepared: Prepared, name: str, solution: Solution) -> np.ndarray | None:
    """See CurrentSeries."""
    extra = prepared.model.geometry.redundant
    if not len(extra):
        return None
    follow = next(
        measurement for measurement in prepared.measured if measurement.recording.name == name
    ).tree.jacobian[:, extra]
    gains = [
        gain.value for gain in redundant_gains(prepared, solution, np.zeros(len(solution.theta))).values()
    ]
    return np.asarray(np.sqrt((follow**2).mean(axis=0)).T * gains / solution.gains[:, None])


def _rows(prepared: Prepared, parameters: Sequence[str]) -> tuple[Unknown, ...]:
    """Unknowns of the covariance's rows, in order: [theta, gains, shape parameters]."""
    linear = [
        Unknown("effect", parameter.name, instance.place, instance.name)
        for instance in prepared.effects
        for parameter in instance.effect.parameters
    ]
    shapes = [
        Unknown("effect", shape.name, instance.place, instance.name)
        for instance in prepared.effects
        for shape in instance.effect.shape
        if not shape.discrete
    ]
    robot = prepared.dataset.robot
    gains = [Unknown("gain", "gain", joint) for joint in robot.joints]
    extra = [
        Unknown("gain", "gain", actuator.joint) for actuator in robot.redundant[: prepared.layout.redundant]
    ]
    return (*(Unknown("parameter", name) for name in parameters), *extra, *linear, *gains, *shapes)


def _effect_torques(
    prepared: Prepared, observation: Observation, solution: Solution
) -> dict[str, np.ndarray]:
    """The torque (M, n) of each effect, all its places together."""
    by_effect: dict[str, np.ndarray] = {}
    values = solution.theta[prepared.layout.effect_slice]
    for instance, part in parameter_slices(prepared.effects):
        torque = np.where(observation.moving, observation.effects[:, :, part] @ values[part], np.nan)
        name = instance.name
        by_effect[name] = by_effect[name] + torque if name in by_effect else torque
    return by_effect


def _effects(
    prepared: Prepared, solution: Solution, std: np.ndarray, kept: np.ndarray, shape_at: int
) -> dict[str, dict[str, dict[str, Quantity]]]:
    rotates = {joint.name: joint.kind != "slide" for joint in prepared.model.geometry.joints}
    drives = {actuator.joint: drive_unit(actuator.gain_unit) for actuator in prepared.dataset.robot.actuators}
    quantities: dict[str, dict[str, dict[str, Quantity]]] = {}
    at = prepared.layout.effect_slice.start
    for instance in prepared.effects:
        values = {}
        turning, drive = rotates.get(instance.joint, True), drives.get(instance.joint, "A")
        for parameter in instance.effect.parameters:
            unit = parameter.unit_at(turning, drive)
            spread = float(std[at]) if at in kept else float("inf")
            values[parameter.name] = Quantity(float(solution.theta[at]), spread, unit)
            at += 1
        for shape in instance.effect.shape:
            value = instance.effect.shape_values()[shape.name]
            spread = 0.0 if shape.discrete else float(std[shape_at]) or float("inf")
            values[shape.name] = Quantity(float(value), spread, shape.unit_at(turning, drive))
            shape_at += not shape.discrete
        quantities.setdefault(instance.name, {})[instance.place] = values
    return quantities
