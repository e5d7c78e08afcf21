"""The blind datasets of a trial, drawn from seeds: hidden effects, their sizes, noise."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal
from zlib import crc32

import numpy as np

from bench.basics.errors import BenchError
from bench.studies.sweep.plan import Run, digest
from bench.studies.trial.compatible import compatible
from bench.studies.trial.setup import Setup, where
from bench.studies.trial.unknown import FRICTIONS, KNOWN_EFFECTS, LAW, drawn_law
from bench.truth.hidden import HIDDEN_EFFECTS
from bench.truth.hidden.base import HiddenEffect

Kind = Literal["nothing", "one", "two", "three", "outside", "unknown"]
KINDS: dict[Kind, int] = {"nothing": 0, "one": 1, "two": 2, "three": 3, "outside": 1, "unknown": 1}
"""Kinds of datasets, with the number of hidden effects."""

DATASETS_A_SEED = 10
"""Datasets per seed, for kinds that do not hide each effect in turn."""

SHARES = HiddenEffect.shares
"""Range of an effect's torque over that of its motor, RMS over RMS; drawn uniformly on a logarithmic scale."""

SHARES_OF = {
    name: effect.shares for name, effect in sorted(HIDDEN_EFFECTS.items()) if effect.shares != SHARES
}
"""The same for effects with a different range."""

SETS_FROM = 0.6
"""Lower end of the sizes in sets within these ranges, on the logarithmic scale: in sets only large effects count."""

UNKNOWN_SHARES = (0.02, 0.1)
"""The same for laws that no model contains."""

NOISE = (0.002, 0.02)
"""Range of the current noise over the current's RMS; drawn likewise."""

RULES = (SHARES, SHARES_OF, SETS_FROM, NOISE)
"""Constants that draws depend on in addition to their seeds."""

ENCODER_BITS = (18, 20, 22)
GAIN_ERROR = 0.1
"""Largest relative deviation of a true gain from the nominal one."""


