"""Effects of the starting model: they are identified again, replaced, or removed."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.candidates import Proposal
from bench.diagnosis.evidence import Samples, answer_weight
from bench.diagnosis.result import Superfluous
from bench.effects import EffectInstance
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import Prepared, with_effects
from bench.identification.result import Identification


def origins_of(start: Prepared) -> list[Prepared]:
    """Models to search from, in order: without the effects that can be identified again, then unchanged.

    A search from effects that do not exist fails, since others must compensate for them.
    """
    fixed = [instance for instance in start.effects if instance.recording]
    if len(fixed) == len(start.effects):
        return [start]
    return [converged(with_effects(start, fixed)), start]


def kept_and_new(
    effects: Sequence[EffectInstance], given: Sequence[EffectInstance]
) -> tuple[tuple[EffectInstance, ...], tuple[EffectInstance, ...]]:
    """The identified effects, split into those of the starting model and the rest."""
    there = _places(given)
    kept = tuple(instance for instance in effects if instance.seat in there)
    return kept, tuple(instance for instance in effects if instance not in kept)


def leaving(
    base_model: BaseModel,
    model: Prepared,
    after: Identification,
    given: Sequence[EffectInstance],
    samples: Samples,
) -> tuple[Prepared, Identification, tuple[Superfluous, ...]]:
    """The identified model, with the user's names, and the given effects that it omits.

    Each is tried once more in addition to the others: one that removes a clear share of the error returns.
    """
    each = {instance.name for instance in base_model.start.effects if instance.recording}
    added = _named(
        added_effects(base_model, model), [instance for instance in given if instance.name not in each]
    )
    model = replace(model, effects=(*model.effects[: len(base_model.start.effects)], *added))
    if model.effects and added:
        after = replace(after, effects=tuple(dict.fromkeys(instance.request for instance in model.effects)))
    gone: list[Superfluous] = []
    there = _places(base_model.start.effects)
    absent = [instance for instance in given if instance.seat not in there]
    for name in dict.fromkeys(instance.name for instance in absent):
        if any(instance.name == name for instance in added):
            continue
        wider = base_model.with_instances(
            [*added, *(instance for instance in absent if instance.name == name)]
        )
        result = fit(wider)
        if answer_weight(samples, wider, result) > answer_weight(samples, model, after):
            model, after = wider, result
            added = list(added_effects(base_model, model))
        elif name not in each:  # else it has a value for each recording somewhere
            wholes = [instance.name for instance in added if name in instance.effect.contains]
            gone.append(Superfluous(name, wholes[0] if wholes else None))
    return model, after, tuple(gone)


def given_wholly(given: Sequence[EffectInstance], proposals: Sequence[Proposal]) -> Collection[str]:
    """Effects that the starting model has at all possible places: they cannot be missing."""
    there = _places(given)
    return {
        proposal.name
        for proposal in proposals
        if proposal.instances and all((proposal.name, each.joint) in there for each in proposal.instances)
    }


def _named(effects: Sequence[EffectInstance], given: Sequence[EffectInstance]) -> list[EffectInstance]:
    requests = {instance.seat: instance.request for instance in given}
    return [replace(instance, request=requests.get(instance.seat, instance.request)) for instance in effects]


def _places(given: Sequence[EffectInstance]) -> set[tuple[str, str]]:
    return {instance.seat for instance in given}
