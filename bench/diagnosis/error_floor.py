"""The error on held-out recordings that no set of effects explains, and how far sets are from it."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from bench.diagnosis.encoder_noise import encoder_error
from bench.diagnosis.noise import not_repeated
from bench.diagnosis.result import excess_of
from bench.diagnosis.search import Selection, held_out_error
from bench.diagnosis.system import System
from bench.diagnosis.unexplained import relative_noise_floor
from bench.identification.decision import RULE
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import modelled_series
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class ErrorFloor:
    """Relative errors of a search's starting model on held-out recordings: noise of the currents, the part that does
    not repeat with the motion, None if this never returns, and that of encoder noise, computed when needed.
    """

    noise: float
    repeats: float | None
    encoders: Callable[[], float]

    def excess(self, error: float) -> float:
        """Logarithm, at least zero, of an error over the floor: see `Unexplained.excess`."""
        if error <= RULE.beyond_noise * self.noise:
            return 0.0
        return excess_of(error, self.noise, self.encoders(), self.repeats)


def error_floor(start: Prepared) -> ErrorFloor:
    """The floor of a search from a converged model."""
    _, solution = solved_quickly(start)
    series = [modelled_series(start, seen, solution) for seen in start.observations]
    held_out = [trace for trace in series if trace.use == "validate"] or series
    recordings = [entry.recording for entry in start.measured]
    noise = relative_noise_floor(recordings, held_out, start.settings)
    return ErrorFloor(noise, not_repeated(series), cache(lambda: encoder_error(start)))


def judged_by_its_error(
    system: System, floor: ErrorFloor, searched: Callable[[System], Selection]
) -> tuple[System, Selection]:
    """The most probable set, where as many samples count as at its error, and the system with these.

    More than noise is left where a model is wrong, and its errors return with the motion: fewer samples are independent
    (see `DecisionRule.coarsening_beyond`). From the set that is best at the noise; where it leaves more, fewer samples
    count, and a smaller set may be more probable.
    """
    found = searched(system)
    for _ in range(TOLERANCES.search.rounds):
        excess = floor.excess(held_out_error(system, found.selected.fit))
        if excess <= system.excess:
            break
        system = replace(system, excess=excess)
        found = searched(system)
    return system, found
