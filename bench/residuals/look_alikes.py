"""Effects that leave errors like those at a motor: candidates for a diagnosis to decide between."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from bench.effects import Effect
from bench.effects.effect import Seen
from bench.identification.problem import Problem, places_of
from bench.residuals.opposing_motion import Change
from bench.residuals.periods import SpectralLine
from bench.residuals.profile import Dependence
from bench.residuals.regions import Concentration, RegionKind

QUESTION: Mapping[Seen, int] = {
    "opposes": 1,
    "fades": 1,
    "load": 1,
    "velocity": 2,
    "repeats": 3,
    "position": 4,
    "current": 5,
    "acceleration": 6,
}
"""The question of the atlas's key that asks for it."""
LOOKS: Mapping[str, Seen] = {
    "direction": "opposes",
    "velocity": "velocity",
    "position": "position",
    "constant": "position",
    "current": "current",
    "acceleration": "acceleration",
    "time": "fades",
}
"""The meaning of the variable of a dependence."""
PERIODS: Mapping[str, Seen] = {"position": "repeats", "time": "acceleration"}
CHANGES: Mapping[str, Seen] = {"warm-up": "fades", "load": "load"}


@dataclass(frozen=True)
class LookAlike:
    """Effects that the model lacks and that leave such an error, the simplest law first."""

    seen: Seen
    effects: tuple[str, ...]

    @property
    def question(self) -> int:
        """The question of the atlas's key that leads to them."""
        return QUESTION[self.seen]


def possible_effects(problem: Problem) -> dict[str, Effect]:
    """The known effects that have a place in the robot."""
    places = places_of(problem)
    return {name: effect for name, effect in problem.catalogue.items() if places.where(effect)}


def look_alikes(
    joint: str,
    patterns: tuple[Iterable[Concentration], Iterable[Dependence], Iterable[SpectralLine], Iterable[Change]],
    possible: Mapping[str, Effect],
    has: Iterable[str],
) -> tuple[LookAlike, ...]:
    """Effects by the findings at a motor, those with most of the error first.

    possible: effects that have a place in the robot. has: those of the model, as EFFECT or EFFECT:PLACE. An effect is
    named for its first matching look.
    """
    placed = [name.partition("@")[0].partition(":") for name in has]
    there = {name for name, _, place in placed if place in ("", joint)}
    absent = [effect for name, effect in possible.items() if name not in there]
    named: set[str] = set()
    answer = []
    for seen in _looks(*patterns):
        ranks = sorted(
            (effect.seen.index(seen), *_plainness(effect, possible))
            for effect in absent
            if seen in effect.seen and effect.name not in named
        )
        effects = tuple(name for *_, name in ranks)
        named.update(effects)
        if effects:
            answer.append(LookAlike(seen, effects))
    return tuple(answer)


def _plainness(effect: Effect, possible: Mapping[str, Effect]) -> tuple[bool, int, int, str]:
    """Sorts laws: at the motor itself, with few parameters, special cases of others, by name."""
    within = sum(effect.name in other.contains for other in possible.values())
    return effect.place != "actuator", len(effect.parameters) + len(effect.shape), -within, effect.name


def _looks(
    concentrations: Iterable[Concentration],
    dependences: Iterable[Dependence],
    lines: Iterable[SpectralLine],
    changes: Iterable[Change],
) -> list[Seen]:
    """The findings in the order of the atlas: changes first, as most informative; then by the share of the error."""
    shares: list[tuple[float, Seen]] = [
        (dependence.error_share, LOOKS[dependence.variable]) for dependence in dependences
    ]
    shares += [(line.error_share, PERIODS[line.over]) for line in lines]
    shares += [
        (concentration.error_share, "opposes")
        for concentration in concentrations
        if concentration.where.part is RegionKind.REVERSALS
    ]
    ordered = [seen for _, seen in sorted(shares, key=lambda pair: -pair[0])]
    return list(dict.fromkeys([*(CHANGES[change.between] for change in changes), *ordered]))
