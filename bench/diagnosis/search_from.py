"""Search from a first round on until every selected effect is possible and needed."""

from collections.abc import Mapping
from functools import partial

from bench.basics.deadline import TimeUpError
from bench.basics.progress import SILENT, Progress
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.encoder_noise import encoder_error
from bench.diagnosis.ladder import ends_of_ladder, fits_of, ladder_of, with_values_before
from bench.diagnosis.pruning import gain_like_effect, improbable_effect, superfluous_effect
from bench.diagnosis.reason import Reason
from bench.diagnosis.result import Unfinished
from bench.diagnosis.rounds import Round, searched, staying
from bench.diagnosis.search_result import SearchResult
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import kept_and_new, leaving
from bench.diagnosis.unexplained import excess
from bench.diagnosis.values_by_log import values_by_log
from bench.diagnosis.where_possible import where_possible
from bench.identification.identify import fit

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
    """Search from a first round on until every identified effect is possible and needed.

    barred: effects that may not be selected, and why. After the deadline the best set so far is the answer, brought to
    its end; wholly: TimeUpError is raised instead.
    """
    known, given = dict(barred), case.start.effects
    given_count, cut, only_stays = len(base_model.start.effects), False, False
    searching, base_model = base_model, base_model.at_leisure
    given_round = [first]
    del first  # handed on without a name, so that its system is gone before the next is built
    while True:
        this_round = given_round.pop()
        last = (
            staying(base_model, this_round, known)
            if cut or only_stays
            else searched(searching, this_round, known, progress)
        )
        cut = last.cut and not only_stays
        if cut and wholly:
            raise TimeUpError
        progress.phase("fitting what was found")
        model, after, out = where_possible(base_model, last.model, given, last.system.samples)
        exact = base_model.exactly(last.model) if out else last.model
        if exact is not last.model:  # nothing goes because of what is only nearly so
            model, after, out = where_possible(base_model, exact, given, last.system.samples)
        if not out:
            model, after, superfluous = leaving(base_model, model, after, given, last.system.samples)
            kept, new = kept_and_new(model.effects[given_count:], given)
            names = tuple(dict.fromkeys(instance.effect.name for instance in new))
            each = dict.fromkeys(instance.request for instance in values_by_log(base_model.start, given))
            without = fit(base_model.with_instances(kept)) if each else case.before
            fits = fits_of(base_model, kept, new, without, after)
            if not cut:
                error_excess = partial(
                    excess, after, case.problem.dataset.recordings, partial(encoder_error, model)
                )
                out = superfluous_effect(fits, names, last.system.samples)
                out = out or gain_like_effect(fits, names, last.system.samples, after, error_excess)
                if not out:
                    out = improbable_effect(fits, names, last.system.samples, error_excess)
                    only_stays = only_stays or bool(out)
        if not out:
            ladder = ends_of_ladder(names, fits) if cut else ladder_of(names, fits)
            ladder = with_values_before(ladder, [*each], case.before)
            missed = (Unfinished.SETS,) if cut else ()
            return SearchResult(
                searching,
                last,
                model,
                after,
                new,
                names,
                fits,
                ladder,
                superfluous,
                known,
                unfinished=missed,
            )
        known |= out
        given_round.append(last)
