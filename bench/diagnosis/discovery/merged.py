"""One power of the velocity in place of several functions of it that approximate it together."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, product

from bench.diagnosis.base_model import BaseModel, added_effects
from bench.diagnosis.discovery.factors import Power
from bench.diagnosis.discovery.grammar import V
from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.discovery.refine import Judge, Refined, instances_of
from bench.diagnosis.discovery.screen import Screened, at_place
from bench.diagnosis.discovery.seen import places_of
from bench.diagnosis.discovery.source import law_effect
from bench.diagnosis.discovery.term import Term
from bench.diagnosis.discovery.variables import Place
from bench.diagnosis.search_result import SearchResult
from bench.effects import Effect, EffectInstance
from bench.effects.select import at_joint
from bench.identification.decision import RULE
from bench.identification.prepare import Prepared, with_effects
from bench.identification.tolerances import TOLERANCES

NAME = "power"


@dataclass(frozen=True)
class Part:
    """An effect of the catalogue, or one term of a law, at a place."""

    instance: EffectInstance
    term: Term | None = None

    @property
    def name(self) -> str:
        """The name of its effect."""
        return self.instance.name

    @property
    def of_velocity(self) -> bool:
        """Whether it is friction by its motor's velocity only."""
        if self.term is None:
            return self.instance.effect.of_velocity
        return all(isinstance(factor, Power) and factor.variable == V for factor in self.term.factors)

    @property
    def unknowns(self) -> int:
        """Number of its unknowns; includes a law's exponents, chosen or adapted."""
        effect = self.instance.effect
        factors = () if self.term is None else self.term.factors
        chosen = [each for each in factors if isinstance(each, Power) and each.exponent and not each.free]
        return len(effect.parameters) + len(effect.shape) + len(chosen)


def parts_of(instances: Iterable[EffectInstance], laws: Sequence[Law]) -> list[Part]:
    """Effects, and every law as its terms with their constants at each place."""
    by_name = {law.name: law for law in laws}
    parts = []
    for instance in instances:
        law = by_name.get(instance.name)
        parts += [Part(instance)] if law is None else _terms(law, instance)
    return parts


def unknowns(parts: Iterable[Part]) -> int:
    """Number of unknowns of all together."""
    return sum(part.unknowns for part in parts)


def _terms(law: Law, instance: EffectInstance) -> list[Part]:
    (place,) = (place for place in law.places if place.name == instance.joint)
    terms = law.at(instance.effect.shape_values())
    parts = []
    for i, term in enumerate(terms):
        (alone,) = instances_of(f"{law.name}_term_{i + 1}", Screened(term, {}, 0.0), [place])
        parts.append(Part(alone, term))
    return parts


def merged(
    finding: SearchResult, laws: Sequence[Law], catalogue: Mapping[str, Effect], judge: Judge, *, much: bool
) -> Iterator[Refined]:
    """Models with a power of the velocity in place of some functions of the velocity at some motors, or of these and of
    another effect, which have fewer unknowns and as small an error, or as many and a clearly smaller one.

    laws: among the identified effects. catalogue: with their special cases. much: whether more than noise remains, so
    that a model with as many unknowns can be clearly better.
    """
    base_model = finding.base_model
    parts = parts_of(added_effects(base_model, finding.model), laws)
    least = finding.weight_by(judge.samples)
    for alike in with_another(together(parts), parts):
        others = [part for part in parts if part not in alike]
        at = {part.instance.joint for part in alike}
        places = [place for place in places_of(base_model.start) if place.name in at]
        law_unknowns = TOLERANCES.laws.power_unknowns * len(places)

        def size(kept: Sequence[Part], others: Sequence[Part] = others) -> tuple[int, int]:
            return len({part.name for part in (*others, *kept)}), unknowns(kept)

        sets = sorted(fewer(alike, law_unknowns - much, catalogue), key=size)
        for _, alternatives in groupby(sets, key=size):
            tried = [
                _with_power(base_model, finding.model, [*others, *kept], places, judge)
                for kept in alternatives
                if _promises(base_model, finding.model, [*others, *kept], places, judge, least)
            ]
            best = max(tried, key=lambda each: each.weight, default=None)
            if best is not None and best.weight > least:
                yield best
                break


