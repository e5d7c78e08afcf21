"""Held-out rows in which the fitted rows do not determine the model's current.

The leverage of a row is the variance of the model's current there, over that of the noise. No fitted row has a leverage
above 1; a held-out row with more is extrapolated (Montgomery, Peck and Vining, "Introduction to Linear Regression
Analysis", section 3.8, hidden extrapolation). Its error is that of the estimate, not of a missing effect.
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
    """The same, judged only in rows with a leverage that a fitted row could have; and a report of the others.

    If less than half of a motor's rows remain, it is judged in all rows.
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
    """Variance (M, n) of the model's current in every row of `asked`, over that of its motor's noise, if columns (k,)
    are fitted, and the gains that are unknowns of the solution.
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
