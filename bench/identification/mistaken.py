"""Whether the data are what they are declared to be: units, columns and loads."""

from bench.identification.finding import Finding
from bench.identification.other_load import other_load
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.swapped_columns import swapped_columns
from bench.identification.unlike_units import unlike_units


def mistaken(
    problem: Problem, result: Identification, prepared: Prepared | None = None
) -> tuple[Finding, ...]:
    """What is probably declared wrongly. Beside currents in unlike units nothing else is looked for: all is off then.

    prepared: the problem's equations with the filters of the result, where they are at hand.
    """
    units = unlike_units(result)
    if units:
        return tuple(units)
    return (*swapped_columns(problem, result, prepared), *other_load(problem, result, prepared))
