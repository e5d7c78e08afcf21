"""Search from a first round until every selected effect is possible and needed."""

from collections.abc import Mapping

from bench.basics.deadline import TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.ladder import fits_of
from bench.diagnosis.pruning import superfluous_effect
from bench.diagnosis.reason import Reason
from bench.diagnosis.result import Unfinished
from bench.diagnosis.round import Round
from bench.diagnosis.rounds import searched, staying
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import leaving
from bench.diagnosis.where_possible import where_possible

NONE_BARRED: Mapping[str, Reason] = {}


def search_from(
    case: SplitProblem,
    base_model: BaseModel,
    first: Round,
    progress: Progress = SILENT,
    barred: Mapping[str, Reason] = NONE_BARRED,
    *,
    wholly: bool = False,
) -> SearchResult:
    """Search from a first round until every identified effect is possible and needed.

    barred: effects that may not be selected, and why. After the deadline the answer is the best set so far, completed;
    wholly: raise TimeUpError instead.
    """
    known, given = dict(barred), case.start.effects
    cut = False
    searching, base_model = base_model, base_model.at_leisure
    given_round = [first]
    del first  # passed on without a name, to free its system before the next is built
    while True:
        last = (
            staying(base_model, given_round.pop(), known)
            if cut
            else searched(searching, given_round.pop(), known, progress)
        )
        cut = last.cut
        if cut and wholly:
            raise TimeUpError
        progress.phase("fitting what was found")
        model, after, out = where_possible(base_model, last.model, given, last.system.samples)
        exact = base_model.exactly(last.model) if out else last.model
        if exact is not last.model:  # no effect is removed because of approximate columns
            model, after, out = where_possible(base_model, exact, given, last.system.samples)
        if not out:
            model, after, superfluous = leaving(base_model, model, after, given, last.system.samples)
            sets = fits_of(case, base_model, model, after)
            names, fits = sets.names, sets.fits
            if not cut:
                excess = base_model.floor.excess(after.error.validate or 0.0)
                out = superfluous_effect(fits, names, last.system.samples.beyond(excess))
        if not out:
            missed = (Unfinished.SETS,) if cut else ()
            ladder = sets.ladder(case.before, whole=not cut)
            return SearchResult(
                searching,
                last,
                model,
                after,
                sets.new,
                names,
                fits,
                ladder,
                superfluous,
                known,
                unfinished=missed,
            )
        known |= out
        given_round.append(last)