def together(parts: Sequence[Part]) -> list[list[Part]]:
    """Groups of functions of the velocity that one could replace: several per motor, at all motors with the same ones
    and at each of these alone; the most unknowns first.
    """
    sits: dict[str, list[Part]] = {}
    for part in parts:
        if part.of_velocity:
            sits.setdefault(part.instance.joint, []).append(part)
    groups: dict[tuple[str, ...], list[list[Part]]] = {}
    for some in sits.values():
        if len(some) > 1:
            groups.setdefault(tuple(sorted(part.name for part in some)), []).append(some)
    joined = [[part for some in group for part in some] for group in groups.values()]
    alone = [some for group in groups.values() if len(group) > 1 for some in group]
    return sorted([*joined, *alone], key=lambda some: -unknowns(some))


def with_another(groups: Iterable[Sequence[Part]], parts: Sequence[Part]) -> Iterator[list[Part]]:
    """Every group, and the group with another dissipative effect at its motors, which may only compensate for the shape
    of the sum.
    """
    for group in groups:
        yield list(group)
        at, among = {part.instance.joint for part in group}, {part.name for part in group}
        others = [
            part
            for part in parts
            if part.term is None
            and part.instance.joint in at
            and part.instance.effect.by_motor
            and part.name not in among
        ]
        for name in sorted({part.name for part in others}):
            yield [*group, *(part for part in others if part.name == name)]


def _promises(
    base_model: BaseModel,
    full_model: Prepared,
    stay: Sequence[Part],
    places: Sequence[Place],
    judge: Judge,
    least: float,
) -> bool:
    """Whether a power may be better than `least`: judged by a sum of powers, which explains about as much as one with
    the best exponent, at its number of unknowns.
    """
    terms = [Screened(Term((Power(V, each),)), {}, 0.0) for each in TOLERANCES.laws.summed_exponents]
    powers = [
        at_joint(law_effect(NAME, [at_place(term, place) for term in terms], place)[0], place.name)
        for place in places
    ]
    added = *(part.instance for part in stay), *powers
    known = {part.name: part.term for part in stay if part.term is not None}
    together = judge.refined(
        with_effects(full_model, (*base_model.start.effects, *added)), {**known, NAME: terms[0].term}
    )
    spared = len(places) * (len(terms) - TOLERANCES.laws.power_unknowns)
    weight = together.weight + float(judge.samples.cost_of_unknowns(spared))
    return weight > least - TOLERANCES.laws.nearby * RULE.prior


def _with_power(
    base_model: BaseModel, full_model: Prepared, stay: Sequence[Part], places: Sequence[Place], judge: Judge
) -> Refined:
    """The parts `stay` of the identified model and a power of the velocity at some places, converged from the best of
    the initial exponents.
    """
    terms = {part.name: part.term for part in stay if part.term is not None}
    begun = []
    for exponent in TOLERANCES.laws.merged_exponents:
        term = Term((Power(V, exponent, free=True),))
        added = *(part.instance for part in stay), *instances_of(NAME, Screened(term, {}, 0.0), places)
        model = with_effects(full_model, (*base_model.start.effects, *added))
        begun.append((judge.refined(model, {**terms, NAME: term}), term, added))
    _, term, added = max(begun, key=lambda each: each[0].weight)
    return judge.refined(base_model.warm_started(full_model, added), {**terms, NAME: term})


def fewer(alike: Sequence[Part], law_unknowns: int, catalogue: Mapping[str, Effect]) -> list[list[Part]]:
    """Sets of parts that may stay with a law of `law_unknowns` unknowns, so that unknowns are saved: identified
    effects, unchanged or as a special case that was not selected.
    """
    effects = [part for part in alike if part.term is None]
    present = {part.name for part in effects}
    ways = []
    for name in sorted(present):
        whole = [part for part in effects if part.name == name]
        specials = sorted({*whole[0].instance.effect.contains} - present)
        ways.append(
            [[], whole, *([_as_special_case(part, catalogue[each]) for part in whole] for each in specials)]
        )
    sets = ([part for some in chosen for part in some] for chosen in product(*ways))
    return [kept for kept in sets if unknowns(kept) + law_unknowns < unknowns(alike)]


def _as_special_case(part: Part, special: Effect) -> Part:
    joint = part.instance.joint
    return Part(replace(part.instance, effect=special, request=f"{special.name}:{joint}"))
