"""The model that a diagnosis identified, prepared again: the one about which the workbench's columns are taken."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from bench.diagnosis.result import Diagnosis
from bench.diagnosis.split import with_held_out_parts
from bench.effects import EffectInstance, places_in, select_effects
from bench.effects.select import TAG
from bench.identification.effect_columns import PresentModel
from bench.identification.nonlinear import present_model
from bench.identification.perturbations import Nearby
from bench.identification.prepare import Prepared, prepare, with_effects
from bench.identification.problem import Problem
from bench.identification.result import Identification
from bench.identification.solution import Solution
from bench.identification.solve_only import solved_quickly
from bench.identification.summary import ROBOT


@dataclass(frozen=True)
class DiagnosedModel:
    """plain: the equations without any effect but those with a value for each recording, which the page does not
    change; complete: with those that the diagnosis identified behind them, linearised about the answer; solution: the
    answer, theta in the order of `complete`. started: effects that the model had before the diagnosis, as (effect,
    place).
    """

    plain: Prepared
    complete: Prepared
    solution: Solution
    started: tuple[tuple[str, str], ...]

    @property
    def fit_gains(self) -> bool:
        """Whether drive gains are unknowns."""
        return self.plain.fit_gains

    @property
    def effects(self) -> tuple[EffectInstance, ...]:
        """The identified effects, those aside that the page does not change."""
        return self.complete.effects[len(self.plain.effects) :]

    def nearby(self) -> Nearby:
        """Where small changes of the torque are computed once for all effects."""
        return Nearby(self.complete.model, self.complete.measured)


def diagnosed_model(problem: Problem, diagnosis: Diagnosis) -> DiagnosedModel:
    """Prepare the equations of a diagnosis of a problem again: its filters, and its parts to judge on where the user
    kept no recording for that.
    """
    dataset, _ = with_held_out_parts(problem.dataset)
    problem = replace(problem, dataset=dataset, filters=diagnosis.before.settings)
    before, after, catalogue = diagnosis.before, diagnosis.after, problem.catalogue
    plain = prepare(replace(problem, effects=()))
    places = places_in(plain.model.geometry, problem.dataset.weighed)
    each = [effect for effect in after.effects if effect.endswith(TAG)]
    given = select_effects(each, places, catalogue, plain.logs)
    instances = select_effects(_requests(after, given), places, catalogue)
    given, instances = (
        tuple(_with_values(after, instance) for instance in some) for some in (given, instances)
    )
    present = _present(plain, after)
    plain = with_effects(plain, given, present)
    complete = with_effects(plain, (*given, *instances), present)
    _, solution = solved_quickly(complete)
    # the solution is about itself once more, as identify does it
    complete = with_effects(plain, (*given, *instances), present_model(complete, solution))
    _, solution = solved_quickly(complete)
    kept = [effect for effect in before.effects if not effect.endswith(TAG)]
    started = tuple(
        (instance.effect.name, instance.joint) for instance in select_effects(kept, places, catalogue)
    )
    return DiagnosedModel(plain, complete, solution, started)


def _requests(result: Identification, given: Sequence[EffectInstance]) -> list[str]:
    """The effects with one value for all recordings; given: the others."""
    each = {(instance.effect.name, instance.place) for instance in given}
    return [
        name if place == ROBOT else f"{name}:{place}"
        for name, values in result.effect_parameters.items()
        for place in values
        if (name, place) not in each
    ]


def _with_values(result: Identification, instance: EffectInstance) -> EffectInstance:
    values = result.effect_parameters[instance.effect.name][instance.place]
    shapes = {shape.name: values[shape.name].value for shape in instance.effect.shape}
    effect = replace(instance.effect, **shapes) if shapes else instance.effect
    linear = {parameter.name: values[parameter.name].value for parameter in effect.parameters}
    return replace(instance, effect=effect.about(linear))


def _present(plain: Prepared, result: Identification) -> PresentModel:
    """The identified model as effects see it."""
    gains = np.array([result.drive_gains[joint].value for joint in result.joints])
    extra = plain.dataset.robot.redundant[: plain.layout.redundant]
    changes = [result.drive_gains[actuator.joint].value - actuator.gain for actuator in extra]
    theta = np.array([*(parameter.value for parameter in result.parameters), *changes])
    return present_model(plain, Solution(theta, gains, np.ones(len(gains)), "current", result.gains_fitted))
