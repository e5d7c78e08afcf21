"""Whether one converged model leaves clearly less than another, on recordings that were fitted and on others."""

from dataclasses import dataclass

import numpy as np

from bench.diagnosis.normal_equations import System
from bench.diagnosis.search import MATERIAL, NEEDED
from bench.identification.bilinear import run_away
from bench.identification.prepare import Prepared
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import modelled_current


@dataclass(frozen=True)
class SquaresLeft:
    """What a converged model leaves: sums of squares (n,) of every motor's current, drive units squared.

    unknowns: how many it has; away: whether a gain of it has run away from the nominal one.
    """

    fitted: np.ndarray
    judged: np.ndarray
    unknowns: int
    away: bool


def left_by(model: Prepared) -> SquaresLeft:
    """Of the recordings that were fitted, and of those that were not."""
    _, solution = solved_quickly(model)
    squares = {"identify": np.zeros(len(solution.gains)), "validate": np.zeros(len(solution.gains))}
    for observation in model.observations:
        error = (observation.current - modelled_current(model, observation, solution)) * observation.moving
        squares[observation.use] += (error**2).sum(axis=0)
    shapes = sum(len(instance.effect.shape) for instance in model.effects)
    away = bool(run_away(solution.gains / model.dataset.robot.nominal_gains))
    return SquaresLeft(squares["identify"], squares["validate"], model.layout.size + shapes, away)


def leaves_clearly_less(system: System, model: SquaresLeft, other: SquaresLeft) -> bool:
    """Whether a model leaves clearly less than the other: by MATERIAL on recordings that were not fitted, and by NEEDED
    nats in all, every motor by what the other leaves of it. system: how many samples count.
    """
    weights = 1.0 / np.maximum(other.fitted, np.finfo(float).tiny)
    if not float(model.judged @ weights) < (1.0 - MATERIAL) ** 2 * float(other.judged @ weights):
        return False
    fitted = system.fitted.rows * _log_ratio(other.fitted @ weights, model.fitted @ weights)
    judged = system.judged.rows * _log_ratio(other.judged @ weights, model.judged @ weights)
    samples = system.fitted.rows / (system.memory * system.repeats)
    penalty = 0.5 * (model.unknowns - other.unknowns) * np.log(max(samples, 1.0))
    return bool(0.5 * (fitted + judged) / (system.memory * system.repeats) - penalty > NEEDED)


def _log_ratio(above: float, below: float) -> float:
    tiny = np.finfo(float).tiny
    return float(np.log((above + tiny) / (below + tiny)))
