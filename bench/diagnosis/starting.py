"""Effects that the starting model has: they are found again, replaced by others, or leave."""

from collections.abc import Collection, Sequence
from dataclasses import replace

from bench.diagnosis.candidates import Proposal
from bench.diagnosis.result import Superfluous
from bench.diagnosis.rounds import Origin
from bench.diagnosis.search import MATERIAL
from bench.effects import EffectInstance
from bench.identification.identify import fit
from bench.identification.nonlinear import settled
from bench.identification.prepare import Prepared, with_effects
from bench.identification.result import Identification


def origins_of(start: Prepared) -> list[Prepared]:
    """Models to search beside, the first that serves: without the effects that can be found again, and as it is.

    A search beside effects that are not there goes wrong, since others must undo what they do.
    """
    fixed = [one for one in start.effects if one.recording]
    if len(fixed) == len(start.effects):
        return [start]
    return [settled(with_effects(start, fixed)), start]


def worse(after: Identification, before: Identification) -> bool:
    """Whether a model that was found explains clearly less than the starting model, on recordings not fitted."""
    return _judged(before) < (1.0 - MATERIAL) * _judged(after)


def kept_and_new(
    found: Sequence[EffectInstance], given: Sequence[EffectInstance]
) -> tuple[tuple[EffectInstance, ...], tuple[EffectInstance, ...]]:
    """Of what was found, that which the starting model has, and the rest."""
    there = _places(given)
    kept = tuple(one for one in found if (one.effect.name, one.joint) in there)
    return kept, tuple(one for one in found if one not in kept)


def leaving(
    origin: Origin, model: Prepared, after: Identification, given: Sequence[EffectInstance]
) -> tuple[Prepared, Identification, tuple[Superfluous, ...]]:
    """The found model, named as the user did, and those of the given effects that it does without.

    Each is tried once more beside what was found: one that takes a clear share of the error away comes back.
    """
    own = len(origin.start.effects)
    added = _named(model.effects[own:], given)
    model = replace(model, effects=(*model.effects[:own], *added))
    if model.effects and added:
        after = replace(after, effects=tuple(dict.fromkeys(one.request for one in model.effects)))
    gone: list[Superfluous] = []
    there = {(one.effect.name, one.place) for one in origin.start.effects}
    left = [one for one in given if (one.effect.name, one.place) not in there]
    for name in dict.fromkeys(one.effect.name for one in left):
        if any(one.effect.name == name for one in added):
            continue
        wider = origin.with_instances([*added, *(one for one in left if one.effect.name == name)])
        result = fit(wider)
        if _judged(result) < (1.0 - MATERIAL) * _judged(after):
            model, after = wider, result
            added = list(model.effects[own:])
        else:
            wholes = [one.effect.name for one in added if name in one.effect.contains]
            gone.append(Superfluous(name, wholes[0] if wholes else None))
    return model, after, tuple(gone)


def given_wholly(given: Sequence[EffectInstance], proposals: Sequence[Proposal]) -> Collection[str]:
    """Effects that the starting model has wherever they can show: there is nothing to be said of them as missing."""
    there = _places(given)
    return {
        one.name
        for one in proposals
        if one.instances and all((one.name, each.joint) in there for each in one.instances)
    }


def _named(found: Sequence[EffectInstance], given: Sequence[EffectInstance]) -> list[EffectInstance]:
    requests = {(one.effect.name, one.joint): one.request for one in given}
    return [replace(one, request=requests.get((one.effect.name, one.joint), one.request)) for one in found]


def _places(given: Sequence[EffectInstance]) -> set[tuple[str, str]]:
    return {(one.effect.name, one.joint) for one in given}


def _judged(result: Identification) -> float:
    return result.error.validate or 0.0
