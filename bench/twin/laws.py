"""Effects at the joints of a simulation, step by step: the load that the MJCF cannot represent."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.files.python_file import MISTAKES
from bench.effects import ActuatorEffect, Effect, JointSignals
from bench.effects.laws.presliding_hysteresis import PreslidingHysteresis

TINY = 1e-9  # rad/s or m/s: practically zero, used with either sign
SAMPLES = 12  # random samples that test whether an effect is memoryless
ALIKE = 1e-9


@dataclass(frozen=True)
class Instant:
    """State of one driven joint at a time (s): position and velocity, rad or m, and current in drive units."""

    time: float
    position: float
    velocity: float
    current: float


class _NeedsTorqueError(BenchError):
    """An effect requested the torque of the whole model."""


def _asked() -> np.ndarray:
    raise _NeedsTorqueError("an effect asked for the torque that the model needs")


@dataclass(frozen=True)
class Memoryless:
    """An effect that depends on the instant alone. Half of its jump at zero velocity is dry friction."""

    effect: ActuatorEffect
    values: np.ndarray
    gain: float
    rotates: bool

    def opposing(self, now: Instant) -> tuple[float, float]:
        """Torque that the motor has to overcome, N*m or N, and the dry friction, which can hold the joint at rest."""
        samples = np.tile([[now.time], [now.position], [now.velocity], [0.0], [now.current]], 3)
        samples[2, 1:] = TINY, -TINY
        torque = self.at(*samples)
        dry = max(0.5 * float(torque[1] - torque[2]), 0.0)
        direction = float(np.sign(now.velocity))
        return float(torque[0]) - dry * direction, dry

    def at(self, *samples: np.ndarray, needs: Callable[[], np.ndarray] = _asked) -> np.ndarray:
        """The torque (N,) of the law at samples: time, position, velocity, acceleration and current, (N,) each; needs:
        computes the torque that the model needs, if it is known.
        """
        time, position, velocity, acceleration, current = samples
        speed = rate = band = 1.0
        signals = JointSignals(
            time, position, velocity, acceleration, current, self.gain, speed, rate, band, self.rotates, needs
        )
        return np.asarray(self.effect.torque(signals), dtype=float) @ self.values


@dataclass
class Dahl:
    """`PreslidingHysteresis`, step by step: z approaches the sign of the motion exponentially with the travel."""

    friction: float
    displacement: float
    _state: float = 0.0
    _before: float | None = None

    def opposing(self, now: Instant) -> tuple[float, float]:
        """As of `Memoryless`."""
        if self._before is not None and now.position != self._before:
            way = now.position - self._before
            direction = float(np.sign(way))
            self._state = direction + (self._state - direction) * float(np.exp(-abs(way) / self.displacement))
        self._before = now.position
        return self.friction * self._state, 0.0


JointLaw = Memoryless | Dahl
"""The load of one effect at one driven joint."""


def joint_law_of(effect: Effect, values: Mapping[str, float], gain: float, rotates: bool) -> JointLaw | None:
    """The law of an effect at a driven joint; None if it depends on more than the instant."""
    if isinstance(effect, PreslidingHysteresis):
        return Dahl(values["Fc"], effect.x0)
    if not isinstance(effect, ActuatorEffect) or type(effect).columns is not ActuatorEffect.columns:
        return None
    if effect.before_torque:
        return None
    law = Memoryless(
        effect, np.array([values[parameter.name] for parameter in effect.parameters]), gain, rotates
    )
    return law if _follows_from_the_instant(law) else None


def _follows_from_the_instant(law: Memoryless) -> bool:
    """Whether single samples, and samples in another order with another acceleration, give the same torque."""
    random = np.random.default_rng(20121)
    samples = np.vstack((np.sort(random.uniform(0.0, 5.0, SAMPLES)), random.normal(size=(4, SAMPLES))))
    order = random.permutation(SAMPLES)
    backwards, unmoved = (samples * np.array([1.0, 1.0, 1.0, sign, 1.0])[:, None] for sign in (-1.0, 0.0))
    try:
        whole = law.at(*samples)
        other = law.at(*backwards[:, order])
        alone = [law.at(*unmoved[:, k : k + 1])[0] for k in range(SAMPLES)]
    except (*MISTAKES, _NeedsTorqueError):
        return False
    scale = ALIKE * (1.0 + np.abs(whole).max())
    return bool(np.abs(other - whole[order]).max() < scale and np.abs(alone - whole).max() < scale)
