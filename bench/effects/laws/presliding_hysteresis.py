"""Friction that is a spring before it slides."""

from dataclasses import dataclass

import numpy as np

from bench.effects.effect import ActuatorEffect, EffectParameter, ShapeParameter
from bench.effects.signals import JointSignals


@dataclass(frozen=True)
class PreslidingHysteresis(ActuatorEffect):
    """Dahl's friction, which follows a reversal with a delay.

    Valid without a Stribeck effect; an x0 far below the travel between two samples cannot be seen. Source: Dahl, "A
    solid friction model", Aerospace Corporation TOR-0158(3107-18)-1, 1968.
    """

    name = "presliding_hysteresis"
    law = "τ = Fc z with dz/dt = (q̇ − |q̇| z) / x0: Dahl's friction, which follows a reversal with a delay."
    symbols = (
        "Fc: Coulomb friction, positive, N·m or N; z: state between −1 and 1, zero at the start; x0: "
        "presliding displacement, rad or m, estimated from the data; Fc / x0 is the stiffness before it slides. "
        "x0 = 0 is Coulomb friction."
    )
    shown_by = "reverse slowly, in small strokes"
    seen = ("opposes",)
    in_key = ("rises over a short way after the reversal, as a spring does",)
    parameters = (EffectParameter("Fc", "{effort}", positive=True),)
    by_motor = True
    shape = (ShapeParameter("x0", "{angle}", (0.001, 0.003, 0.01, 0.03, 0.1, 0.3), scale="speed"),)
    every_sample = True
    contains = ("coulomb_friction",)

    x0: float = 0.01

    def torque(self, joint: JointSignals) -> np.ndarray:
        return dahl_state(joint.position, self.x0)[:, None]


def dahl_state(position: np.ndarray, displacement: float) -> np.ndarray:
    """Dahl's state z (N,) along positions (N,), from rest; exact for motion in one direction between samples.

    Between two reversals z approaches the direction of motion s with the path x since the first one: z = s + (z0 - s)
    exp(-x / displacement).
    """
    step = np.diff(position)
    moving = np.flatnonzero(step)
    if not len(moving):
        return np.zeros(len(position))
    direction = np.sign(step[moving])
    # steps with which a direction starts
    first = moving[np.append(0, np.flatnonzero(np.diff(direction)) + 1)]
    way = np.append(0.0, np.cumsum(np.abs(step))) / displacement
    stretch = np.searchsorted(first, np.arange(len(step)), side="right") - 1
    state, starts = 0.0, np.empty(len(first))
    for i, (begin, end) in enumerate(zip(first, np.append(first[1:], len(step)), strict=True)):
        starts[i] = state
        s = np.sign(step[begin])
        state = s + (state - s) * np.exp(way[begin] - way[end])
    z = np.zeros(len(position))
    s = np.sign(step[first])[stretch]
    z[1:] = s + (starts[stretch] - s) * np.exp(np.minimum(way[first][stretch] - way[1:], 0.0))
    z[: first[0] + 1] = 0.0
    return z
