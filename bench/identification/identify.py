"""From a dataset to drive gains, base parameters and effect parameters."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.effects import Effect
from bench.identification.bad_stretches import bad_stretches
from bench.identification.bounds import columns_of, within_bounds
from bench.identification.closed_loop import commanded_currents
from bench.identification.column_errors import column_errors
from bench.identification.compressed import Stack, stack_observations
from bench.identification.essential_parameters import essential_columns, expanded, reduced
from bench.identification.estimators import DEFAULT_METHOD, Request, solve
from bench.identification.filtered import measure
from bench.identification.identifiability import check_gains_identifiable
from bench.identification.identifiability_of_effects import identifiable_columns
from bench.identification.impossible_payload import with_possible_payloads
from bench.identification.layout import payload_rows
from bench.identification.newton import with_shape_columns
from bench.identification.noise_let_through import with_noise_heard
from bench.identification.prepare import Prepared as Prepared
from bench.identification.prepare import prepare as prepare
from bench.identification.result import Identification
from bench.identification.simulated import columns_at, simulated_columns
from bench.identification.solution import Solution
from bench.identification.standard_errors import Deviations, uncertainty
from bench.identification.summary import summarise
from bench.signals.settings import FilterSettings


@on_one_thread
def identify(
    dataset: Dataset,
    effects: Sequence[str] = (),
    method: str = DEFAULT_METHOD,
    *,
    filters: FilterSettings | Mapping[str, Any] | None = None,
    deviations: Deviations = "autocorrelated",
    fit_gains: bool | None = None,
    essential: bool = False,
    catalogue: Mapping[str, Effect] | None = None,
) -> Identification:
    """Identify drive gains and dynamic parameters together (Briot and Gautier 2012, equations 8 to 13).

    effects: names as EFFECT or EFFECT:PLACE, added to the rigid-body model; with @recording behind, an effect has a
    value for each fitted recording. method: one of bench.identification.estimators. filters: settings, or some of
    them by name; the others are chosen from the spectra. deviations: how standard deviations are computed. fit_gains:
    by default, where a fitted recording carries a payload of known mass; without one the gains stay nominal.
    essential: leave out base parameters that the data do not need. catalogue: the effects by name, by default the
    built-in ones and the dataset's own. Raises BenchError naming what in the data or the robot cannot be used.
    """
    prepared = prepare(dataset, effects, filters, catalogue=catalogue)
    return believed(prepared, method, deviations=deviations, fit_gains=fit_gains, essential=essential)


def believed(
    prepared: Prepared,
    method: str = DEFAULT_METHOD,
    *,
    deviations: Deviations = "autocorrelated",
    fit_gains: bool | None = None,
    essential: bool = False,
) -> Identification:
    """Estimate from prepared equations, see `identify`, with payloads that can be and with what noise does to it."""

    def fitted(one: Prepared, by: str = method) -> Identification:
        return fit(one, by, deviations=deviations, fit_gains=fit_gains, essential=essential)

    return with_noise_heard(prepared, with_possible_payloads(prepared, fitted(prepared), fitted), fitted)


@on_one_thread
def fit(
    prepared: Prepared,
    method: str = DEFAULT_METHOD,
    *,
    deviations: Deviations = "autocorrelated",
    fit_gains: bool | None = None,
    essential: bool = False,
) -> Identification:
    """Estimate from prepared equations; see `identify`."""
    fit_gains = gains_can_be_fitted(prepared, fit_gains)
    prepared, outside = within_bounds(prepared, fit_gains)
    dataset, layout = prepared.dataset, prepared.layout
    stack = stack_observations(prepared.fitted, layout, dataset.payloads)
    kept = np.setdiff1d(identifiable_columns(stack, layout, fit_gains), columns_of(prepared, outside))
    unknowns = len(kept) + (stack.current.shape[1] if fit_gains else 0)
    equations = int(stack.moving.sum())
    if equations < 2 * unknowns:
        raise BenchError(
            f"{dataset.folder}: {equations} equations after decimation are too few for {unknowns} unknowns"
        )
    nominal = dataset.robot.nominal_gains
    motors = np.arange(len(nominal))

    def solved(system: Stack, columns: np.ndarray) -> Solution:
        errors = np.append(columns, [layout.size, layout.size + 1])
        request = Request(
            stack=system,
            nominal=nominal,
            fit_gains=fit_gains,
            column_errors=lambda: _column_errors(prepared)[np.ix_(motors, errors, errors)],
            simulated=lambda: simulated_columns(prepared)[:, :, errors[:-1]],
            commanded=lambda: commanded_currents(prepared),
            joints=dataset.robot.joints,
        )
        return solve(method, request)

    if len(kept) < layout.size:
        stack = reduced(stack, kept)
    if essential:
        needed = essential_columns(
            stack, layout.base, lambda system, columns: solved(system, kept[columns]), deviations
        )
        stack, kept = reduced(stack, needed), kept[needed]
    solution = solved(stack, kept)
    shaped, extended = with_shape_columns(prepared, stack, solution, kept)
    spread = uncertainty(shaped, extended, deviations)
    solution, spread = expanded(solution, spread, kept, layout.size)
    result = summarise(prepared, method, solution, spread, deviations, kept, outside)
    if solution.counted is None:
        return result
    bad = bad_stretches(prepared.fitted, solution.counted, dataset.robot.joints)
    return replace(result, findings=(*result.findings, *bad))


def gains_can_be_fitted(prepared: Prepared, wanted: bool | None) -> bool:
    """Whether the drive gains are unknowns: as wanted, by default where a known payload gives their scale.

    Raises BenchError where they are wanted and cannot be had.
    """
    dataset = prepared.dataset
    scaled = any(np.any(payload_rows(one, dataset.payloads)) for one in prepared.fitted)
    if wanted and not scaled:
        raise BenchError(
            f"{dataset.folder}: no fitted recording has a payload of known mass, which gives the gains' scale"
        )
    if wanted is False or not scaled:
        return False
    carried = [one.payload_name for one in prepared.fitted]
    check_gains_identifiable(prepared.model, prepared.layout, dataset.payloads, carried)
    return True


def _column_errors(prepared: Prepared) -> np.ndarray:
    """See bench.identification.column_errors."""

    def columns(recording: Recording) -> tuple[np.ndarray, np.ndarray]:
        found = columns_at(prepared, measure(prepared.model, recording, prepared.settings))
        return found[:, :, :-1], found[:, :, -1]

    recordings = [one.recording for one in prepared.measured if one.recording.use == "identify"]
    return column_errors(recordings, prepared.settings, columns)
