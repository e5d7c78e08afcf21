"""The ladder of a diagnosis: errors of models with some of the identified effects, each fitted separately."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.batched_sets import solve_set
from bench.diagnosis.evidence import ResidualSumOfSquares, answer_squares
from bench.diagnosis.result import LadderStep
from bench.diagnosis.round import Round, with_shapes_of
from bench.diagnosis.search import held_out_error
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import kept_and_new
from bench.diagnosis.values_by_log import values_by_log
from bench.effects import EffectInstance
from bench.effects.select import at_joint
from bench.identification.identify import fit, fitted_currents
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries, Identification, relative_error


@dataclass(frozen=True)
class FittedSet:
    """A separately fitted model with some effects: the step of a ladder, and its residual."""

    step: LadderStep
    residual: ResidualSumOfSquares


Fits = Callable[[frozenset[str]], FittedSet]
"""From the names of effects to the model that has them."""


@dataclass(frozen=True)
class FittedSets:
    """The effects of a model beyond the given ones that it keeps, their names, and the fits of subsets.

    requests: effects with a value for each recording that all of these fits have.
    """

    new: tuple[EffectInstance, ...]
    names: tuple[str, ...]
    fits: Fits
    requests: tuple[str, ...]

    def ladder(self, before: Identification, *, whole: bool) -> tuple[LadderStep, ...]:
        """Errors after each added effect, the most helpful first, or only the first and last of these.

        before: the answer of the given model, the first step if all others have values by recording.
        """
        if whole:
            steps = ladder_of(self.names, self.fits)
        else:
            ends = [(), self.names] if self.names else [()]
            steps = tuple(replace(self.fits(frozenset(names)).step, effects=names) for names in ends)
        if not self.requests:
            return steps
        named = (replace(step, effects=(*self.requests, *step.effects)) for step in steps)
        return (step_of((), before.recordings), *named)


def fits_of(case: SplitProblem, base_model: BaseModel, model: Prepared, after: Identification) -> FittedSets:
    """Sets of the effects of a fitted model, each fitted once; after: with all of them."""
    given = case.start.effects
    kept, new = kept_and_new(added_effects(base_model, model), given)
    requests = tuple(dict.fromkeys(each.request for each in values_by_log(base_model.start, given)))
    before = fit(base_model.with_instances(kept)) if requests else case.before

    @cache
    def fitted(names: frozenset[str]) -> FittedSet:
        effects = [*kept, *with_special_cases([instance for instance in new if instance.name in names], new)]
        if not names:
            effects = list(kept if requests else given)
            series = before.recordings
        elif all(instance.name in names for instance in new):
            series = after.recordings
        else:
            series, _ = fitted_currents(base_model.with_instances(effects))
        return FittedSet(step_of(tuple(names), series), answer_squares(effects, series))

    return FittedSets(new, tuple(dict.fromkeys(instance.name for instance in new)), fitted, requests)


def with_special_cases(
    chosen: Sequence[EffectInstance], every: Sequence[EffectInstance]
) -> list[EffectInstance]:
    """Effects of a model, also at the places of omitted ones of which they are special cases.

    A law and its special case may each have been identified at one of two motors that have the special case both.
    """
    result = list(chosen)
    for gone in every:
        if gone in chosen:
            continue
        for part in chosen:
            moved = at_joint(part.effect, gone.joint)
            if part.effect.name in gone.effect.contains and all(moved.seat != each.seat for each in result):
                result += with_shapes_of([gone], [moved])
    return result


def errors_without(names: Sequence[str], fits: Fits) -> dict[str, float]:
    """Relative error on held-out recordings, by effect, of the identified model fitted again without it."""
    return {name: fits(frozenset(names) - {name}).step.validate or 0.0 for name in names}


def errors_nearly_without(names: Sequence[str], last: Round, scale: float) -> dict[str, float]:
    """The same from the last system, without another fit."""
    chosen, system = last.chosen, last.system
    return {
        name: scale
        * held_out_error(system, solve_set(system, [i for i in chosen if last.proposals[i].name != name]))
        for name in names
    }


def ladder_of(names: Sequence[str], fits: Fits) -> tuple[LadderStep, ...]:
    """Errors after each added effect, the most helpful first. names: of all added ones."""
    steps = [fits(frozenset()).step]
    remaining = list(names)
    taken: list[str] = []
    while remaining:
        tried = [replace(fits(frozenset((*taken, name))).step, effects=(*taken, name)) for name in remaining]
        best = min(tried, key=lambda step: step.validate or step.identify or 0.0)
        taken.append(best.effects[-1])
        remaining.remove(best.effects[-1])
        steps.append(best)
    return tuple(steps)


def step_of(effects: tuple[str, ...], fitted: Sequence[CurrentSeries]) -> LadderStep:
    """A step from the currents of its model."""
    return LadderStep(effects, _error(fitted, "identify"), _error(fitted, "validate"), tuple(fitted))


def _error(fitted: Sequence[CurrentSeries], use: str) -> float | None:
    """Relative error on the recordings of this use; None without any."""
    return relative_error([trace for trace in fitted if trace.use == use])
