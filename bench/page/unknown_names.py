"""How a page names what is estimated."""

from bench.document.typeset import effect_name
from bench.identification.finding import Unknown


def name_of(unknown: Unknown) -> str:
    """A gain, a parameter, or a value of an effect at its place."""
    if unknown.kind == "gain":
        return f"gain of {unknown.place}"
    if unknown.kind == "parameter":
        return unknown.name
    return f"{unknown.name} of {effect_name(unknown.effect)} at {unknown.place}"