@dataclass(frozen=True)
class Hide:
    """An effect to hide, its joints (empty: the whole machine) and its share of the torque.

    numbers: parameters of a law that is drawn with them.
    """

    effect: str
    joints: tuple[str, ...]
    share: float
    numbers: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Case:
    """One blind dataset. seed: of the sensor noise and of the gains. drawn_from: the requested effects; empty: all."""

    kind: Kind
    index: int
    hides: tuple[Hide, ...]
    noise: float
    encoder_bits: int
    seed: int
    drawn_from: tuple[str, ...] = ()

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the drawn effects, without companions."""
        return tuple(hide.effect for hide in self.hides)


def datasets_a_seed(setup: Setup, kind: Kind, effects: Sequence[str] = ()) -> int:
    """Number of datasets of a kind for each seed."""
    if kind in ("one", "outside"):
        return len(chosen_effects(setup, kind, effects))
    return DATASETS_A_SEED


def chosen_effects(setup: Setup, kind: Kind, effects: Sequence[str] = ()) -> tuple[str, ...]:
    """The effects from which datasets of a kind are drawn: all of that kind, or those in `effects`.

    Raises BenchError for an effect that this robot cannot have.
    """
    for name in effects:
        if name not in setup.effects:
            raise BenchError(
                f"trial: no effect {name!r} in robot {setup.name!r}; it can have {', '.join(setup.effects)}"
            )
    known = setup.outside if kind == "outside" else setup.catalogued
    return tuple(name for name in known if not effects or name in effects)


def draw_case(setup: Setup, kind: Kind, index: int, effects: Sequence[str] = ()) -> Case:
    """The dataset of an index, independent of process and order.

    Kinds with one effect take all effects in turn. effects: draw from these; empty: from all.
    """
    known = chosen_effects(setup, kind, effects)
    if kind == "unknown":
        return _unknown_case(setup, index)
    if kind in ("one", "outside"):
        seed, at = divmod(index, len(known))
        random = _random(setup.name, kind, known[at], seed)
        names: tuple[str, ...] = (known[at],)
    else:
        random = _random(setup.name, kind, "", index)
        names = _drawn_set(known, KINDS[kind], random)
    hides = [_hide(setup, name, random, SETS_FROM if KINDS[kind] > 1 else 0.0) for name in names]
    return _case(kind, index, hides, random, effects)


def _unknown_case(setup: Setup, index: int) -> Case:
    """A law that no model contains, in one joint, with zero, one or two known effects."""
    random = _random(setup.name, "unknown", LAW, index)
    joint = str(random.choice(setup.motors))
    numbers = drawn_law(index, len(setup.motors), random)
    law = Hide(LAW, (joint,), _even_on_log_scale(UNKNOWN_SHARES, random), tuple(numbers.items()))
    others = _drawn_set(
        [name for name in FRICTIONS if name in setup.effects],
        KNOWN_EFFECTS[index % len(KNOWN_EFFECTS)],
        random,
    )
    hides = [law, *(_hide(setup, name, random, SETS_FROM) for name in others)]
    return _case("unknown", index, hides, random)


def _case(
    kind: Kind, index: int, hides: Sequence[Hide], random: np.random.Generator, effects: Sequence[str] = ()
) -> Case:
    """The case with its noise, encoders and seed."""
    noise, bits = _even_on_log_scale(NOISE, random), int(random.choice(ENCODER_BITS))
    return Case(kind, index, tuple(hides), noise, bits, int(random.integers(2**31)), tuple(effects))


def _random(robot: str, kind: str, effect: str, seed: int) -> np.random.Generator:
    return np.random.default_rng([crc32(part.encode()) for part in (robot, kind, effect)] + [seed])


def _drawn_set(known: Sequence[str], size: int, random: np.random.Generator) -> tuple[str, ...]:
    if not size:
        return ()
    for _ in range(1000):
        if len(known) < size:
            break
        names = tuple(str(name) for name in random.choice(known, size=size, replace=False))
        if compatible(names):
            return names
    raise BenchError(f"trial: no {size} of these effects can be in one machine: {', '.join(known)}")


def _hide(setup: Setup, effect: str, random: np.random.Generator, begin: float) -> Hide:
    joints: tuple[str, ...] = ()
    at = where(effect)
    if at != "machine":
        candidates = {"actuated": setup.motors, "passive": setup.passive, "link": tuple(setup.links)}[at]
        everywhere = at != "link" and random.random() < 0.5
        joints = candidates if everywhere else (str(random.choice(candidates)),)
    low, high = SHARES_OF.get(effect, SHARES)
    return Hide(effect, joints, _even_on_log_scale((low * (high / low) ** begin, high), random))


def _even_on_log_scale(between: tuple[float, float], random: np.random.Generator) -> float:
    return float(f"{np.exp(random.uniform(*np.log(between))):.4g}")


MOVED = ("robot", "design", "recordings", "payloads")


@dataclass(frozen=True)
class TrialPlan:
    """All cases of one kind; more seeds add cases without changing the others.

    effects: draw from these; empty: all that the robot can have. first: number of the first case; plans with
    sufficiently different first numbers have no case in common.
    """

    setup: Setup
    kind: Kind
    seeds: int
    effects: tuple[str, ...] = ()
    first: int = 0

    @property
    def numbers(self) -> range:
        """Numbers of its cases."""
        return range(self.first, self.first + self.size)

    @property
    def size(self) -> int:
        """Number of cases."""
        return self.seeds * datasets_a_seed(self.setup, self.kind, self.effects)

    def case(self, number: int) -> Case:
        """The case of that number, from 0."""
        return draw_case(self.setup, self.kind, number, self.effects)

    def run(self, number: int) -> Run:
        """The case as a run: all cases share the trajectories and the motion without hidden effects."""
        return Run(
            number=number,
            seed=number,
            axes={},
            base=self.setup.name,
            content=self.setup.content,
            identify={},
            design_content=self.setup.content,
            design=self._design,
            motion=self._motion,
            equations=digest([self._motion, self.kind, number]),
        )

    def tasks(self, is_done: Callable[[int], bool] = lambda _: False) -> Iterator[tuple[Run, ...]]:
        """All cases that are not done, in order."""
        return ((self.run(i),) for i in self.numbers if not is_done(i))

    @cached_property
    def _design(self) -> str:
        return digest({key: self.setup.content.get(key) for key in MOVED})

    @cached_property
    def _motion(self) -> str:
        return digest(self.setup.content)
