"""The start of a search, and models near it, converged with exact columns or with those of `Nearby`."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from bench.basics.deadline import NEVER, Deadline
from bench.diagnosis.candidates import Context, Proposal, context_of, shaped
from bench.diagnosis.error_floor import ErrorFloor, error_floor
from bench.diagnosis.noise import leaves_only_noise, noise_squares
from bench.diagnosis.system import System
from bench.effects import EffectInstance, changes_torque
from bench.identification.compressed import Stack
from bench.identification.decision import RULE
from bench.identification.effect_columns import PresentModel
from bench.identification.nonlinear import converged, converged_from, present_model, settles
from bench.identification.perturbations import Nearby
from bench.identification.prepare import Prepared, seen_nearby, with_effects
from bench.identification.solution import Solution, scaled_lstsq, torque_residual_rms, torque_system, weighted
from bench.identification.solve_only import solved_quickly


@dataclass(frozen=True)
class BaseModel:
    """The start of a search: the model at its solution, and what all models near it share.

    known: added effects that were converged before, by their initial form, and the model about which they are
    linearised. deadline: after it, converging a model raises TimeUpError.
    """

    start: Prepared
    nearby: Nearby
    known: dict[Hashable, tuple[tuple[EffectInstance, ...], PresentModel]] = field(
        default_factory=dict, compare=False, repr=False
    )
    deadline: Deadline = NEVER

    @cached_property
    def at_leisure(self) -> "BaseModel":
        """The same without a deadline, to complete what was begun."""
        return self if self.deadline is NEVER else replace(self, deadline=NEVER)

    @cached_property
    def noise(self) -> np.ndarray | None:
        """See `noise_squares`."""
        return noise_squares(self.start)

    @cached_property
    def floor(self) -> ErrorFloor:
        """What no set of effects explains."""
        return error_floor(self.start)

    def context(self, model: Prepared) -> Context:
        """A model's residual, from which effects get their shape."""
        return context_of(model, self.nearby.signals(model.present, model.signals))

    def with_proposals(self, proposals: Sequence[Proposal], chosen: Sequence[int]) -> Prepared:
        """The starting model with some of the proposals, converged."""
        return self.with_instances(_instances(proposals, chosen))

    def nearly(self, proposals: Sequence[Proposal], chosen: Sequence[int]) -> Prepared:
        """The same with nearby columns, for a first look."""
        instances = _instances(proposals, chosen)
        earlier = self._converged_before(instances)
        return at_its_solution(self._settled_nearby(instances)) if earlier is None else earlier

    def in_search(self, system: System, proposals: Sequence[Proposal], chosen: Sequence[int]) -> Prepared:
        """The same for a search: with nearby columns if they save work and the model leaves only noise, so that it
        cannot improve. system: in which the set was selected.
        """
        instances = _instances(proposals, chosen)
        if not _less_nearby(instances):
            return self.with_instances(instances)
        near = self._settled_nearby(instances)
        if leaves_only_noise(system, near, self.noise):
            return at_its_solution(near)
        return self._seen_by(self.start, near)

    def exactly(self, model: Prepared) -> Prepared:
        """A model converged with nearby columns, now with exact ones."""
        return model if model.nearby is None else self._seen_by(self.start, model)

    def with_instances(self, instances: Sequence[EffectInstance]) -> Prepared:
        """The starting model with these effects, converged; first with nearby columns, if that saves work."""
        if _less_nearby(instances):
            return self.exactly(self._settled_nearby(instances))
        prepared = self._converged_before(instances)
        if prepared is None:
            prepared = self._converged(self.start, (*self.start.effects, *instances))
            if prepared.converged and _hashable(prepared.effects):
                self.known[tuple(instances)] = prepared.effects, prepared.present
        return at_its_solution(prepared)

    def _converged_before(self, instances: Sequence[EffectInstance]) -> Prepared | None:
        """The starting model with these effects, if already converged from the same initial form."""
        entry = self.known.get(tuple(instances)) if _hashable(instances) else None
        return None if entry is None else replace(with_effects(self.start, *entry), converged=True)

    def warm_started(self, model: Prepared, instances: Sequence[EffectInstance]) -> Prepared:
        """The starting model with these effects, converged from a similar converged model with their initial or
        identified shapes.
        """
        if (earlier := self._converged_before(instances)) is not None:
            return at_its_solution(earlier)
        start = seen_nearby(self.start, self.nearby) if _less_nearby(instances) else self.start
        every = *self.start.effects, *instances
        return self.exactly(self._settled(start, every, model.present, nearly=True))

    def again_nearby(self, model: Prepared) -> Prepared:
        """A model converged with exact columns, now with nearby ones if that saves work."""
        if not _less_nearby(added_effects(self, model)):
            return model
        return self._seen_by(seen_nearby(self.start, self.nearby), model)

    def joined_nearby(
        self, model: Prepared, others: Sequence[EffectInstance], added: Sequence[EffectInstance]
    ) -> Prepared:
        """A model with some of its effects and one more, shaped with these, converged with nearby columns."""
        rest = with_effects(model, (*self.start.effects, *others))
        joining = shaped(self.context(rest), added)
        return self._settled(model, (*rest.effects, *joining), nearly=True)

    def _settled_nearby(self, instances: Sequence[EffectInstance]) -> Prepared:
        return self._converged(seen_nearby(self.start, self.nearby), (*self.start.effects, *instances))

    def _settled(
        self,
        model: Prepared,
        effects: Sequence[EffectInstance],
        present: PresentModel | None = None,
        *,
        nearly: bool,
    ) -> Prepared:
        return at_its_solution(self._converged(model, effects, present, nearly=nearly))

    def _seen_by(self, other: Prepared, model: Prepared) -> Prepared:
        """A converged model, converged with the signals of `other`, nearby or exact."""
        if not settles(model.effects):
            return self._settled(other, model.effects, model.present, nearly=False)
        return converged_from(other, model, added_from=len(self.start.effects), deadline=self.deadline)

    def _converged(
        self,
        model: Prepared,
        effects: Sequence[EffectInstance],
        present: PresentModel | None = None,
        *,
        nearly: bool = False,
    ) -> Prepared:
        """A model with other effects, see `converged`; those of the starting model stay."""
        begun = with_effects(model, effects, present, fitted_only=settles(effects))
        self.deadline.check()
        return converged(begun, nearly=nearly, added_from=len(self.start.effects), deadline=self.deadline)


