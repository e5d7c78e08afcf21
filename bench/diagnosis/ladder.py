"""The ladder of a diagnosis: what a model with some of the identified effects leaves, each fitted by itself."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.evidence import ResidualSumOfSquares, answer_squares
from bench.diagnosis.normal_equations import solve_set
from bench.diagnosis.result import LadderStep
from bench.diagnosis.round import Round
from bench.diagnosis.search import held_out_error
from bench.diagnosis.split_problem import SplitProblem
from bench.diagnosis.starting import kept_and_new
from bench.diagnosis.values_by_log import values_by_log
from bench.effects import EffectInstance
from bench.identification.identify import fit, fitted_currents
from bench.identification.prepare import Prepared
from bench.identification.result import CurrentSeries, DriveGain, Identification, relative_error


@dataclass(frozen=True)
class FittedSet:
    """A model with some effects, fitted by itself: the step of a ladder, what it leaves, and its drive gains."""

    step: LadderStep
    residual: ResidualSumOfSquares
    gains: Mapping[str, float]


Fits = Callable[[frozenset[str]], FittedSet]
"""From the names of effects to the model that has them."""


@dataclass(frozen=True)
class FittedSets:
    """The effects that a model has beyond what is kept of the given ones, their names, and the fits of some of them.

    requests: effects with a value for each recording that all of these fits have.
    """

    new: tuple[EffectInstance, ...]
    names: tuple[str, ...]
    fits: Fits
    requests: tuple[str, ...]

    def ladder(self, before: Identification, *, whole: bool) -> tuple[LadderStep, ...]:
        """Errors after each added effect, the one that helps most first, or the first and the last of these alone.

        before: the answer of the given model; where all steps have values for each recording, it is the first.
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
        chosen = [instance for instance in new if instance.name in names]
        if not names:
            series, gains = before.recordings, values_of(before.drive_gains)
        elif len(chosen) == len(new):
            series, gains = after.recordings, values_of(after.drive_gains)
        else:
            series, gains = fitted_currents(base_model.with_instances([*kept, *chosen]))
        return FittedSet(step_of(tuple(names), series), answer_squares([*kept, *chosen], series), gains)

    return FittedSets(new, tuple(dict.fromkeys(instance.name for instance in new)), fitted, requests)


def values_of(gains: Mapping[str, DriveGain]) -> dict[str, float]:
    """Drive gains by joint, without their standard errors."""
    return {joint: gain.value for joint, gain in gains.items()}


def errors_without(names: Sequence[str], fits: Fits) -> dict[str, float]:
    """Relative error on recordings that were not fitted, by effect, of the identified model without it, fitted anew."""
    return {name: fits(frozenset(names) - {name}).step.validate or 0.0 for name in names}


def errors_nearly_without(names: Sequence[str], last: Round, scale: float) -> dict[str, float]:
    """The same as the last system knows it, without fitting anything."""
    chosen, system = last.chosen, last.system
    return {
        name: scale
        * held_out_error(system, solve_set(system, [i for i in chosen if last.proposals[i].name != name]))
        for name in names
    }


def ladder_of(names: Sequence[str], fits: Fits) -> tuple[LadderStep, ...]:
    """Errors after each added effect, the one that helps most first. names: of all that are added."""
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
    """A step by the currents that its model gives."""
    return LadderStep(effects, _error(fitted, "identify"), _error(fitted, "validate"), tuple(fitted))


def _error(fitted: Sequence[CurrentSeries], use: str) -> float | None:
    """Relative error on the recordings of this use; None without any."""
    return relative_error([trace for trace in fitted if trace.use == use])
