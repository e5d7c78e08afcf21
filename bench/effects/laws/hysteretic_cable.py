"""A cable or hose with a hysteresis of its bending torque."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter, ShapeParameter
from bench.effects.signals import JointSignals

FINEST = 1e-10  # distance from 1 at the end of a table
STEPS = 2000  # its entries on either side of zero


@dataclass(frozen=True)
class HystereticCable(ActuatorEffect):
    """The hysteretic part of Bouc and Wen's model; a `joint_spring` next to it is the elastic one.

    Valid for loops that do not depend on the speed. Source: Wen, "Method for random vibration of hysteretic systems",
    Journal of the Engineering Mechanics Division 102 (1976), equation 3 with A = β = 1 and γ = 0.
    """

    name = "hysteretic_cable"
    law = (
        "τ = F z with dz/dt = (q̇ − |q̇| |z|^(n−1) z) / x0: Bouc and Wen's hysteresis, of a cable or hose that bends "
        "back on another way than it was bent."
    )
    symbols = (
        "F: largest torque or force, positive, N·m or N; z: state between −1 and 1, zero at the start; x0: way after "
        "which it yields, rad or m, and n: how sharply, both estimated from the data. n = 1 is presliding hysteresis, "
        "and x0 = 0 Coulomb friction."
    )
    shown_by = "reverse slowly, in strokes of all sizes"
    seen = ("opposes",)
    in_key = ("rises over a long way after it and bends, a round loop over the position",)
    parameters = (EffectParameter("F", "{effort}", positive=True),)
    shape = (
        ShapeParameter("x0", "{angle}", (0.003, 0.01, 0.03, 0.1, 0.3, 1.0), scale="speed"),
        ShapeParameter("n", "1", (1.0, 2.0, 6.0)),
    )
    every_sample = True
    contains = ("coulomb_friction", "presliding_hysteresis")

    x0: float = 0.1
    n: float = 2.0

    def torque(self, joint: JointSignals) -> np.ndarray:
        return bouc_wen_state(joint.position, self.x0, self.n)[:, None]


def bouc_wen_state(position: np.ndarray, displacement: float, sharpness: float) -> np.ndarray:
    """State z (N,) along positions (N,), from rest; exact for motion in one direction between samples.

    Between two reversals y = z s, with s the direction of motion, follows dy/dx = 1 - sign(y) |y|^n along the path x in
    units of `displacement`: always the same curve, entered where the last stretch ended.
    """
    states, ways = _curve(sharpness)
    z = np.zeros(len(position))
    state = 0.0
    for begin, end, direction in stretches(position):
        entered = float(np.interp(state * direction, states, ways))
        way = np.abs(position[begin + 1 : end + 1] - position[begin]) / displacement
        z[begin + 1 : end + 1] = direction * np.interp(entered + way, ways, states)
        state = z[end]
    return z


def stretches(position: np.ndarray) -> list[tuple[int, int, float]]:
    """First and last sample, and the direction, of every stretch of motion in one direction."""
    step = np.diff(position)
    moving = np.flatnonzero(step)
    if not len(moving):
        return []
    direction = np.sign(step[moving])
    first = moving[np.append(0, np.flatnonzero(np.diff(direction)) + 1)]
    ends = np.append(first[1:], len(step))
    return [
        (int(begin), int(end), float(np.sign(step[begin]))) for begin, end in zip(first, ends, strict=True)
    ]


@lru_cache(maxsize=256)
def _curve(sharpness: float) -> tuple[np.ndarray, np.ndarray]:
    """y from -1 to 1 and the path x(y) along the curve, zero at y = 0: the integral of dy / (1 - sign(y) |y|^n)."""
    descending = np.geomspace(1.0, FINEST, STEPS)
    above = 1.0 - descending
    from_above = -np.expm1(sharpness * np.log1p(-descending[1:]))  # 1 - y^n
    up = _integrated(np.append(1.0, descending[1:] / from_above), -np.log(descending))
    below = np.linspace(0.0, 1.0, STEPS)
    down = _integrated(1.0 / (1.0 + below**sharpness), below)
    return np.concatenate((-below[:0:-1], above)), np.concatenate((-down[:0:-1], up))


def _integrated(values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """Integral from the first point to each, by trapezoids."""
    return np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(at)))
