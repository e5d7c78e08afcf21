"""From a motion to the best one near it: the largest error is made small by linear programs, one after the other.

Errors and limits are linearised about the motion; the program makes the largest error smallest within the limits and
within a step that is trusted, which grows where it predicts what comes and shrinks where it does not (sequential
linear programming, Fletcher and Sainz de la Maza, "Nonlinear programming and nonsmooth optimization by successive
linear programming", Mathematical Programming 43, 1989).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import linprog

from bench.basics.errors import BenchError
from bench.basics.progress import SILENT, Progress
from bench.excitation.experiment.linearised import Linearised, coefficient_sizes, linearised, moved
from bench.excitation.experiment.room import filled
from bench.excitation.experiment.search import Candidate, Search

FIRST, SMALLEST, MOST = 0.1, 1e-4, 0.5  # of the step that is trusted, of the largest size of a coefficient
ENOUGH, GOOD = 0.1, 0.6  # of what was predicted: to be taken, and to be trusted further
ALSO_MEAN = 0.03  # weight of all errors' mean beside the largest: where that one cannot fall, others shall


ROUNDS = ((8, 0.3), (3, 0.3), (1, 0.4))  # how many go on, and their share of the steps together


@dataclass(frozen=True)
class Descent:
    """A candidate on its way: its merit, the step that is trusted, and what is known about it, None before."""

    candidate: Candidate
    merit: float
    trusted: float = FIRST
    about: Linearised | None = None


def merit(errors: np.ndarray) -> float:
    """What falls: the largest of the errors' logarithms, and a little of their mean."""
    return float(errors.max() + ALSO_MEAN * errors.mean())


def begun(search: Search, candidate: Candidate) -> Descent:
    """A descent from a candidate."""
    return Descent(candidate, merit(search.errors(search.fit(candidate))))


def descended(search: Search, start: Descent, steps: int, progress: Progress = SILENT) -> Descent:
    """So many programs further, fewer where nothing falls any more."""
    now = start
    for step in range(steps):
        if now.trusted < SMALLEST:
            progress.advance(steps - step)
            break
        progress.advance()
        now = _stepped(search, now)
    return now


def _stepped(search: Search, now: Descent) -> Descent:
    about = linearised(search, now.candidate) if now.about is None else now.about
    step, predicted = _program(about, now.trusted)
    smaller = replace(now, trusted=0.4 * now.trusted, about=about)
    if not predicted > 0.0:
        return smaller
    other = _moved(search, now.candidate, step)
    if other is None:
        return smaller
    value = merit(search.errors(search.fit(other)))
    fallen = (now.merit - value) / predicted
    if fallen < ENOUGH:
        return smaller
    trusted = min(2.0 * now.trusted, MOST) if fallen > GOOD else now.trusted
    return Descent(other, value, trusted)


def _program(about: Linearised, trusted: float) -> tuple[np.ndarray, float]:
    """The best step (c,), in units of `coefficient_sizes`, and by how much the merit falls by it."""
    errors, limits = about.errors, about.limits
    count = errors.slopes.shape[1]
    mean = ALSO_MEAN * about.mean
    rows = np.vstack(
        (
            np.hstack((errors.slopes, -np.ones((len(errors.values), 1)))),
            np.hstack((limits.slopes, np.zeros((len(limits.values), 1)))),
        )
    )
    right = np.concatenate((-errors.values, np.maximum(1.0 - limits.values, 0.0)))
    found = linprog(
        np.append(mean, 1.0),
        A_ub=rows,
        b_ub=right,
        bounds=[*[(-trusted, trusted)] * count, (None, None)],
        method="highs",
    )
    if found.x is None:
        raise BenchError(f"search of motions: the linear program failed: {found.message}")
    step = found.x[:-1]
    return step, float(errors.values.max() - found.x[-1] - mean @ step)


def _moved(search: Search, candidate: Candidate, step: np.ndarray) -> Candidate | None:
    """The candidate with other coefficients; None where it does not keep the limits."""
    found, at = [], 0
    for number, before in enumerate(candidate):
        sizes = coefficient_sizes(search.room, before.trajectory)
        own = step[at : at + sizes.size].reshape(sizes.shape) * sizes
        at += sizes.size
        trajectory = filled(search.room, moved(before.trajectory, own))
        tried = search.tried(trajectory, search.loads[number], before.motion)
        if tried is None:
            return None
        found.append(tried)
    return tuple(found)


def best_near(
    search: Search, starts: Sequence[Candidate], steps: int, progress: Progress = SILENT
) -> Candidate:
    """The best of the starts, improved in rounds: fewer go on to each, with more steps for each of them (successive
    halving, Jamieson and Talwalkar 2016), since how good a start is does not tell how far it comes.
    """
    pool = [begun(search, start) for start in starts]
    for count, share in ROUNDS:
        pool = sorted(pool, key=lambda descent: descent.merit)[:count]
        pool = [descended(search, descent, round(share * steps / len(pool)), progress) for descent in pool]
    return min(pool, key=lambda descent: descent.merit).candidate
