"""An effect's name in a sentence."""

import re

_PEOPLE = re.compile(r"\b(coulomb|stribeck)\b")


def spoken(name: str) -> str:
    """Such as "Coulomb friction" of coulomb_friction, "viscous friction" of viscous_friction."""
    return named_after(name.replace("_", " "))


def begun(name: str) -> str:
    """The same at the beginning of a sentence: "Passive Coulomb friction"."""
    said = spoken(name)
    return said[:1].upper() + said[1:]


def named_after(text: str) -> str:
    """A text with the names of people as names."""
    return _PEOPLE.sub(lambda m: m.group().capitalize(), text)
