"""A round of a search: effects in the best shape for its selected model, their system, and the best set."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from bench.basics.progress import Progress
from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.batched_sets import solve_set, solve_sets, swapped
from bench.diagnosis.candidates import Context, Proposal, shaped
from bench.diagnosis.evidence import ResidualSumOfSquares, effects_prior, residual_squares
from bench.diagnosis.noise import leaves_only_noise
from bench.diagnosis.search import Selection, contains
from bench.diagnosis.system import System
from bench.effects import EffectInstance
from bench.identification.decision import RULE
from bench.identification.nonlinear import settles
from bench.identification.prepare import Prepared, with_effects
from bench.identification.solve_only import candidate_columns, reshaped


@dataclass(frozen=True)
class Round:
    """A converged model, every effect in its best shape for it, their system about it, and the best set there.

    cut: whether the deadline cut the search; the model is then that of the best set so far.
    """

    model: Prepared
    proposals: Sequence[Proposal]
    system: System
    selection: Selection
    cut: bool = False

    @cached_property
    def residual(self) -> ResidualSumOfSquares:
        """The residual sums of squares of its model."""
        return residual_squares(self.model, self.prior_of(self.model.effects))

    def prior_of(self, effects: Sequence[EffectInstance]) -> float:
        """Nats that effects must bring, including those of its proposals beyond an effect of the catalogue."""
        names = {instance.name for instance in effects}
        return effects_prior(effects) + sum(each.prior for each in self.proposals if each.name in names)

    @property
    def chosen(self) -> tuple[int, ...]:
        """The best set's proposals (indices)."""
        return self.selection.selected.fit.chosen

    @property
    def names(self) -> set[str]:
        """The best set's effects."""
        return {self.proposals[i].name for i in self.chosen}


def reshaped_proposals(base_model: BaseModel, this_round: Round, progress: Progress) -> list[Proposal]:
    """Proposals in the best shape for the selected set: in addition to it, or in place of the effect that they rival.

    An effect that could replace an identified one gets its shape without that one, unless it explains most of a motor's
    residual in addition; the others get the shape that explains most of this residual, if it exceeds noise. A special
    case of an identified effect that explains little of it gets its shape in the place of that one.
    """
    model = this_round.model
    added = added_effects(base_model, model)
    candidates = this_round.system.candidates
    contexts: dict[int | None, Context] = {None: base_model.context(model)}
    result = []
    only_noise = leaves_only_noise(this_round.system, model, base_model.noise)
    asked = [
        i
        for i, candidate in enumerate(this_round.proposals)
        if i not in this_round.chosen and _has_shape(candidate)
    ]
    solve_sets(this_round.system, swapped(this_round.chosen, asked))  # together, and kept for use below
    for i, proposal in enumerate(this_round.proposals):
        progress.advance()
        base_model.deadline.check()
        if i in this_round.chosen:
            instances = tuple(instance for instance in added if instance.name == proposal.name)
            result.append(replace(proposal, instances=instances))
            continue
        if not _has_shape(proposal):
            result.append(proposal)
            continue
        rival = next((k for k in this_round.chosen if contains(candidates[i], candidates[k])), None)
        if rival is None:
            in_addition, shows = proposal.instances, False
            if not only_noise:
                in_addition = shaped(contexts[None], in_addition, base_model.deadline)
                shows = _explains_a_motor(contexts[None], in_addition)
            rival = None if shows else _rival(this_round.system, this_round.selection, i)
            if rival is None:
                rival = next((k for k in this_round.chosen if contains(candidates[k], candidates[i])), None)
                if rival is None or (not only_noise and _explains(contexts[None], in_addition)):
                    result.append(replace(proposal, instances=in_addition))
                    continue
        name = this_round.proposals[rival].name
        if rival not in contexts:
            others = [instance for instance in added if instance.name != name]
            contexts[rival] = base_model.context(with_effects(model, (*base_model.start.effects, *others)))
        instances = shaped(contexts[rival], proposal.instances, base_model.deadline)
        if contains(candidates[rival], candidates[i]):
            present = [instance for instance in added if instance.name == name]
            instances = explaining_most(contexts[rival], instances, with_shapes_of(present, instances))
        result.append(replace(proposal, instances=instances))
    return result


def _has_shape(proposal: Proposal) -> bool:
    """Whether the columns of an effect depend on the model to which it is added."""
    return not proposal.absorbed and settles(proposal.instances)


def _rival(system: System, selection: Selection, i: int) -> int | None:
    """The identified effect that effect i replaces best, if i then explains most of what that one explains."""
    best = selection.selected.fit
    if not best.chosen:
        return None
    sets = zip(best.chosen, swapped(best.chosen, [i]), strict=True)
    swaps = {k: solve_set(system, pair).fitted for k, pair in sets}
    rival = min(swaps, key=lambda k: swaps[k])
    without = solve_set(system, tuple(c for c in best.chosen if c != rival)).fitted
    return rival if swaps[rival] < 0.5 * (without + best.fitted) else None


def with_shapes_of(
    wholes: Sequence[EffectInstance], parts: Sequence[EffectInstance]
) -> tuple[EffectInstance, ...]:
    """The special cases of an effect, with its parameter values of the same name at their joints."""
    values = {whole.joint: whole.effect.shape_values() for whole in wholes}
    result = []
    for part in parts:
        there = values.get(part.joint, {})
        result.append(
            reshaped(part, {name: there[name] for name in part.effect.shape_values() if name in there})
        )
    return tuple(result)


def explaining_most(context: Context, *tried: tuple[EffectInstance, ...]) -> tuple[EffectInstance, ...]:
    """The instances that together explain most of a model's residual."""
    return max(tried, key=lambda instances: _explained(context, instances))


def _explains(context: Context, instances: Sequence[EffectInstance]) -> bool:
    """Whether instances remove a clear share of a model's residual on the fitted recordings."""
    return (
        _explained(context, instances)
        > (1.0 - (1.0 - RULE.material) ** 2) * context.regression.sum_of_squares
    )


def _explains_a_motor(context: Context, instances: Sequence[EffectInstance]) -> bool:
    """Whether one of the instances removes most of a motor's squared residual; all motors' are weighted to be equal."""
    most = RULE.most * context.regression.sum_of_squares / len(context.regression.weights)
    return any(_explained(context, [instance]) > most for instance in instances)


def _explained(context: Context, instances: Sequence[EffectInstance]) -> float:
    return float(context.regression.explained(candidate_columns(context.prepared, instances))[1])


def in_their_shape(base_model: BaseModel, proposals: Sequence[Proposal], model: Prepared) -> list[Proposal]:
    """The proposals in the shape they have in a converged model."""
    added = added_effects(base_model, model)
    changed = []
    for proposal in proposals:
        instances = tuple(each for each in added if each.name == proposal.name)
        changed.append(replace(proposal, instances=instances) if instances else proposal)
    return changed


def usable(proposals: Sequence[Proposal], barred: Collection[str]) -> list[int]:
    """Proposals (indices) that may be selected."""
    return [
        i for i, proposal in enumerate(proposals) if not proposal.absorbed and proposal.name not in barred
    ]
