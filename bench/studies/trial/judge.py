"""A diagnosis held against what was hidden."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

from bench.studies.trial.compatible import COMPANIONS, optional


@dataclass(frozen=True)
class Named:
    """What a diagnosis says of one effect: its verdict, and what it may be instead."""

    effect: str
    verdict: str
    alternatives: tuple[str, ...]

    def may_be(self, effect: str) -> bool:
        """Whether it names the effect, or is openly undecided between it and others."""
        return effect == self.effect or (self.verdict == "indistinguishable" and effect in self.alternatives)


@dataclass(frozen=True)
class Judgement:
    """Right or wrong.

    first, first_undecided: the first effect that is named is hidden; or may be. exact, exact_undecided: the whole
    set, likewise. wrong: named although not hidden, with the verdict `missing`.
    """

    first: bool
    first_undecided: bool
    exact: bool
    exact_undecided: bool
    wrong: tuple[str, ...]


def judgement_of(
    drawn: Collection[str],
    expected: Collection[str],
    missing: Sequence[Named],
    parts: Collection[str] = frozenset(),
) -> Judgement:
    """Hold a diagnosis (`missing`, strongest first) against the truth.

    drawn: effects that are hidden; expected: with their companions, which count in sets, but not as the first.
    parts: of what is hidden without a name. Effects that are part of a hidden one neither help nor harm.
    """
    companions = {name for effect in drawn for name in COMPANIONS.get(effect, ())} - set(drawn)
    aside = (optional(drawn) | set(parts)) - set(expected)
    missing = [named for named in missing if named.effect not in aside]
    leading = next((named for named in missing if named.effect not in companions), None)
    return Judgement(
        first=leading is not None and leading.effect in drawn,
        first_undecided=leading is not None and any(leading.may_be(effect) for effect in drawn),
        exact={named.effect for named in missing} == set(expected),
        exact_undecided=_matches(missing, tuple(expected)),
        wrong=tuple(
            named.effect for named in missing if named.effect not in expected and named.verdict == "missing"
        ),
    )


def _matches(missing: Sequence[Named], expected: Sequence[str]) -> bool:
    """Whether the named effects can be the hidden ones, each for one of them."""
    if len(missing) != len(expected):
        return False
    return any(
        all(named.may_be(effect) for named, effect in zip(missing, order, strict=True))
        for order in permutations(expected)
    )


def named_from(verdicts: Sequence[Mapping[str, object]]) -> list[Named]:
    """Named effects from their plain form: effect, verdict, alternatives."""
    return [
        Named(
            str(verdict["effect"]), str(verdict["verdict"]), tuple(map(str, _texts(verdict["alternatives"])))
        )
        for verdict in verdicts
    ]


def _texts(value: object) -> Sequence[object]:
    return value if isinstance(value, list | tuple) else ()
