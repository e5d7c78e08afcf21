"""From a dataset to drive gains, base parameters and effect parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from bench.dataset import Dataset
from bench.effects import EffectInstance, select_effects
from bench.errors import BenchError
from bench.estimate.column_errors import column_errors
from bench.estimate.deviations import Deviations, Uncertainty, uncertainty
from bench.estimate.essential import essential_columns, expanded, reduced
from bench.estimate.estimators import DEFAULT_METHOD, Request, solve
from bench.estimate.identifiability import check_gains_identifiable
from bench.estimate.layout import (
    ParameterLayout,
    known_rows,
    parameter_layout,
    payload_columns,
    payload_parameter_names,
    regressor_rows,
)
from bench.estimate.notes import notes_on
from bench.estimate.observation import Observation, observe
from bench.estimate.result import (
    CurrentSeries,
    DriveGain,
    Identification,
    Parameter,
    Quantity,
    error_summary,
)
from bench.estimate.solution import Solution
from bench.estimate.stack import Stack, stack_observations
from bench.model.model import IdentificationModel, build_model
from bench.model.regressor import PARAMETERS, UNITS
from bench.signals.settings import FilterSettings, choose_settings


@dataclass(frozen=True)
class Prepared:
    """A dataset made ready to be fitted: the model, the filters, and every recording as equations."""

    dataset: Dataset
    model: IdentificationModel
    settings: FilterSettings
    effects: tuple[EffectInstance, ...]
    observations: tuple[Observation, ...]
    layout: ParameterLayout

    @property
    def left_aside(self) -> tuple[str, ...]:
        """Recordings whose payload nothing tells of: not declared in full, and carried by none that is fitted."""
        used = {one.name for one in self.observations}
        return tuple(one.name for one in self.dataset.recordings if one.name not in used)

    @property
    def fitted(self) -> tuple[Observation, ...]:
        return tuple(one for one in self.observations if one.use == "identify")


def identify(
    dataset: Dataset,
    effects: Sequence[str] = (),
    method: str = DEFAULT_METHOD,
    *,
    filters: FilterSettings | Mapping[str, Any] | None = None,
    deviations: Deviations = "autocorrelated",
    fit_gains: bool | None = None,
    essential: bool = False,
) -> Identification:
    """Identify drive gains and dynamic parameters together (Briot and Gautier 2012, equations 8 to 13).

    effects: names as EFFECT or EFFECT:JOINT, added to the rigid-body model. method: current, ls, wls, tls or
    wtls. filters: settings, or some of them by name; the others are chosen from the spectra. deviations: how standard deviations are
    computed. fit_gains: by default, where a fitted recording carries a payload of known mass; without one
    the gains stay nominal. essential: leave out base parameters that the data do not need. Raises BenchError naming what in the data or the robot cannot be used.
    """
    prepared = prepare(dataset, effects, filters)
    return fit(prepared, method, deviations=deviations, fit_gains=fit_gains, essential=essential)


def prepare(
    dataset: Dataset,
    effects: Sequence[str] = (),
    filters: FilterSettings | Mapping[str, Any] | None = None,
    *,
    fitted_only: bool = True,
) -> Prepared:
    """Build the model and turn every recording into equations, filtered and decimated alike.

    The filters and the unknown payload parameters follow from the recordings to fit, or (not `fitted_only`)
    from all. A recording whose payload no such recording carries is left aside, unless all parameters of
    the payload are declared.
    """
    fitted = [one for one in dataset.recordings if one.use == "identify" or not fitted_only]
    if not fitted:
        raise BenchError(f'{dataset.folder}: no recording has use = "identify"')
    joints = [actuator.joint for actuator in dataset.robot.actuators]
    instances = select_effects(effects, joints)
    model = build_model(dataset.robot)
    if isinstance(filters, FilterSettings):
        settings = filters
    else:
        chosen = choose_settings(
            [one.position for one in fitted], [one.current for one in fitted], fitted[0].rate
        )
        settings = replace(chosen, **(filters or {}))
    count = sum(len(one.effect.parameters) for one in instances)
    carried = [one.payload for one in fitted]
    declared = [name for name, one in dataset.payloads.items() if not len(payload_columns(one).unknown)]
    layout = parameter_layout(model, dataset.payloads, [*carried, *declared], count)
    usable = [one for one in dataset.recordings if one.payload is None or one.payload in layout.payloads]
    observations = tuple(observe(model, recording, settings, instances) for recording in usable)
    return Prepared(dataset, model, settings, instances, observations, layout)


def fit(
    prepared: Prepared,
    method: str = DEFAULT_METHOD,
    *,
    deviations: Deviations = "autocorrelated",
    fit_gains: bool | None = None,
    essential: bool = False,
) -> Identification:
    """Estimate from prepared equations; see `identify`."""
    dataset, layout = prepared.dataset, prepared.layout
    stack = stack_observations(prepared.fitted, layout, dataset.payloads)
    if fit_gains and not stack.scaled:
        raise BenchError(
            f"{dataset.folder}: no fitted recording has a payload of known mass, which gives the gains' scale"
        )
    gains_fitted = stack.scaled if fit_gains is None else fit_gains
    if gains_fitted:
        carried = [one.payload_name for one in prepared.fitted]
        check_gains_identifiable(prepared.model, layout, dataset.payloads, carried)
    unknowns = layout.size + (stack.current.shape[1] if gains_fitted else 0)
    equations = int(stack.moving.sum())
    if equations < 2 * unknowns:
        raise BenchError(
            f"{dataset.folder}: {equations} equations after decimation are too few for {unknowns} unknowns"
        )

    def errors_of_columns() -> np.ndarray:
        recordings = [one for one in dataset.recordings if one.use == "identify"]
        return column_errors(
            recordings,
            prepared.fitted,
            prepared.settings,
            lambda recording: observe(prepared.model, recording, prepared.settings, prepared.effects),
            lambda one: (regressor_rows(one, layout), known_rows(one, dataset.payloads)),
        )

    nominal = dataset.robot.nominal_gains

    def solved(system: Stack, columns: np.ndarray) -> Solution:
        errors = np.append(columns, [layout.size, layout.size + 1])
        return solve(
            method,
            Request(
                system, nominal, gains_fitted, lambda: errors_of_columns()[np.ix_(motors, errors, errors)]
            ),
        )

    motors = np.arange(len(nominal))
    kept = np.arange(layout.size)
    if essential:
        kept = essential_columns(stack, layout.base, solved, deviations)
        stack = reduced(stack, kept)
    solution = solved(stack, kept)
    solution, spread = expanded(solution, uncertainty(stack, solution, deviations), kept, layout.size)
    series = tuple(modelled_series(prepared, one, solution) for one in prepared.observations)
    unknowns -= layout.size - len(kept)
    return _result(prepared, method, solution, spread, deviations, series, unknowns, kept)


def modelled_series(prepared: Prepared, observation: Observation, solution: Solution) -> CurrentSeries:
    torque = regressor_rows(observation, prepared.layout) @ solution.theta
    torque += known_rows(observation, prepared.dataset.payloads)
    return CurrentSeries(
        name=observation.name,
        use=observation.use,
        payload=observation.payload_name,
        time=observation.time,
        measured=observation.current,
        modelled=torque / solution.gains,
        position=observation.position,
        velocity=observation.velocity,
        acceleration=observation.acceleration,
        moving=observation.moving,
    )


def _result(
    prepared: Prepared,
    method: str,
    solution: Solution,
    spread: Uncertainty,
    deviations: Deviations,
    series: tuple[CurrentSeries, ...],
    unknowns: int,
    kept: np.ndarray,
) -> Identification:
    robot, layout, base = prepared.dataset.robot, prepared.layout, prepared.model.base
    std = np.sqrt(np.maximum(np.diag(spread.covariance), 0.0))
    p = layout.size
    gains = {
        actuator.joint: DriveGain(
            float(solution.gains[j]), float(std[p + j]), actuator.gain_unit, actuator.gain
        )
        for j, actuator in enumerate(robot.actuators)
    }
    names = list(zip(base.names, base.units, base.descriptions, strict=True))
    for payload, index in layout.payloads.items():
        for i, name in zip(index, payload_parameter_names(payload, index), strict=True):
            names.append((name, UNITS[i], f"{PARAMETERS[i]} of payload {payload} in the tool frame"))
    parameters = tuple(
        Parameter(float(solution.theta[i]), float(std[i]), unit, name, grouping)
        for i, (name, unit, grouping) in enumerate(names)
        if i in kept
    )
    effect_parameters: dict[str, dict[str, dict[str, Quantity]]] = {}
    at = len(names)
    rotates = {actuator.joint: actuator.gain_unit.startswith("N*m") for actuator in robot.actuators}
    for instance in prepared.effects:
        values = {}
        for parameter in instance.effect.parameters:
            unit = parameter.unit_at(rotates[instance.joint])
            values[parameter.name] = Quantity(float(solution.theta[at]), float(std[at]), unit)
            at += 1
        effect_parameters.setdefault(instance.effect.name, {})[instance.joint] = values
    joints = [actuator.joint for actuator in robot.actuators]
    result = Identification(
        robot=robot.name,
        robot_folder=str(robot.folder),
        method=method,
        effects=tuple(dict.fromkeys(instance.request for instance in prepared.effects)),
        drive_gains=gains,
        gains_fitted=solution.gains_fitted,
        parameters=parameters,
        effect_parameters=effect_parameters,
        covariance=spread.covariance,
        rank=spread.rank,
        unknowns=unknowns,
        condition=spread.condition,
        scaled_condition=spread.scaled_condition,
        error=error_summary(series, joints),
        settings=prepared.settings,
        deviations=deviations,
        recordings=series,
        left_out=tuple(name for i, (name, _, _) in enumerate(names) if i not in kept),
        notes=(),
    )
    return notes_on(result, prepared.left_aside)
