"""Whether units, columns and loads of the data are declared correctly."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.basics.errors import BenchError
from bench.basics.joint_units import drive_unit
from bench.basics.threads import on_one_thread
from bench.dataset.dataset import Dataset
from bench.identification.finding import NEGATIVE, WRONG_DATA, Code, Finding
from bench.identification.finding_words import sentence
from bench.identification.other_loads import exchanged_loads, other_load, undeclared_load
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, Identification
from bench.identification.reversed_columns import reversed_currents, reversed_positions
from bench.identification.swapped_columns import (
    ColumnsTrial,
    rigid_equations,
    swapped_columns,
)
from bench.identification.tolerances import TOLERANCES


@on_one_thread
def mistaken(
    problem: Problem, result: Identification, prepared: Prepared | None = None, deadline: Deadline = NEVER
) -> tuple[Finding, ...]:
    """What is probably declared wrongly. If currents have unlike units or the wrong sign, nothing else is checked, as
    everything is off then.

    prepared: the problem's equations with the filters of the result, if available. Raises TimeUpError after the
    deadline.
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
        if len(reversed_) == len(result.joints) and (exchanged := exchanged_loads(problem, result)):
            return (*heavy, *exchanged)
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
    """A finding for each payload that is declared far heavier than the robot."""
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

    names: a recording with small currents, then those with large ones. Compares the RMS of every motor's measured
    current, in all recordings.
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
    """Logarithm to base 10 (n,) of the RMS of every motor's current; -inf for zero."""
    rms = np.sqrt((series.measured**2).mean(axis=0))
    return np.log10(rms, out=np.full(len(rms), -np.inf), where=rms > 0.0)


def refuse_signs(folder: Path, causes: Sequence[Finding], before: Identification) -> None:
    """Raise BenchError for a column with the wrong sign or joint, or exchanged loads, before a search.

    A negative gain of the starting model counts if that model explains the currents: otherwise a missing effect may
    have made it negative.
    """
    wrong = [finding for finding in causes if finding.code in WRONG_DATA]
    error = before.error.identify
    if error is not None and error < TOLERANCES.findings.large_error:
        wrong += [finding for finding in before.findings if finding.code in NEGATIVE]
    if wrong:
        raise BenchError(f"{folder}: {sentence(wrong[0])}")
