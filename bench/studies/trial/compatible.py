"""Effects that make sense together in one machine, and effects that need others."""

from collections.abc import Callable, Iterable, Mapping
from functools import cache
from itertools import combinations

import numpy as np

from bench.effects import CATALOGUE

RIVALS: tuple[frozenset[str], ...] = (
    frozenset({"position_dependent_friction", "coulomb_friction"}),
    frozenset({"passive_coulomb_friction", "passive_load_friction", "passive_viscous_friction"}),
    frozenset({"current_delay", "current_loop_lag"}),
    frozenset({"backlash", "drive_flexibility", "rotor_inertia"}),
    frozenset({"constant_offset", "passive_spring"}),
    frozenset({"encoder_offset", "geometric_error"}),
)
"""A machine has at most one effect of each group, since they describe the same part."""

ALONE = frozenset({"payload_mass_error", "rotor_inertia"})
"""Not hidden together with others: base parameters absorb them, so they could not be identified."""

COMPANION_SIZE = 1.5
"""Size of the companion over the largest value of the effect that needs it."""

Sizes = Mapping[str, float]
COMPANIONS: Mapping[str, Mapping[str, Callable[[Sizes], Sizes]]] = {
    "position_dependent_friction": {
        "coulomb_friction": lambda sizes: {
            "Fc": float(f"{COMPANION_SIZE * np.hypot(sizes['a'], sizes['b']):.4g}")
        }
    }
}
"""Effects that need others, such as friction that varies with position, whose total must not become negative. For
each companion, its sizes from those of the effect.
"""

PARTS: dict[str, tuple[str, ...]] = {"backlash": ("drive_flexibility",)}
"""Effects that are part of others and may be named in addition: flanks in contact are also flexible."""


def compatible(effects: Iterable[str]) -> bool:
    """Whether a machine can reasonably have all of these."""
    names = tuple(effects)
    if len(names) > 1 and ALONE.intersection(names):
        return False
    return not any(exclusive(a, b) for a, b in combinations(names, 2))


def exclusive(name: str, other: str) -> bool:
    """Whether a machine has at most one of these two: rivals, or effects of which one contains the other."""
    return other in _kin(name)


@cache
def _kin(effect: str) -> frozenset[str]:
    """An effect and all effects connected to it by rivalry or containment."""
    groups = [*RIVALS, *(frozenset({name, *law.contains}) for name, law in CATALOGUE.items() if law.contains)]
    kin = frozenset({effect})
    while wider := frozenset().union(*(group for group in groups if kin & group)) - kin:
        kin |= wider
    return kin


def expected(effects: Iterable[str]) -> tuple[str, ...]:
    """The effects and the companions that are hidden with them."""
    names = list(dict.fromkeys(effects))
    for name in tuple(names):
        names += [word for word in COMPANIONS.get(name, ()) if word not in names]
    return tuple(names)


def optional(effects: Iterable[str]) -> frozenset[str]:
    """Effects that may be named in addition to these, but need not be."""
    return frozenset(part for name in effects for part in PARTS.get(name, ()))
