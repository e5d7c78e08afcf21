"""Local improvement of a motion: successive linear programs reduce the largest error.

Errors and limits are linearised about the motion; the program minimises the largest error within the limits and a trust
region, which grows if the prediction is right and shrinks if it is not (sequential linear programming, Fletcher and
Sainz de la Maza, "Nonlinear programming and nonsmooth optimization by successive linear programming", Mathematical
Programming 43, 1989).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import islice

import numpy as np
from scipy.optimize import linprog

from bench.basics.errors import BenchError
from bench.basics.mapper import IN_TURN, Mapper
from bench.basics.progress import SILENT, Progress
from bench.excitation.bounds import SEARCH
from bench.excitation.experiment.linearised import Linearised, coefficient_sizes, linearised, moved
from bench.excitation.experiment.room import filled
from bench.excitation.experiment.search import Candidate, Search, Tried
from bench.model.motion import Motion
from bench.scenario.trajectory import FourierTrajectory


@dataclass(frozen=True)
class Descent:
    """A candidate in descent: its merit, its trusted step, and its linearisation, None before the first."""

    candidate: Candidate
    merit: float
    trusted: float = SEARCH.first_step
    about: Linearised | None = None


def merit(errors: np.ndarray) -> float:
    """The largest of the errors' logarithms, and a little of their mean."""
    return float(errors.max() + SEARCH.mean_weight * errors.mean())


def begun(search: Search, candidate: Candidate) -> Descent:
    """A descent from a candidate."""
    return Descent(candidate, merit(search.errors(search.fit(candidate))))


def descended(
    search: Search,
    starts: Sequence[Descent],
    steps: int,
    mapper: Mapper = IN_TURN,
    progress: Progress = SILENT,
) -> list[Descent]:
    """Each after `steps` programs, or fewer without further improvement: all make a step, then all the next."""
    now = list(starts)
    for _ in range(steps):
        going = [k for k, descent in enumerate(now) if descent.trusted >= SEARCH.smallest_step]
        stepped = _stepped(search, [now[k] for k in going], mapper)
        for k, descent in zip(going, stepped, strict=True):
            now[k] = descent
        progress.advance(len(now))
    return now


def _stepped(search: Search, descents: Sequence[Descent], mapper: Mapper) -> list[Descent]:
    """Each one program on."""
    new = [descent.candidate for descent in descents if descent.about is None]
    about = iter(linearised(search, new, mapper))
    known = [next(about) if descent.about is None else descent.about for descent in descents]
    asked = list(zip(known, (descent.trusted for descent in descents), strict=True))
    programs = list(mapper.map(_program, search, asked))
    changes = [
        _changes(search, descent.candidate, step) if predicted > 0.0 else []
        for descent, (step, predicted) in zip(descents, programs, strict=True)
    ]
    tried = mapper.map(_tried, search, [change for of_one in changes for change in of_one])
    return [
        _judged(search, replace(descent, about=about), predicted, list(islice(tried, len(of_one))))
        for descent, about, (_, predicted), of_one in zip(descents, known, programs, changes, strict=True)
    ]


def _judged(search: Search, now: Descent, predicted: float, other: Sequence[Tried | None]) -> Descent:
    """The result of a step: other motions, or a smaller step. other: None if one violates limits, empty if the program
    predicts no improvement.
    """
    smaller = replace(now, trusted=0.4 * now.trusted)
    kept = tuple(trial for trial in other if trial is not None)
    if not kept or len(kept) < len(other):
        return smaller
    value = merit(search.errors(search.fit(kept)))
    fallen = (now.merit - value) / predicted
    if fallen < SEARCH.enough:
        return smaller
    trusted = min(2.0 * now.trusted, SEARCH.largest_step) if fallen > SEARCH.good else now.trusted
    return Descent(kept, value, trusted)


def _program(_: Search, asked: tuple[Linearised, float]) -> tuple[np.ndarray, float]:
    """The best step (c,), in units of `coefficient_sizes`, and its reduction of the merit.

    Without errors and limits that no step of the trusted size makes active.
    """
    about, trusted = asked
    strays = trusted * np.abs(about.errors.slopes).sum(axis=1)
    errors = about.errors.at(about.errors.values + strays >= (about.errors.values - strays).max())
    limits = about.limits.at(about.limits.values + trusted * np.abs(about.limits.slopes).sum(axis=1) > 1.0)
    mean = SEARCH.mean_weight * about.mean
    largest = np.repeat([-1.0, 0.0], [len(errors.values), len(limits.values)])  # the last unknown
    optimum = linprog(
        np.append(mean, 1.0),
        A_ub=np.column_stack((np.vstack((errors.slopes, limits.slopes)), largest)),
        b_ub=np.concatenate((-errors.values, np.maximum(1.0 - limits.values, 0.0))),
        bounds=[*[(-trusted, trusted)] * len(mean), (None, None)],
        method="highs",
    )
    if optimum.x is None:
        raise BenchError(f"search of motions: the linear program failed: {optimum.message}")
    step = optimum.x[:-1]
    return step, float(errors.values.max() - optimum.x[-1] - mean @ step)


_Change = tuple[FourierTrajectory, str | None, Motion]
"""A trajectory, its payload, and the motion that it modifies."""


def _changes(search: Search, candidate: Candidate, step: np.ndarray) -> list[_Change]:
    """The motions of a candidate with other coefficients."""
    changes, at = [], 0
    for before, load in zip(candidate, search.loads, strict=True):
        sizes = coefficient_sizes(search.room, before.trajectory)
        of_motion = step[at : at + sizes.size].reshape(sizes.shape) * sizes
        at += sizes.size
        changes.append((filled(search.room, moved(before.trajectory, of_motion)), load, before.motion))
    return changes


def _tried(search: Search, change: _Change) -> Tried | None:
    """The changed motion with its rows; None if it violates the limits."""
    return search.tried(*change)


def best_near(
    search: Search,
    starts: Sequence[Candidate],
    steps: int,
    mapper: Mapper = IN_TURN,
    progress: Progress = SILENT,
) -> Candidate:
    """The best of the starts, improved in rounds: fewer continue in each, with more steps for each of them (successive
    halving, Jamieson and Talwalkar 2016), since a start's merit does not predict its final one.
    """
    pool = [begun(search, start) for start in starts]
    for count, share in SEARCH.rounds:
        pool = sorted(pool, key=lambda descent: descent.merit)[:count]
        pool = descended(search, pool, round(share * steps / len(pool)), mapper, progress)
    return min(pool, key=lambda descent: descent.merit).candidate
