"""Where an identified effect stays: at motors where it is significant and of a possible sign."""

from collections.abc import Sequence

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.evidence import Samples, answer_weight
from bench.diagnosis.pruning import cancelling_effect, impossible_but_needed, impossible_effects
from bench.diagnosis.reason import Reason
from bench.diagnosis.significance import is_significant, wrong_signs
from bench.effects import EffectInstance
from bench.identification.identify import fit
from bench.identification.prepare import Prepared
from bench.identification.result import Identification


def where_possible(
    base_model: BaseModel, model: Prepared, given: Sequence[EffectInstance], samples: Samples
) -> tuple[Prepared, Identification, dict[str, Reason]]:
    """The identified effects at these places, converged and fitted; and the impossible ones, with reasons."""
    whole = fit(model)
    kept, after = _where_it_shows(base_model, model, whole, given, samples)
    stayed = {instance.key for instance in kept.effects}
    dropped = [instance for instance in model.effects if instance.key not in stayed]
    added = added_effects(base_model, kept)
    out = impossible_effects(after, added)
    if answer_weight(samples, kept, after) < answer_weight(samples, model, whole):
        out |= impossible_but_needed(whole, dropped)
    return kept, after, out or cancelling_effect(after, added)


def _where_it_shows(
    base_model: BaseModel,
    model: Prepared,
    result: Identification,
    given: Sequence[EffectInstance],
    samples: Samples,
) -> tuple[Prepared, Identification]:
    """The identified effects without joints at which they are insignificant or have an impossible sign; given: those of
    the starting model there, which stay. result: of the model with all of them; if converged only with nearby columns,
    they are tested again with exact ones. If held-out recordings are explained clearly worse without effects that are
    not significant by themselves, only an impossible sign removes them.
    """
    added = added_effects(base_model, model)
    there = {instance.seat for instance in given}
    kept = [instance for instance in added if instance.seat in there or is_significant(result, instance)]
    for instance in added:
        if not any(other.name == instance.name for other in kept):
            kept.append(instance)
    if len(kept) < len(added):
        there_only = base_model.warm_started(model, [instance for instance in added if instance in kept])
    else:
        there_only = base_model.exactly(model)
    if there_only is model:
        return model, result
    fitted, nearly = fit(there_only), model.nearby is not None
    able = [instance for instance in added if instance.seat in there or not wrong_signs(result, instance)]
    poorer = answer_weight(samples, there_only, fitted) < answer_weight(samples, model, result)
    if poorer and len(able) > len(kept):
        there_only = base_model.warm_started(model, able)
        fitted = fit(there_only)
    return _where_it_shows(base_model, there_only, fitted, given, samples) if nearly else (there_only, fitted)
