"""From a dataset to drive gains, base parameters and effect parameters."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from bench.basics.threads import on_one_thread
from bench.effects import EffectInstance
from bench.identification.bandwidth import with_band_checked
from bench.identification.closed_loop import commanded_currents, simulated_columns
from bench.identification.column_errors import column_errors
from bench.identification.compressed import Stack, stack_observations
from bench.identification.errors_in_variables import with_errors_in_variables_checked
from bench.identification.estimators import DEFAULT_METHOD, Request, solve
from bench.identification.gain_stability import hangs_on_equal_gains
from bench.identification.identifiability_of_effects import (
    essential_columns,
    expanded,
    identifiable_columns,
    reduced,
    with_zeros,
)
from bench.identification.impossible_payload import with_possible_payloads
from bench.identification.newton import with_shape_columns
from bench.identification.nonlinear import columns_of, converged, within_bounds
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries, Identification
from bench.identification.robust import bad_stretches
from bench.identification.solution import Solution
from bench.identification.standard_errors import Deviations, uncertainty
from bench.identification.summary import modelled_series, redundant_gains, summarise
from bench.identification.too_few import refuse_too_few_equations


def identify(
    prepared: Prepared,
    method: str = DEFAULT_METHOD,
    *,
    deviations: Deviations = "autocorrelated",
    essential: bool = False,
) -> Identification:
    """Identify drive gains and dynamic parameters together (Briot and Gautier 2012, equations 8 to 13).

    method: one of bench.identification.estimators. deviations: how standard errors are computed. essential: leave out
    base parameters that the data do not need. A physically impossible payload is compared with a possible one, and the
    answer with one that is robust to noise that passes the filters, and with that in half of the band.
    """
    prepared = converged(prepared)

    def fitted(problem: Prepared, by: str = method) -> Identification:
        return fit(problem, by, deviations=deviations, essential=essential)

    answer = with_doubts_checked(prepared, fitted(prepared), fitted)
    return with_band_checked(prepared, answer, lambda problem: fitted(problem, DEFAULT_METHOD))


@on_one_thread
def fit(
    prepared: Prepared,
    method: str = DEFAULT_METHOD,
    *,
    deviations: Deviations = "autocorrelated",
    essential: bool = False,
) -> Identification:
    """Estimate from prepared equations; see `identify`."""
    solved = _solved(prepared, method, deviations, essential=essential)
    prepared, solution, kept = solved.prepared, solved.solution, solved.kept
    shaped, extended = with_shape_columns(prepared, solved.stack, solution, kept)
    spread = uncertainty(shaped, extended, deviations)
    solution, spread = expanded(solution, spread, kept, prepared.layout.size)
    result = summarise(prepared, method, solution, spread, deviations, kept, solved.outside)
    equal = hangs_on_equal_gains(prepared, solved.stack, solved.solution, result.drive_gains)
    result = replace(result, findings=(*result.findings, *equal))
    if solution.row_weights is None:
        return result
    bad = bad_stretches(prepared.fitted, solution.row_weights, prepared.dataset.robot.joints)
    return replace(result, findings=(*result.findings, *bad))


def with_doubts_checked(
    prepared: Prepared, result: Identification, fitted: Callable[..., Identification] = fit
) -> Identification:
    """The answer `result`, checked against physically possible payloads and for the bias by noise in the filters' band.

    fitted: makes an answer from prepared equations, with a method if given.
    """
    possible = with_possible_payloads(prepared, result, fitted)
    return with_errors_in_variables_checked(prepared, possible, fitted)


@on_one_thread
def fitted_currents(prepared: Prepared) -> tuple[tuple[CurrentSeries, ...], dict[str, float]]:
    """Measured and modelled currents of every recording and drive gains by joint, as in the answer of `fit`."""
    solved = _solved(prepared, DEFAULT_METHOD, "autocorrelated", essential=False)
    theta = with_zeros(solved.solution.theta, solved.kept, solved.prepared.layout.size)
    solution = replace(solved.solution, theta=theta)
    series = tuple(modelled_series(solved.prepared, seen, solution) for seen in solved.prepared.observations)
    robot = prepared.dataset.robot
    gains = dict(zip(robot.joints, solution.gains.tolist(), strict=True))
    if robot.redundant:
        redundant = redundant_gains(solved.prepared, solution, np.zeros(len(solution.theta)))
        gains |= {joint: gain.value for joint, gain in redundant.items()}
    return series, gains


@dataclass(frozen=True)
class _Solved:
    """A model within its bounds, its equations with the columns that are kept (k,), and their solution.

    outside: effects that the data push beyond their bounds.
    """

    prepared: Prepared
    stack: Stack
    solution: Solution
    kept: np.ndarray
    outside: tuple[EffectInstance, ...]


def _solved(prepared: Prepared, method: str, deviations: Deviations, *, essential: bool) -> _Solved:
    """See `identify`."""
    prepared, outside = within_bounds(prepared)
    gains = prepared.gains
    dataset, layout = prepared.dataset, prepared.layout
    stack = stack_observations(prepared.fitted, layout, dataset.payloads)
    kept = np.setdiff1d(identifiable_columns(stack, layout, gains), columns_of(prepared, outside))
    unknowns = len(kept) + int(gains.is_fitted.sum())
    refuse_too_few_equations(prepared, stack.moving, unknowns)
    motors = np.arange(len(gains.values))

    def solved(system: Stack, columns: np.ndarray) -> Solution:
        errors = np.append(columns, [layout.size, layout.size + 1])
        request = Request(
            stack=system,
            gains=gains,
            column_errors=lambda: column_errors(prepared)[np.ix_(motors, errors, errors)],
            simulated=lambda: simulated_columns(prepared)[:, :, errors[:-1]],
            commanded=lambda: commanded_currents(prepared),
            joints=dataset.robot.joints,
            scale=prepared.scale,
        )
        return solve(method, request)

    if len(kept) < layout.size:
        stack = reduced(stack, kept)
    if essential:
        needed = essential_columns(
            stack, layout.base, lambda system, columns: solved(system, kept[columns]), deviations
        )
        stack, kept = reduced(stack, needed), kept[needed]
    return _Solved(prepared, stack, solved(stack, kept), kept, outside)
