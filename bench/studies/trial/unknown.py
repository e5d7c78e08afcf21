"""Laws that no model contains, drawn from a grammar wider than that of discovery."""

from collections.abc import Callable, Mapping

import numpy as np

from bench.basics.errors import BenchError
from bench.truth.hidden.base import rms
from bench.truth.hidden.laws.product_law import unit_torque
from bench.truth.hidden.reference import Reference

LAW = "product_law"
KNOWN_EFFECTS = (0, 1, 2)
"""Numbers of known effects that accompany a law, in turn."""

Along = Callable[[Mapping[str, float], np.ndarray, np.ndarray], np.ndarray]

TORQUES: Mapping[str, Along] = {
    "coulomb_friction": lambda p, _q, v: p["Fc"] * np.sign(v),
    "viscous_friction": lambda p, _q, v: p["Fv"] * v,
    "constant_offset": lambda p, q, _v: np.full_like(q, p["c"]),
    "joint_spring": lambda p, q, _v: p["k"] * (q - p["q0"]),
    "quadratic_drag": lambda p, _q, v: p["c"] * v * np.abs(v),
}
"""Known effects that any machine may have in addition: torque (N,) from parameters, positions and velocities."""

FRICTIONS = tuple(TORQUES)

POWERS = ("v", "a", "tau", "others", "q")

STEEPEST = 0.5
"""Of a joint's inertia: largest slope of a law's torque over acceleration."""

Numbers = dict[str, float]
Draw = Callable[[np.random.Generator], Numbers]


def _odd_exponent(random: np.random.Generator) -> float:
    """An exponent far enough from those of named laws."""
    low, high = ((0.4, 0.7), (1.3, 1.7), (2.3, 2.8))[int(random.integers(3))]
    return float(random.uniform(low, high))


FAMILIES: Mapping[str, Draw] = {
    "drag with another exponent": lambda r: {"direction": 1.0, "v": _odd_exponent(r)},
    "friction by the acceleration": lambda r: {"direction": 1.0, "a": float(r.choice([0.5, 1.0, 1.0, 1.3]))},
    "drag by the acceleration": lambda r: {"direction": 1.0, "v": 1.0, "a": float(r.choice([0.5, 1.0]))},
    "friction by a power of the load": lambda r: {"direction": 1.0, "tau": float(r.uniform(1.3, 2.2))},
    "drag by the load": lambda r: {"direction": 1.0, "v": float(r.choice([1.0, 1.0, 1.5])), "tau": 1.0},
    "drag by the position": lambda r: {
        "direction": 1.0,
        "v": 1.0,
        "depth": float(r.uniform(0.6, 1.0)),
        "wave": float(r.choice([1.0, 2.0, 3.0])),
        "phase": float(r.uniform(0.0, 2.0 * np.pi)),
    },
    "friction by load and position": lambda r: {
        "direction": 1.0,
        "tau": 1.0,
        "depth": float(r.uniform(0.6, 1.0)),
        "wave": float(r.choice([1.0, 2.0])),
        "phase": float(r.uniform(0.0, 2.0 * np.pi)),
    },
    "friction by acceleration and load": lambda r: {
        "direction": 1.0,
        "a": 1.0,
        "tau": float(r.choice([0.5, 1.0])),
    },
    "drag by position and acceleration": lambda _: {"direction": 1.0, "v": 1.0, "a": 1.0, "q": 1.0},
    "a gain that falls with the speed": lambda r: {
        "odd_tau": 1.0,
        "tau": 1.0,
        "v": float(r.choice([1.0, 1.5])),
    },
    "a gain that drifts": lambda r: {"odd_tau": 1.0, "tau": 1.0, "T": float(r.uniform(2.0, 6.0))},
    "friction by the other motors": lambda _: {"direction": 1.0, "others": 1.0},
    "a link with second-order memory": lambda r: {
        "direction": 1.0,
        "v": float(r.choice([1.0, 2.0])),
        "omega": float(r.uniform(3.0, 12.0)),
        "zeta": float(r.uniform(0.4, 1.5)),
    },
    "drag that fades": lambda r: {"direction": 1.0, "v": 2.0, "T": float(r.uniform(2.0, 6.0))},
}
"""Kinds of laws; each draws its parameters."""


def drawn_law(index: int, motors: int, random: np.random.Generator) -> Numbers:
    """The parameters of the law of an index; the index goes through all families in turn."""
    known = [name for name in FAMILIES if motors > 1 or name != "friction by the other motors"]
    numbers = FAMILIES[known[index % len(known)]](random)
    return {name: float(f"{value:.4g}") for name, value in numbers.items()}


def sized(numbers: Mapping[str, float], reference: Reference, joint: str, share: float) -> Numbers:
    """The law's parameters with the coefficient for a share of its motor's torque, RMS over RMS.

    Raises BenchError if the torque would grow too fast with the acceleration.
    """
    unit = law_along(numbers, reference, joint)
    movement = reference.movement(joint)
    c = share * rms(movement.torque) / rms(unit)
    if numbers.get("a"):
        fast = np.abs(movement.acceleration) > 0.1 * rms(movement.acceleration)
        slope = numbers["a"] * np.abs(c * unit[fast] / movement.acceleration[fast]).max()
        if slope > STEEPEST * movement.inertia:
            raise BenchError(f"{LAW} of joint {joint}: a share of {share:g} would outweigh the inertia")
    return {"c": float(f"{c:.4g}"), **numbers}


def named_parts(numbers: Mapping[str, float]) -> frozenset[str]:
    """Effects of the catalogue that are a summand of a law, so that naming them is not wrong.

    A law that oscillates about a mean is the sum of that mean, which may be a known effect, and a wave.
    """
    powers = {name: value for name, value in numbers.items() if name in POWERS and value}
    if not numbers.get("depth") or not numbers.get("direction") or numbers.get("T") or numbers.get("omega"):
        return frozenset()
    named = {
        "viscous_friction": {"v": 1.0},
        "load_dependent_friction": {"tau": 1.0},
        "quadratic_drag": {"v": 2.0},
    }
    return frozenset(name for name, exponents in named.items() if exponents == powers)


def law_along(numbers: Mapping[str, float], reference: Reference, joint: str) -> np.ndarray:
    """A law's torque with c = 1 along a motion, all recordings concatenated."""
    m = reference.movement(joint)
    starts = np.flatnonzero(np.diff(m.time) < 0.0) + 1
    signals = (m.position, m.velocity, m.acceleration, m.torque, m.other_torques, m.time)
    parts = zip(*(np.split(signal, starts) for signal in signals), strict=True)
    return np.concatenate([unit_torque(numbers, *part) for part in parts])
