"""Effects that can be ticked: those identified as they are, all others in the shape that suits next to them."""

from collections.abc import Mapping
from dataclasses import replace

from bench.basics.progress import SILENT
from bench.diagnosis.base_model import BaseModel
from bench.diagnosis.candidates import Proposal, propose
from bench.diagnosis.normal_equations import solve_set
from bench.diagnosis.rounds import Round, reshaped, system_about
from bench.diagnosis.search import Selection, score
from bench.effects import Effect, EffectInstance
from bench.identification.perturbations import Nearby
from bench.identification.prepare import with_effects
from bench.page.workbench.diagnosed_model import DiagnosedModel


def instances_of(
    model: DiagnosedModel, effects: Mapping[str, Effect], nearby: Nearby
) -> tuple[EffectInstance, ...]:
    """These effects wherever the recordings show them, in the shape in which a diagnosis about `model` judges them.

    In the order of `effects`; an effect that the model takes up everywhere has no instance. nearby: of `model`.
    """
    base_model = BaseModel(model.plain, nearby)
    proposals = propose(base_model.context(with_effects(model.complete, model.plain.effects)), effects)
    if model.effects:
        proposals = _about_the_model(base_model, model, proposals)
    instances = [instance for each in proposals if not each.absorbed for instance in each.instances]
    names = list(effects)
    return tuple(sorted(instances, key=lambda instance: names.index(instance.effect.name)))


def _about_the_model(
    base_model: BaseModel, model: DiagnosedModel, proposals: list[Proposal]
) -> list[Proposal]:
    """Proposals as the last round of a search leaves them, which identified the effects of `model`."""
    present = {(instance.effect.name, instance.joint) for instance in model.effects}
    some = []
    for proposal in proposals:
        kept = tuple(each for each in proposal.instances if (proposal.name, each.joint) not in present)
        if kept:
            some.append(replace(proposal, instances=kept))
    names = dict.fromkeys(instance.effect.name for instance in model.effects)
    groups = [tuple(instance for instance in model.effects if instance.effect.name == name) for name in names]
    every = [*(Proposal(each[0].effect.name, each, False, "") for each in groups), *some]
    system = system_about(base_model, model.complete, every)
    best = score(system, solve_set(system, range(len(groups))))
    return reshaped(base_model, Round(model.complete, every, system, Selection(best, {})), SILENT)
