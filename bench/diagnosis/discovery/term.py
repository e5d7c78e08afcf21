"""A term of a law: a product of factors, with a coefficient for each of its parts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce

import numpy as np

from bench.diagnosis.discovery.factors import Factor, Memory, Number, Power, Wave, unit_of
from bench.diagnosis.discovery.variables import Place, Seen, Variable
from bench.identification.tolerances import TOLERANCES


@dataclass(frozen=True)
class Term:
    """A product of factors, at most one of several parts; without factors, a constant."""

    factors: tuple[Factor, ...]

    @property
    def parts(self) -> int:
        """Number of coefficients: two if a wave's phase is free."""
        return max((factor.parts for factor in self.factors), default=1)

    @cached_property
    def variables(self) -> tuple[Variable, ...]:
        """Its variables, each once, in order."""
        return tuple(sorted({each for factor in self.factors for each in factor.variables}))

    @property
    def numbers(self) -> tuple[Number, ...]:
        """Adaptable constants of its factors in order."""
        return tuple(number for factor in self.factors if (number := factor.number) is not None)

    @cached_property
    def structure(self) -> tuple[object, ...]:
        """The same for terms that differ only in values of their constants."""
        return tuple(sorted((_structure(factor) for factor in self.factors), key=repr))

    @cached_property
    def strangeness(self) -> int:
        """Distance from the usual: one factor that changes its sign with the direction, and few factors.

        Friction opposes the motion, whatever its size depends on; an inertia or a gain has one variable.
        """
        odd = sum(factor.odd for factor in self.factors if isinstance(factor, Power))
        return 10 * abs(odd - 1) + len(self.factors)

    def with_numbers(self, values: Sequence[float]) -> "Term":
        """The term with other constants, ordered as `numbers`."""
        remaining = list(values)
        return Term(
            tuple(
                factor if factor.number is None else factor.with_number(remaining.pop(0))
                for factor in self.factors
            )
        )

    def values(self, seen: Seen) -> np.ndarray:
        """Values (M, parts) of its parts at coefficients of one."""
        return reduce(np.multiply, (factor.values(seen) for factor in self.factors), np.ones((1, 1)))

    def formulas(self, place: Place) -> tuple[str, ...]:
        """Formulas of its parts, such as "sign(v)*abs(a)"; numbers in SI units."""
        written = [factor.formula(place) for factor in self.factors]
        return tuple(_product([each[min(k, len(each) - 1)] for each in written]) for k in range(self.parts))

    def codes(self, place: Place, names: Sequence[str]) -> tuple[str, ...]:
        """The parts of the term as Python code; names: the names of its numbers."""
        remaining = list(names)
        written = [
            factor.code(place, "" if factor.number is None else remaining.pop(0)) for factor in self.factors
        ]
        return tuple(_product([each[min(k, len(each) - 1)] for each in written]) for k in range(self.parts))

    def part(self, k: int) -> "Term":
        """The term of the k-th coefficient: a wave's mean does not have the wave's variable."""
        mean = [
            factor for factor in self.factors if isinstance(factor, Wave) and factor.about_mean and k == 0
        ]
        return Term(tuple(factor for factor in self.factors if factor not in mean)) if mean else self

    def unit(self, place: Place) -> str:
        """The units of its coefficients."""
        return unit_of(self.factors, place)


def _product(factors: Sequence[str]) -> str:
    return "*".join(factor for factor in factors if factor != "1") or "1"


def _structure(factor: Factor) -> tuple[object, ...]:
    if isinstance(factor, Power):
        return "power", factor.variable, factor.odd, "free" if factor.free else factor.exponent
    if isinstance(factor, Memory):
        return "memory", *(_structure(power) for power in factor.powers)
    return type(factor).__name__, *factor.variables


def at_other_harmonics(term: Term) -> tuple[Term, ...]:
    """The term with a fixed wave over a turn at a third, half and double its number of periods, if whole.

    Over a narrow range these are similar, and which is chosen first depends on other terms.
    """
    return tuple(
        Term((*term.factors[:i], replace(factor, rate=ratio * factor.rate), *term.factors[i + 1 :]))
        for i, factor in enumerate(term.factors)
        if isinstance(factor, Wave) and not factor.free
        for ratio in (1.0 / 3.0, 0.5, 2.0)
        if abs(ratio * factor.rate - round(ratio * factor.rate)) < TOLERANCES.rank.ratio
    )


def about_its_mean(term: Term) -> tuple[Term, Term] | None:
    """A term with a wave as one with the wave's mean added, and that mean alone; None without a wave."""
    for i, factor in enumerate(term.factors):
        if isinstance(factor, Wave):
            before, after = term.factors[:i], term.factors[i + 1 :]
            return Term((*before, replace(factor, about_mean=True), *after)), Term((*before, *after))
    return None


def freed(term: Term) -> tuple[Term, ...]:
    """For each fixed exponent or frequency, the term with this one free."""
    variants = []
    for i, factor in enumerate(term.factors):
        if isinstance(factor, Power) and not factor.free and factor.exponent:
            changed: Factor = replace(factor, free=True)
        elif isinstance(factor, Wave) and not factor.free:
            changed = replace(factor, free=True)
        else:
            continue
        variants.append(Term((*term.factors[:i], changed, *term.factors[i + 1 :])))
    return tuple(variants)
