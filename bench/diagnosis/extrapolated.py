"""Rows that were not fitted and in which the fitted ones do not determine what the model gives.

The leverage of a row is the variance of what the model gives there, over that of the noise. No row that was fitted has
one above 1; a row that was not and has more lies outside what was fitted (Montgomery, Peck and Vining,
"Introduction to Linear Regression Analysis", section 3.8, hidden extrapolation). Its error is that of the estimate, of
which no effect is the cause.
"""

from dataclasses import replace

import numpy as np

from bench.identification.compressed import Stack, stack_observations
from bench.identification.finding import Code, Finding
from bench.identification.observation import Observation
from bench.identification.prepare import Prepared
from bench.identification.solution import Solution
from bench.identification.solve_only import identifiable, solved_quickly
from bench.identification.standard_errors import jacobian_series
from bench.identification.tolerances import TOLERANCES


def without_extrapolation(prepared: Prepared) -> tuple[Prepared, tuple[Finding, ...]]:
    """The same, judged only in rows whose leverage a fitted row could have; and what else there is.

    A motor with fewer of these than of others is judged in all: there is too little else to judge it by.
    """
    checked = [seen for seen in prepared.observations if seen.use == "validate"]
    if not checked:
        return prepared, ()
    stack, solution = solved_quickly(prepared)
    kept = identifiable(prepared, stack)
    asked = stack_observations(checked, prepared.layout, prepared.dataset.payloads)
    within = leverage(stack, asked, solution, kept) <= TOLERANCES.statistics.leverage
    few = 2 * (asked.moving & within).sum(axis=0) < asked.moving.sum(axis=0)
    in_range = asked.moving & (within | few)
    findings = []
    if not in_range[asked.moving].all():
        findings.append(
            Finding(Code.EXTRAPOLATED, numbers={"share": 1.0 - float(in_range.sum() / asked.moving.sum())})
        )
    if few.any():
        joints = np.array(prepared.dataset.robot.joints)
        findings.append(Finding(Code.JUDGED_BEYOND, tuple(joints[few].tolist())))
    parts = iter(np.split(in_range, asked.starts[1:]))

    def narrowed(seen: Observation) -> Observation:
        return replace(seen, moving=next(parts)) if seen.use == "validate" else seen

    return replace(prepared, observations=tuple(map(narrowed, prepared.observations))), tuple(findings)


def leverage(fitted: Stack, asked: Stack, solution: Solution, kept: np.ndarray) -> np.ndarray:
    """Variance (M, n) of what the model gives in every row asked for, over that of its motor's noise, when
    columns (k,) are fitted, and the gains that the solution has as unknowns.
    """
    gains = np.flatnonzero(np.broadcast_to(solution.gains_fitted, solution.gains.shape))
    unknowns = np.concatenate((kept, fitted.phi.shape[2] + gains))
    rows, more = (
        (jacobian_series(stack, solution)[:, :, unknowns] * solution.weights[:, None]).reshape(
            -1, len(unknowns)
        )
        for stack in (fitted, asked)
    )
    lengths = np.linalg.norm(rows, axis=0)
    lengths[lengths == 0.0] = 1.0
    spread = (more / lengths) @ np.linalg.pinv(np.linalg.qr(rows / lengths, mode="r"))
    return np.asarray((spread**2).sum(axis=1).reshape(asked.moving.shape))
