"""The way of a link through the play of its drive."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.effects.motor_link_difference import slopes, torque_of_motor
from bench.effects.signals import RobotSignals

LIGHTEST = 0.01  # of the mean inertia at the joint: the least that remains behind the play
UNDAMPED = 1e-6  # drag in a sample, below which a rounded quotient is replaced by its limit


@dataclass(frozen=True)
class Load:
    """What acts at a joint with play, at K samples.

    torque (K,): of the present model; acceleration (K,): of the joint; inertia (K,): the torque's derivative by that
    acceleration; interval: s, between samples.
    """

    torque: np.ndarray
    acceleration: np.ndarray
    inertia: np.ndarray
    interval: float

    @classmethod
    def of(cls, robot: RobotSignals, joint: str) -> "Load":
        """At the coarse samples of a recording."""
        at = list(robot.joints).index(joint)
        return cls(*torque_of_motor(robot, joint), slopes(robot, joint)[2, :, at], robot.coarse.interval)

    @cached_property
    def mean(self) -> float:
        """Mean inertia at the joint, kg*m2 or kg."""
        return float(np.abs(self.inertia).mean())

    def behind(self, rotor: float) -> np.ndarray:
        """Inertia (K,) that remains behind the play without that of the rotor; above zero."""
        return np.maximum(self.inertia - rotor, LIGHTEST * self.mean)

    def pushed(self, rotor: float) -> np.ndarray:
        """Acceleration (K,) with which the link would fall behind its motor if nothing held it; its sign says on which
        flank it lies.
        """
        return np.asarray((self.torque - rotor * self.acceleration) / self.behind(rotor))


@dataclass(frozen=True)
class Flight:
    """Motion of a link relative to its motor without contact: d'' = pushed - drag / behind d'.

    pushed (K,); decays, pushes, sways: of each of K - 1 steps, the share of the speed that remains, the speed gained
    and the part of the way that the mean of the speeds before and after lacks.
    """

    pushed: np.ndarray
    interval: float
    decays: list[float]
    pushes: list[float]
    sways: list[float]

    @classmethod
    def under(cls, load: Load, rotor: float, drag: float) -> "Flight":
        """With a rotor of that inertia, kg*m2 or kg, and drag in the gap, N*m*s/rad or N*s/m."""
        pushed, interval = load.pushed(rotor), load.interval
        turns = max(drag, 0.0) * interval / load.behind(rotor)[1:]
        decays = np.exp(-turns)
        slowed = np.divide(1.0 - decays, turns, out=np.ones_like(turns), where=turns > UNDAMPED)
        pushes = 0.5 * interval * slowed * (pushed[:-1] + pushed[1:])
        sways = interval**2 / 12.0 * slowed * (pushed[:-1] - pushed[1:])
        return cls(pushed, interval, decays.tolist(), pushes.tolist(), sways.tolist())

    @property
    def happens(self) -> bool:
        """Whether the link ever changes its flank."""
        return bool(self.pushed.min() < 0.0 < self.pushed.max())

    def lag(self, play: float) -> np.ndarray:
        """The lag (K,) of the link behind its motor, between -play / 2 and play / 2, rad or m.

        On a flank until the push changes its sign, then free until it meets a flank, on which it stays: an impact
        without rebound.
        """
        half, count = 0.5 * play, len(self.pushed)
        lag = np.empty(count)
        side, at = 1.0 if self.pushed[0] >= 0.0 else -1.0, 0
        while at < count:
            leaves = self._leaves[side][at]
            lag[at:leaves] = side * half
            if leaves == count:
                break
            way, end = self._way(leaves, side, half, touching=leaves == at)
            lag[leaves : leaves + len(way)] = way
            at = leaves + len(way)
            if at < count:
                side = 1.0 if end > 0.0 else -1.0
                lag[at] = side * half
                at += 1
        return lag

    @cached_property
    def _leaves(self) -> dict[float, list[int]]:
        """For either flank and each sample, the next sample with a push away from it, K if there is none."""
        every, count = np.arange(len(self.pushed)), len(self.pushed)
        return {
            side: np.minimum.accumulate(np.where(side * self.pushed < 0.0, every, count)[::-1])[::-1].tolist()
            for side in (1.0, -1.0)
        }

    def _way(self, leaves: int, side: float, half: float, *, touching: bool) -> tuple[list[float], float]:
        """Lags while free, from the first sample with a push away from the flank, and the lag beyond.

        touching: the link met the flank a sample before; otherwise the push changed its sign between two samples.
        """
        push = float(self.pushed[leaves])
        since = 0.0 if touching else self.interval * push / (push - float(self.pushed[leaves - 1]))
        speed, place = 0.5 * since * push, side * half + since**2 * push / 6.0
        decays, pushes, sways, half_step = self.decays, self.pushes, self.sways, 0.5 * self.interval
        way = [place]
        for i in range(leaves, len(pushes)):
            after = decays[i] * speed + pushes[i]
            place += half_step * (speed + after) + sways[i]
            speed = after
            if not -half < place < half:
                return way, place
            way.append(place)
        return way, place
