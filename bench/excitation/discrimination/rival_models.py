"""The two models between which given data cannot decide, both fitted to all data."""

from dataclasses import dataclass, replace

import numpy as np

from bench.basics.errors import BenchError
from bench.effects import EffectInstance, effect_columns
from bench.identification.autocorrelation_time import autocorrelation_time
from bench.identification.compressed import Stack
from bench.identification.effect_columns import PresentModel, robot_signals
from bench.identification.identifiability_of_effects import identifiable_columns
from bench.identification.nonlinear import converged, present_model
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import Problem
from bench.identification.solution import Solution
from bench.identification.solve_only import solved_quickly
from bench.identification.standard_errors import residual_series


@dataclass(frozen=True)
class Rival:
    """A model with one of the two effects. request: how the user named it; instances: the effect at each of its places.

    absorbed: the model's parameters absorb the effect, so that no data of this robot can show it. follows_current:
    whether some effect's torque depends on the logged current.
    """

    request: str
    prepared: Prepared
    stack: Stack
    solution: Solution
    present: PresentModel
    instances: tuple[EffectInstance, ...]
    absorbed: bool
    follows_current: bool

    @property
    def name(self) -> str:
        """The effect's name."""
        return self.instances[0].effect.name

    @property
    def values(self) -> np.ndarray:
        """Parameters (ne,) of all effects of the model, as in the last columns of phi."""
        count = self.prepared.layout.effects
        return np.asarray(self.solution.theta[len(self.solution.theta) - count :])


@dataclass(frozen=True)
class RivalNoise:
    """Residual noise of the better of two models on the given currents.

    weights (n,): one over the RMS of every motor's error, 1 / drive unit, in rows of the fit; row_rate Hz: rows per
    second; autocorrelation_time s: of the errors.
    """

    weights: np.ndarray
    row_rate: float
    autocorrelation_time: float


def fit_rivals(problem: Problem, requests: tuple[str, str]) -> tuple[Rival, Rival]:
    """Fit the model with either effect to all recordings, those for validation too.

    requests: as EFFECT or EFFECT:PLACE, in addition to the problem's effects. Raises BenchError for names that are
    unknown, equal, or already in the model.
    """
    fitted = tuple(replace(recording, use="identify") for recording in problem.dataset.recordings)
    problem = replace(problem, dataset=replace(problem.dataset, recordings=fitted))
    effects = problem.effects
    if requests[0] == requests[1]:
        raise BenchError(f"effect {requests[0]!r} is given twice: name two effects to tell apart")
    first = _fitted(prepare(replace(problem, effects=(*effects, requests[0]))), requests[0])
    problem = replace(problem, filters=first.prepared.settings)
    second = _fitted(prepare(replace(problem, effects=(*effects, requests[1]))), requests[1])
    return first, second


def noise_of(rivals: tuple[Rival, Rival]) -> RivalNoise:
    """The noise of the currents, from the errors of the model that fits better."""
    errors = [residual_series(rival.stack, rival.solution) for rival in rivals]
    sizes = [
        np.sum((error * rival.solution.weights) ** 2) for error, rival in zip(errors, rivals, strict=True)
    ]
    error, better = errors[int(np.argmin(sizes))], rivals[int(np.argmin(sizes))]
    weights = np.max([rival.solution.weights for rival in rivals], axis=0)
    parts = np.split(error * weights, better.stack.starts[1:])
    row_rate = better.prepared.measured[0].recording.rate / better.prepared.settings.decimation
    return RivalNoise(weights, row_rate, autocorrelation_time(parts) / row_rate)


def _fitted(prepared: Prepared, request: str) -> Rival:
    prepared = converged(prepared)
    stack, solution = solved_quickly(prepared)
    effects = tuple(instance for instance in prepared.effects if instance.request == request)
    count = sum(len(instance.effect.parameters) for instance in effects)  # requests come last
    kept = identifiable_columns(stack, prepared.layout, prepared.gains)
    absorbed = not np.any(kept >= prepared.layout.size - count)
    present = present_model(prepared, solution)
    return Rival(
        request, prepared, stack, solution, present, effects, absorbed, _follows_current(prepared, present)
    )


def _follows_current(prepared: Prepared, present: PresentModel) -> bool:
    """Whether other currents in the first recording would change columns."""
    if not any(instance.effect.depends_on_model for instance in prepared.effects):
        return False
    measured = prepared.measured[0]
    columns = []
    for factor in (1.0, 2.0):
        seen = robot_signals(prepared.model, replace(measured, current=factor * measured.current), present)
        columns.append(
            np.concatenate([effect_columns(instance, seen) for instance in prepared.effects], axis=2)
        )
    return not np.array_equal(columns[0], columns[1])
