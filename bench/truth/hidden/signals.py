"""What the law of a hidden effect may depend on."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

Law = Callable[[], Array]
"""What an effect makes of its signals at the present step; it may keep a state from step to step."""

Parameters = Mapping[str, Array]
"""Parameters of an effect in m joints, by name, (m,) each."""


@dataclass(eq=False)
class Clock:
    """The time of the present step, s; 0 where the log begins."""

    time: float = 0.0


@dataclass(frozen=True, eq=False)
class Signals:
    """State of m motors in R recordings at the present step, (R, m) each.

    A motor moves as its joint does unless there is a spring or play between; its encoder tells its position.
    The arrays are views that change from step to step.
    """

    step: float
    """s."""
    recordings: tuple[str, ...]
    """(R,) names."""
    joints: tuple[str, ...]
    """(m,) names."""
    clock: Clock
    position: Array
    """rad or m."""
    velocity: Array
    acceleration: Array
    """One step ago: that of the present step is not known before its forces are."""
    current: Array
    """What flows, in the drive's unit."""
    torque: Array
    """Of the motor."""
    all_torques: Array
    """(R, n) of all motors."""

    def columns(self, columns: slice) -> Signals:
        """The same for some of the joints."""
        views = {
            name: getattr(self, name)[:, columns]
            for name in ("position", "velocity", "acceleration", "current", "torque")
        }
        return replace(self, joints=self.joints[columns], **views)


def harmonic(p: Parameters, position: Array, wave_number: Array) -> Array:
    """a cos(κ q) + b sin(κ q), (R, m), with κ = wave_number (m,) in 1/rad or 1/m."""
    phase = wave_number * position
    return p["a"] * np.cos(phase) + p["b"] * np.sin(phase)
