"""The identified laws, motor by motor and term by term."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from bench.diagnosis.discovery.factors import Power
from bench.diagnosis.discovery.grammar import V
from bench.diagnosis.discovery.laws import Law
from bench.diagnosis.discovery.refine import instances_of
from bench.diagnosis.discovery.screen import Screened
from bench.diagnosis.discovery.term import Term
from bench.effects import EffectInstance


@dataclass(frozen=True)
class Part:
    """An effect of the catalogue at a place, or one term of a law there, by itself."""

    instance: EffectInstance
    term: Term | None = None

    @property
    def name(self) -> str:
        """The name of its effect."""
        return self.instance.effect.name

    @property
    def of_velocity(self) -> bool:
        """Whether it is friction by its motor's velocity alone."""
        if self.term is None:
            return self.instance.effect.of_velocity
        return all(isinstance(factor, Power) and factor.variable == V for factor in self.term.factors)

    @property
    def unknowns(self) -> int:
        """Count of its numbers; the exponents of a law are among them, whether they were chosen or adapted."""
        effect = self.instance.effect
        factors = () if self.term is None else self.term.factors
        chosen = [each for each in factors if isinstance(each, Power) and each.exponent and not each.free]
        return len(effect.parameters) + len(effect.shape) + len(chosen)


def parts_of(instances: Iterable[EffectInstance], laws: Sequence[Law]) -> list[Part]:
    """Effects as they are, and every law as its terms with the numbers that it has there."""
    by_name = {law.name: law for law in laws}
    parts = []
    for instance in instances:
        law = by_name.get(instance.effect.name)
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
