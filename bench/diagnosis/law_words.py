"""Discovered laws, in a mechanical engineer's words."""

import re
from collections.abc import Sequence

from bench.basics.sentence import in_percent
from bench.diagnosis.result import Discovered, LawTerm, LooksAt
from bench.effects.display_names import spoken

WHAT = {
    "position": "position",
    "velocity": "speed",
    "acceleration": "acceleration",
    "load": "load",
    "time": "time",
    "tool_speed": "speed of the tool",
    "others_load": "load of the other motors",
}


def law_sentences(discovered: Sequence[Discovered]) -> tuple[str, ...]:
    """A sentence or two for each law, with its values at every motor."""
    laws: dict[str, list[Discovered]] = {}
    for law in discovered:
        laws.setdefault(law.law, []).append(law)
    return tuple(_phrase(some) for some in laws.values())


def _phrase(some: Sequence[Discovered]) -> str:
    first = some[0]
    place = " and ".join(law.place for law in some) if len(some) < 3 else f"{len(some)} motors"
    if any(look.role == "table" for term in first.terms for look in term.looks_at):
        return _tabled(first)
    kinds = list(dict.fromkeys(_kind(term) for term in first.terms))
    values = "; ".join(_valued(law, with_place=len(some) > 1) for law in some)
    falls = ""
    if first.without is not None and first.validate is not None:
        falls = f"; the error falls from {in_percent(first.without)} to {in_percent(first.validate)}"
    near = ""
    if first.named is not None:
        near = f" That is {spoken(first.named)}."
    elif first.nearest is not None:
        effect, error = first.nearest
        near = (
            f" The closest effect of the catalogue, {spoken(effect)}, leaves an error of {in_percent(error)}."
        )
    return (
        f"At {place} there is {', and '.join(kinds)}, which is not in the catalogue: {values}{falls}.{near}"
    )


def _tabled(law: Discovered) -> str:
    """A function without a formula: its variables, and its influence on the error."""
    parts = list(dict.fromkeys(_function(term) or _kind(term) for term in law.terms))
    largest = max(law.terms, key=lambda term: abs(term.value))
    size = f"its largest value is ({_number(largest.value, largest.std)}) {symbols(largest.unit)}"
    falls = ""
    if law.without is not None and law.validate is not None:
        falls = f"; the error falls from {in_percent(law.without)} to {in_percent(law.validate)}"
    return (
        f"At {law.place} there is a residual that no formula fits. As measured, it is {', and '.join(parts)}: "
        f"{size}{falls}."
    )


def _function(term: LawTerm) -> str:
    """A table's function: "a smooth function of the position that opposes the motion"; "" without a table."""
    table = next((look for look in term.looks_at if look.role == "table"), None)
    if table is None:
        return ""
    of = f" of {table.motor}" if table.motor else ""
    function = f"a smooth function of the {WHAT[table.what]}{of}"
    roles = {look.role for look in term.looks_at if look.what == "velocity" and look.role != "table"}
    if "direction" in roles:
        return f"{function} that reverses with the direction of motion"
    return f"{function} times the speed" if roles else function


def _kind(term: LawTerm) -> str:
    """A term as "a torque that opposes the motion and grows with the size of the acceleration"."""
    velocities = [look for look in term.looks_at if look.what == "velocity" and not look.motor]
    against = [look for look in velocities if look.role in ("direction", "signed")]
    wave = any(look.role == "wave" for look in term.looks_at)
    does: list[str] = []
    if against:
        does.append("follows the direction of motion" if wave else _opposes(term))
    does += dict.fromkeys(
        _goes_by(look) for look in term.looks_at if look.role != "direction" or look.motor or not against
    )
    return f"a torque that {' and '.join(does)}" if does else "a constant torque"


def _opposes(term: LawTerm) -> str:
    return "opposes the motion" if term.value > 0.0 else "drives the motion"


def _goes_by(look: LooksAt) -> str:
    of = f" of {look.motor}" if look.motor else ""
    what = f"{WHAT[look.what]}{of}"
    sized = look.what not in ("velocity", "tool_speed", "time")
    return {
        "wave": f"oscillates with the {what}",
        "decay": "fades with time",
        "step": f"sets in at a certain {what}",
        "memory": f"follows the {what} with a delay",
        "direction": f"changes its sign with the {what}",
        "signed": f"grows with the {what}",
        "size": f"grows with the {'size of the ' if sized else ''}{what}",
    }[look.role]


def _valued(law: Discovered, *, with_place: bool) -> str:
    parts = " + ".join(
        f"({_coefficient(term, law)}) {symbols(term.unit)}"
        + ("" if term.term == "1" else f" · {symbols(term.term)}")
        for term in law.terms
    )
    return f"{parts} at {law.place}" if with_place else parts


def _coefficient(term: LawTerm, law: Discovered) -> str:
    """A value with its standard error, unless that is larger than all values of this unit."""
    largest = max(abs(other.value) for other in law.terms if other.unit == term.unit)
    return "not determined" if term.std > largest else _number(term.value, term.std)


def _number(value: float, std: float) -> str:
    """Such as "0.0150 ± 0.0002"."""
    if not 0.0 < std < float("inf"):
        return f"{value:.4g}"
    digits = max(0, -int(f"{std:.0e}".split("e")[1]))
    return f"{value:.{digits}f} ± {std:.{digits}f}" if digits < 7 else f"{value:.4g} ± {std:.1g}"


def symbols(text: str) -> str:
    """A formula or a unit as one writes it: v as q̇, abs(a) as |q̈|, N*m as N·m, s^2 as s²."""
    text = re.sub(r"\bv(?=_|\b)", "q̇", text)
    text = re.sub(r"\ba(?=_|\b)(?!bs)", "q̈", text)
    text = re.sub(r"abs\(([^()]*)\)", r"|\1|", text)
    text = re.sub(r"(?:\*\*|\^)2(?![\d.])", "²", text)
    text = re.sub(r"(?:\*\*|\^)3(?![\d.])", "³", text)
    return text.replace("**", "^").replace("*", "·")
