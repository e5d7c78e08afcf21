"""Effects between current and torque in a simulation, stepped forwards in time."""

from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Mapping
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


class DriveLaw(ABC):
    """How one effect changes a motor's current; the torque that acts is the gain times the changed current."""

    @abstractmethod
    def passed(self, current: float, now: Instant) -> float:
        """The effective current."""

    def reset(self) -> None:
        """Clear the state."""
        return


@dataclass
class Late(DriveLaw):
    """`CurrentDelay`: the current at time t - T, linearly interpolated; before the first step, the first current."""

    delay: float
    _log: deque[tuple[float, float]] = field(default_factory=deque)

    def passed(self, current: float, now: Instant) -> float:
        """See `DriveLaw`."""
        self._log.append((now.time, current))
        wanted = now.time - self.delay
        while len(self._log) > 2 and self._log[1][0] <= wanted:
            self._log.popleft()
        times, currents = zip(*list(self._log)[:2], strict=True)
        return float(np.interp(wanted, times, currents))

    def reset(self) -> None:
        """See `DriveLaw`."""
        self._log.clear()


@dataclass
class Lagging(DriveLaw):
    """`CurrentLoopLag`: i_t + T di_t/dt = i, exact for a current that is constant between steps."""

    constant: float
    _state: tuple[float, float, float] | None = None

    def passed(self, current: float, now: Instant) -> float:
        """See `DriveLaw`."""
        if self._state is None:
            lagging = current
        else:
            time, held, before = self._state
            lagging = held + (before - held) * float(np.exp(-(now.time - time) / self.constant))
        self._state = now.time, current, lagging
        return lagging

    def reset(self) -> None:
        """See `DriveLaw`."""
        self._state = None


@dataclass(frozen=True)
class Saturating(DriveLaw):
    """`GainSaturation`: i (1 - k i^2)."""

    k: float

    def passed(self, current: float, now: Instant) -> float:  # noqa: ARG002 - the same at any instant
        """See `DriveLaw`."""
        return current * (1.0 - self.k * current**2)


@dataclass(frozen=True)
class Rippling(DriveLaw):
    """`TorqueRipple`: i (1 + a cos + b sin)."""

    a: float
    b: float
    periods: float
    rotates: bool

    def passed(self, current: float, now: Instant) -> float:
        """See `DriveLaw`."""
        cosine, sine = wave(np.array([now.position]), self.periods, self.rotates)[0]
        return current * (1.0 + self.a * float(cosine) + self.b * float(sine))


@dataclass(frozen=True)
class LossInGear(DriveLaw):
    """`LoadDependentFriction`: i (1 - mu sign(i dq/dt)), less torque where the motor drives, more where it brakes."""

    mu: float

    def passed(self, current: float, now: Instant) -> float:
        """See `DriveLaw`."""
        return current * (1.0 - self.mu * float(np.sign(current * now.velocity)))


def drive_law_of(effect: Effect, values: Mapping[str, float], rotates: bool) -> DriveLaw | None:
    """The law of an effect between current and torque; None if it has none that can be stepped forwards in time."""
    law: DriveLaw | None = None
    if isinstance(effect, CurrentDelay) and values["T"] >= 0.0:
        law = Late(values["T"])
    elif isinstance(effect, CurrentLoopLag) and values["T"] > 0.0:
        law = Lagging(values["T"])
    elif isinstance(effect, GainSaturation):
        law = Saturating(values["k"])
    elif isinstance(effect, TorqueRipple):
        law = Rippling(values["a"], values["b"], effect.periods, rotates)
    elif isinstance(effect, LoadDependentFriction):
        law = LossInGear(values["mu"])
    return law


ORDER = (Late, Lagging, Saturating, Rippling, LossInGear)
"""From the drive's input to the joint."""
