"""An effect's name in a sentence, and the motion that reveals it."""

import re
from collections.abc import Sequence

from bench.effects.catalogue import CATALOGUE
from bench.effects.effect import Effect
from bench.effects.select import TAG

_PEOPLE = re.compile(r"\b(coulomb|stribeck)\b")


def spoken(name: str) -> str:
    """Such as "Coulomb friction" of coulomb_friction, "constant offset at left for each recording" of
    constant_offset:left@recording.
    """
    effect, _, place = name.removesuffix(TAG).partition(":")
    said = named_after(effect.replace("_", " "))
    said += f" at {place}" if place else ""
    return f"{said} for each recording" if name.endswith(TAG) else said


def begun(name: str) -> str:
    """The same at the beginning of a sentence: "Passive Coulomb friction"."""
    said = spoken(name)
    return said[:1].upper() + said[1:]


def named_after(text: str) -> str:
    """A text with capitalised names of people."""
    return _PEOPLE.sub(lambda m: m.group().capitalize(), text)


def telling_motions(effects: Sequence[str]) -> list[str]:
    """Motions that distinguish these effects, without repetitions."""
    return list(dict.fromkeys(CATALOGUE.get(name, Effect).shown_by for name in effects))
