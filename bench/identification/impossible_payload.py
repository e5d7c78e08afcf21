"""Payloads with a physically impossible inertia: the model's error has biased it, and through it the gains."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from bench.dataset.payload import Payload, inertia_matrix
from bench.identification.autocorrelation_time import autocorrelation_time
from bench.identification.decision import RULE
from bench.identification.finding import Code, Finding, Unknown
from bench.identification.layout import payload_columns, payload_parameter_names
from bench.identification.model_averaged import changed, estimates, gains_model_averaged, model_averaged
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.model.regressor import UNITS
from bench.signals.returning import rows_until_return

INERTIA = np.arange(4, 10)

Fit = Callable[[Prepared], Identification]


@dataclass(frozen=True)
class _Spread:
    """The least second moment of a payload's mass about its centre, kg*m^2, in a body >= 0; its deviation."""

    value: float
    std: float

    @property
    def impossible(self) -> bool:
        return self.value < -RULE.shows * self.std


def with_possible_payloads(prepared: Prepared, result: Identification, fitted: Fit) -> Identification:
    """The answer `result` of `prepared`; if a payload's estimated inertia is physically impossible, the answer with
    that payload as a point at its declared centre, if its error is as small. If the violation is by chance, fewer than
    RULE.shows deviations, the point must be as likely instead: the inertia is impossible, however imprecise.

    Since it was not declared as a point, deviations are those of the answer with free inertia, and cover the difference
    of the two. The second moments of a body's mass about its centre are not negative (Traversaro, Brossette, Escande
    and Nori, "Identification of fully physical consistent inertial parameters using optimization on manifolds", IROS
    2016). fitted: makes an answer from prepared equations.
    """
    if not result.gains_fitted:
        return result
    spreads = {name: _least_spread(prepared, result, name) for name in prepared.layout.payloads}
    negative = {name: spread for name, spread in spreads.items() if spread is not None and spread.value < 0.0}
    if not negative:
        return result
    sure = any(spread.impossible for spread in negative.values())
    payloads = {name: replace(prepared.dataset.payloads[name], inertia=np.zeros(6)) for name in negative}
    other = fitted(_with_payloads(prepared, payloads))
    known = {
        name: float(value)
        for payload in payloads.values()
        for name, value in zip(
            payload_parameter_names(payload.name, INERTIA),
            payload_columns(payload).known[INERTIA],
            strict=True,
        )
    }
    as_small = (other.error.identify or 0.0) <= (1.0 + RULE.material) * (result.error.identify or 0.0)
    taken = (as_small if sure else _as_likely(other, result)) and {
        parameter.name for parameter in other.parameters
    } | set(known) == {parameter.name for parameter in result.parameters}
    if not (taken or sure):
        return result
    new_findings = tuple(
        Finding(
            Code.PAYLOAD_TAKEN_AS_POINT if taken else Code.PAYLOAD_IMPOSSIBLE,
            (name,),
            numbers={"least": spread.value, "std": spread.std},
            unit=UNITS[INERTIA[0]],
        )
        for name, spread in negative.items()
        if taken or spread.impossible
    )
    answer = _with_values(result, other, known) if taken else gains_model_averaged(result, [other], "payload")
    return replace(answer, findings=(*new_findings, *result.findings))


def _as_likely(fewer: Identification, more: Identification) -> bool:
    """Whether an answer with fewer unknowns is as likely as one with more, with a noise level per motor.

    By Schwarz's criterion (1978), with the number of independent rows.
    """
    fitted, other = (
        [series for series in result.recordings if series.use == "identify"] for result in (more, fewer)
    )
    moving = np.concatenate([series.moving for series in fitted])
    squares = np.array(
        [sum((series.error**2 * series.moving).sum(axis=0) for series in each) for each in (fitted, other)]
    )
    moved = moving.sum(axis=0) > 0
    deviations = np.sqrt(squares[0] / np.maximum(moving.sum(axis=0), 1))
    errors = [
        (series.error * series.moving)[:, moved] / np.maximum(deviations[moved], np.finfo(float).tiny)
        for series in fitted
    ]
    returns = [rows_until_return(series.position) for series in fitted]
    rows = moving.sum(axis=0)[moved] / autocorrelation_time(errors, returns)
    gained = 0.5 * float(rows @ np.log(squares[1, moved] / squares[0, moved]))
    return gained <= 0.5 * (more.unknowns - fewer.unknowns) * float(np.log(rows.sum()))


def _with_values(result: Identification, other: Identification, known: Mapping[str, float]) -> Identification:
    """An answer with the values of another one, in which some parameters are known.

    Standard errors stay, or grow to the difference of the values.
    """
    values = {unknown: estimate.value for unknown, estimate in estimates(other).items()}
    values |= {Unknown("parameter", name): value for name, value in known.items()}
    before = estimates(result)
    moved = changed(result, lambda unknown, estimate: (values[unknown], estimate.std))
    apart = {unknown: abs(values[unknown] - estimate.value) for unknown, estimate in before.items()}
    return replace(model_averaged(moved, apart, "payload"), error=other.error, recordings=other.recordings)


def _with_payloads(prepared: Prepared, payloads: Mapping[str, Payload]) -> Prepared:
    """The same recordings, rows and effects with some payloads declared otherwise."""
    dataset = replace(prepared.dataset, payloads={**prepared.dataset.payloads, **payloads})
    fitted_only = any(recording.use == "identify" for recording in dataset.recordings)
    problem = Problem(dataset, {}, filters=prepared.settings, fit_gains=prepared.fit_gains)
    plain = replace(prepare(problem, fitted_only=fitted_only), scale=prepared.scale)
    counted = {observation.name: observation.moving for observation in prepared.observations}
    rows = tuple(
        replace(observation, moving=counted.get(observation.name, observation.moving))
        for observation in plain.observations
    )
    return with_effects(replace(plain, observations=rows), prepared.effects)


def _least_spread(prepared: Prepared, result: Identification, name: str) -> _Spread | None:
    """Least second moment of a payload with declared mass and centre and six estimated moments; None for others."""
    payload, index = prepared.dataset.payloads[name], prepared.layout.payloads[name]
    if payload.mass is None or payload.center_of_mass is None or not np.array_equal(index, INERTIA):
        return None
    rows = {
        unknown.name: i for i, unknown in enumerate(result.covariance_rows) if unknown.kind == "parameter"
    }
    names = payload_parameter_names(name, index)
    values = {parameter.name: parameter.value for parameter in result.parameters}
    if any(word not in values for word in names):
        return None
    at = [rows[word] for word in names]
    covariance = result.covariance[np.ix_(at, at)]
    c = np.asarray(payload.center_of_mass)
    inertia = _tensor(np.array([values[word] for word in names]))
    inertia -= payload.mass * (np.dot(c, c) * np.eye(3) - np.outer(c, c))
    moments, axes = np.linalg.eigh(0.5 * np.trace(inertia) * np.eye(3) - inertia)
    axis = axes[:, 0]
    towards = np.array([0.5 * np.trace(column) - axis @ column @ axis for column in map(_tensor, np.eye(6))])
    return _Spread(float(moments[0]), float(np.sqrt(towards @ covariance @ towards)))


def _tensor(standard: np.ndarray) -> np.ndarray:
    """The (3, 3) matrix of (6,) Ixx Ixy Iyy Ixz Iyz Izz, the order of standard parameters."""
    xx, xy, yy, xz, yz, zz = standard
    return inertia_matrix(np.array([xx, yy, zz, xy, xz, yz]))
