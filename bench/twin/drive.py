"""Effects between current and torque in a simulation, stepped forwards in time."""

from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from bench.effects import Effect
from bench.effects.laws.current_delay import CurrentDelay
from bench.effects.laws.current_loop_lag import CurrentLoopLag
from bench.effects.laws.gain_saturation import GainSaturation
from bench.effects.laws.load_dependent_friction import LoadDependentFriction
from bench.effects.laws.torque_ripple import TorqueRipple
from bench.effects.periods import wave
from bench.twin.laws import Instant

DriveLaw = Callable[[float, Instant], float]
"""The effective current that one effect makes of a motor's current; the torque that acts is the gain times it."""


@dataclass
class Late:
    """`CurrentDelay`: the current at time t - T, linearly interpolated; before the first step, the first current."""

    delay: float
    _log: deque[tuple[float, float]] = field(default_factory=deque)

    def __call__(self, current: float, now: Instant) -> float:
        """See `DriveLaw`."""
        self._log.append((now.time, current))
        wanted = now.time - self.delay
        while len(self._log) > 2 and self._log[1][0] <= wanted:
            self._log.popleft()
        times, currents = zip(*list(self._log)[:2], strict=True)
        return float(np.interp(wanted, times, currents))


@dataclass
class Lagging:
    """`CurrentLoopLag`: i_t + T di_t/dt = i, exact for a current that is constant between steps."""

    constant: float
    _state: tuple[float, float, float] | None = None

    def __call__(self, current: float, now: Instant) -> float:
        """See `DriveLaw`."""
        lagging = current
        if self._state is not None:
            time, held, before = self._state
            lagging = held + (before - held) * float(np.exp(-(now.time - time) / self.constant))
        self._state = now.time, current, lagging
        return lagging


def drive_law_of(effect: Effect, values: Mapping[str, float], rotates: bool) -> tuple[int, DriveLaw] | None:
    """The law of an effect between current and torque, and its rank from the drive's input to the joint; None if it has
    none that can be stepped forwards in time.
    """
    if isinstance(effect, CurrentDelay) and values["T"] >= 0.0:
        return 0, Late(values["T"])
    if isinstance(effect, CurrentLoopLag) and values["T"] > 0.0:
        return 1, Lagging(values["T"])
    if isinstance(effect, GainSaturation):  # i (1 - k i^2)
        return 2, lambda current, _: current * (1.0 - values["k"] * current**2)
    if isinstance(effect, TorqueRipple):  # i (1 + a cos + b sin)

        def rippling(current: float, now: Instant) -> float:
            cosine, sine = wave(np.array([now.position]), effect.periods, rotates)[0]
            return current * (1.0 + values["a"] * float(cosine) + values["b"] * float(sine))

        return 3, rippling
    if isinstance(effect, LoadDependentFriction):
        # i (1 - mu sign(i dq/dt)): less torque where the motor drives, more where it brakes
        return 4, lambda current, now: current * (1.0 - values["mu"] * float(np.sign(current * now.velocity)))
    return None
