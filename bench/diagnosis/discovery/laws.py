"""Identified terms as laws: one effect for all motors with the same terms."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.discovery.refine import Refined
from bench.diagnosis.discovery.seen import places_of
from bench.diagnosis.discovery.source import labelled, law_effect
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Place
from bench.effects import EffectInstance
from bench.effects.select import at_joint
from bench.identification.decision import RULE
from bench.identification.identify import fit


@dataclass(frozen=True)
class Law:
    """Terms that form one effect at some motors; instances: with the constants there; source: its file."""

    name: str
    terms: tuple[Term, ...]
    places: tuple[Place, ...]
    instances: tuple[EffectInstance, ...]
    source: str

    def at(self, numbers: Mapping[str, float]) -> list[Term]:
        """The law's terms with these constants, by label."""
        return [
            term.with_numbers([numbers[label] for label in labels])
            for term, labels in zip(self.terms, labelled(self.terms)[1], strict=True)
        ]


def laws_of(base_model: BaseModel, refined: Refined, taken: Collection[str]) -> list[Law]:
    """Laws of a converged model's terms, each at the motors where it acts; taken: names already in use."""
    result, terms, places = fit(refined.model), refined.terms, places_of(base_model.start)
    shown: dict[int, list[Term]] = {}
    for place in places:
        for instance in added_effects(base_model, refined.model):
            if instance.name not in terms or instance.joint != place.name:
                continue
            values = result.effect_parameters[instance.name][instance.place]
            linear = [values[parameter.name] for parameter in instance.effect.parameters]
            if any(abs(value.value) > RULE.shows * value.std for value in linear):
                term = terms[instance.name].with_numbers(list(instance.effect.shape_values().values()))
                shown.setdefault(place.index, []).append(term)
    groups: dict[object, list[int]] = {}
    for index, some in shown.items():
        alike = tuple((law_term.structure, law_term.unit(places[index])) for law_term in some)
        groups.setdefault(alike, []).append(index)
    used = set(taken)
    laws = []
    for at in groups.values():
        name = _name([places[i] for i in at], len(places), used)
        used.add(name)
        laws.append(_law(name, shown, [places[i] for i in at]))
    return laws


def _name(at: Sequence[Place], motors: int, taken: Collection[str]) -> str:
    """Such as law_left; law of all motors."""
    everywhere = len(at) == motors and motors > 1
    plain = re.sub(
        r"\W", "_", "law" if everywhere else "_".join(["law", *(place.name for place in at)])
    ).lower()
    return next(name for i in count(1) if (name := plain if i == 1 else f"{plain}_{i}") not in taken)


def _law(name: str, shown: Mapping[int, Sequence[Term]], at: Sequence[Place]) -> Law:
    terms = tuple(shown[at[0].index])
    effect, source = law_effect(name, terms, at[0])
    instances = []
    for place in at:
        numbers, names = labelled(shown[place.index])
        values = {label: numbers[label].value for labels in names for label in labels}
        instances.append(at_joint(replace(effect, **values), place.name))
    return Law(name, terms, tuple(at), tuple(instances), source)