def _instances(proposals: Sequence[Proposal], chosen: Sequence[int]) -> list[EffectInstance]:
    return [instance for i in sorted(chosen) for instance in proposals[i].instances]


def _hashable(instances: Sequence[EffectInstance]) -> bool:
    """Whether effects can be keys: a user's class need not be hashable."""
    return all(type(instance.effect).__hash__ is not None for instance in instances)


def _less_nearby(instances: Sequence[EffectInstance]) -> bool:
    """Whether nearby columns make effects much less work."""
    return any(changes_torque(instance.effect) for instance in instances)


def added_effects(base_model: BaseModel, model: Prepared) -> tuple[EffectInstance, ...]:
    """The effects that a model has beyond those of the starting model."""
    return model.effects[len(base_model.start.effects) :]


def added_names(base_model: BaseModel, model: Prepared) -> set[str]:
    """Their names."""
    return {instance.name for instance in added_effects(base_model, model)}


def base_model_of(start: Prepared, deadline: Deadline = NEVER) -> BaseModel:
    """The start of a search from a converged model."""
    start = at_its_solution(start)
    return BaseModel(start, Nearby(start.model, start.measured), deadline=deadline)


def at_its_solution(model: Prepared) -> Prepared:
    """A converged model with effects linearised about itself, or about nominal gains if it has run away."""
    if settles(model.effects):
        return model
    stack, solution = solved_quickly(model)
    present = present_model(model, restarted(stack, solution, model.dataset.robot.nominal_gains))
    return replace(with_effects(model, model.effects, present), converged=model.converged)


def restarted(stack: Stack, solution: Solution, nominal: np.ndarray) -> Solution:
    """The solution, with negative or distant gains replaced by nominal ones, and theta (p,) solved again.

    Gains that are all off by about the same factor, in a model that explains at least `RULE.most` of the squared
    currents, have not run away: nominal gains or currents are in another unit. A model that lacks strong friction may
    fit best with unbounded gains, or gains near or below zero; steps of the current error never return from there.
    nominal (n,): nominal drive gains. Zero or absorbed columns get minimum-norm values.
    """
    ratio = solution.gains / nominal
    away = (ratio < 1.0 / RULE.gain_lost) | (ratio > RULE.gain_lost)
    together = bool(np.all(ratio > 0.0)) and ratio.max() < RULE.gain_lost * ratio.min()
    if not (np.any(solution.gains_fitted) and away.any()):
        return solution
    if away.all() and together and _explained(stack, solution) >= RULE.most:
        return solution
    gains = np.where(away, nominal, solution.gains)
    rows, right = torque_system(weighted(stack.factors, solution.weights / gains), gains)
    return replace(solution, theta=scaled_lstsq(rows, right), gains=gains)


def _explained(stack: Stack, solution: Solution) -> float:
    """Share of the squared currents that a solution explains, the mean of all motors that move."""
    measured = np.mean(stack.current**2, axis=0)
    error = torque_residual_rms(stack, solution.theta, solution.gains) / solution.gains
    moving = measured > 0.0
    return float(1.0 - np.mean(error[moving] ** 2 / measured[moving])) if moving.any() else 0.0
