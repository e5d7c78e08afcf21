"""The estimators by name. Each takes the stacked equations and returns a solution.

An estimator's module is imported when it runs: the help of commands, which needs names only, is quick.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from bench.basics.errors import BenchError

if TYPE_CHECKING:
    import numpy as np

    from bench.identification.compressed import Stack
    from bench.identification.scale import Scale
    from bench.identification.solution import NominalGains, Solution

DEFAULT_METHOD = "current"


@dataclass(frozen=True)
class Request:
    """The inputs of an estimator: the equations, the declared gains, joints (n,), and what keeps gains nominal.

    Functions, since not always needed: the errors of the columns, [phi, kappa] (M, n, p + 1) at a twin's motion, and
    the terms (M, n, 3) of the controller's law.
    """

    stack: Stack
    gains: NominalGains
    column_errors: Callable[[], np.ndarray]
    simulated: Callable[[], np.ndarray]
    commanded: Callable[[], np.ndarray]
    joints: tuple[str, ...]
    scale: Scale


def _current(request: Request) -> Solution:
    from bench.identification.current_error import from_best_start

    return from_best_start(request.stack, _wls(request), request.gains)


def _robust(request: Request) -> Solution:
    from bench.identification.robust import robust_error

    return robust_error(request.stack, _wls(request), request.gains.values)


def _iv(request: Request) -> Solution:
    from bench.identification.instrumental import instrumental_variables

    return instrumental_variables(request.stack, _wls(request), request.gains.values, request.simulated())


def _oe(request: Request) -> Solution:
    from bench.identification.closed_loop import output_error

    return output_error(
        request.stack,
        _wls(request),
        request.gains.values,
        request.commanded(),
        request.simulated(),
        request.joints,
    )


def _wtls(request: Request) -> Solution:
    from bench.identification.least_squares import weighted_total_least_squares

    return weighted_total_least_squares(request.stack, _wls(request), request.column_errors())


def _tls(request: Request) -> Solution:
    from bench.identification.least_squares import total_least_squares

    return total_least_squares(request.stack)


def _wls(request: Request) -> Solution:
    from bench.identification.least_squares import weighted_least_squares

    return weighted_least_squares(request.stack, request.gains)


def _ls(request: Request) -> Solution:
    from bench.identification.least_squares import least_squares

    return least_squares(request.stack, request.gains)


ESTIMATORS: dict[str, Callable[[Request], Solution]] = {
    "current": _current,
    "robust": _robust,
    "iv": _iv,
    "oe": _oe,
    "wtls": _wtls,
    "tls": _tls,
    "wls": _wls,
    "ls": _ls,
}
"""In display order; commands and tables take the names from this."""
NEED_SCALE = ("tls", "wtls")


def solve(method: str, request: Request) -> Solution:
    """Run the estimator `method`. Raises BenchError if it is unknown, or needs gains that no payload fixes."""
    if method not in ESTIMATORS:
        raise BenchError(f"unknown method {method!r}; known: {', '.join(ESTIMATORS)}")
    if method in NEED_SCALE and not request.scale.complete:
        from bench.identification.scale_words import refusal

        raise BenchError(
            f"method {method!r} fits all drive gains: {refusal(request.scale)} Or use current, robust, ls or wls."
        )
    return ESTIMATORS[method](request)
