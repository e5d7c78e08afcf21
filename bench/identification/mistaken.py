"""Whether the data are what they are declared to be: units, columns and loads."""

from dataclasses import replace

from bench.basics.deadline import NEVER, Deadline
from bench.dataset.dataset import Dataset
from bench.identification.finding import Code, Finding
from bench.identification.other_load import other_load
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.reversed_currents import reversed_currents
from bench.identification.reversed_positions import reversed_positions
from bench.identification.swapped_columns import swapped_columns
from bench.identification.tolerances import TOLERANCES
from bench.identification.undeclared_load import undeclared_load
from bench.identification.unlike_units import unlike_units


def mistaken(
    problem: Problem,
    result: Identification,
    prepared: Prepared | None = None,
    deadline: Deadline = NEVER,
) -> tuple[Finding, ...]:
    """What is probably declared wrongly. With currents in unlike units, or of the wrong sign, nothing else is looked
    for: all is off then.

    prepared: the problem's equations with the filters of the result, where they are at hand. Raises TimeUpError after
    the deadline.
    """
    heavy = heavy_payloads(problem.dataset)
    units = unlike_units(result)
    if units:
        return (*heavy, *units)
    error = result.error.identify
    if error is None or error < TOLERANCES.findings.large_error:
        return (*heavy, *other_load(problem, result, prepared, deadline))
    if prepared is None:
        prepared = prepare(
            replace(problem, effects=(), filters=result.settings, fit_gains=result.gains_fitted)
        )
    reversed_ = reversed_currents(result, prepared, deadline)
    if reversed_:
        left = min(finding.numbers["after"] for finding in reversed_)
        better = reversed_positions(problem, result, prepared, deadline, other=left)
        return (*heavy, *(better or reversed_))
    swapped = swapped_columns(problem, result, prepared, deadline)
    loads = other_load(problem, result, prepared, deadline)
    if not (swapped or loads):
        loads = undeclared_load(problem, result, prepared, deadline)
    positions = [] if swapped or loads else reversed_positions(problem, result, prepared, deadline)
    return (*heavy, *swapped, *loads, *positions)


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
