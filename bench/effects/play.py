"""The way of a link through the play of its drive, and the play that the motor's torque suggests."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.effects.motor_link_difference import slopes, torque_of_motor
from bench.effects.signals import RobotSignals


@dataclass(frozen=True)
class PlayGrid:
    """Where a search for play begins, and where it ends.

    rotors: shares of the inertia at the joint. drags: over the inertia behind the play times the band, both lightly and
    strongly damped. flights: times through the play, over the shortest period of the band; shorter ones look alike.
    widest: play, rad or m, at a flight of one period. material: share of the motor's squared error that must be
    explained, below which nothing moves through the play. steps: first factors of play, rotor and drag in the local
    search; finest: factor of the play in its last step. heaviest: share of the inertia at the joint that the rotor can
    have. damped: largest factor between a drag and the band.
    """

    rotors: tuple[float, ...] = tuple(0.04 + 0.06 * i for i in range(16))
    drags: tuple[float, ...] = (0.3, 5.0)
    flights: tuple[float, ...] = tuple(0.25 * 1.19**i for i in range(13))
    widest: float = 0.03
    material: float = 0.03
    steps: tuple[float, float, float] = (1.3, 1.3, 2.0)
    finest: float = 1.02
    heaviest: float = 0.97
    damped: float = 100.0


GRID = PlayGrid()
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
        towards = {1.0: np.flatnonzero(self.pushed < 0.0), -1.0: np.flatnonzero(self.pushed > 0.0)}
        lag = np.empty(count)
        side, at = 1.0 if self.pushed[0] >= 0.0 else -1.0, 0
        while at < count:
            later = towards[side]
            k = int(np.searchsorted(later, at))
            leaves = int(later[k]) if k < len(later) else count
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


@dataclass(frozen=True)
class _Seen:
    """A recording in a search: the load, and the spectrum of the motor's error inside the band, without its mean."""

    load: Load
    error: np.ndarray

    @classmethod
    def of(cls, robot: RobotSignals, joint: str) -> "_Seen":
        signals, load = robot.joints[joint], Load.of(robot, joint)
        error = (signals.motor_torque - signals.needed_torque)[:: robot.every]
        count = int(signals.band * load.interval * len(error))
        return cls(load, np.fft.rfft(error[1:-1])[1:count])

    def change(self, flight: Flight, rotor: float, play: float) -> np.ndarray:
        """The spectrum of the torque by the link's acceleration through the play."""
        torque = -np.diff(flight.lag(play), 2) / self.load.interval**2 * self.load.behind(rotor)[1:-1]
        return np.fft.rfft(torque)[1 : len(self.error) + 1]


@dataclass(frozen=True)
class LikelyPlay:
    """play: rad or m; rotor: inertia, kg*m2 or kg; drag: N*m*s/rad or N*s/m."""

    play: float
    rotor: float
    drag: float


def likely_play(robots: Sequence[RobotSignals], joint: str) -> LikelyPlay:
    """The play, rotor and drag with which a link's way through the play explains most of its motor's error.

    The play is zero if it never changes its flank or explains nothing; then the rotor is one with which it does not
    change its flank, if there is one.
    """
    seen = [_Seen.of(robot, joint) for robot in robots]
    band = robots[0].joints[joint].band
    mean = max(each.load.mean for each in seen)
    power = sum(float(np.vdot(each.error, each.error).real) for each in seen)
    if not (mean > 0.0 and power > 0.0):
        return LikelyPlay(0.0, 0.0, 0.0)

    def flights(rotor: float, drag: float) -> list[tuple[_Seen, Flight]]:
        every = [(each, Flight.under(each.load, rotor, drag)) for each in seen]
        return [(each, flight) for each, flight in every if flight.happens]

    def explained(moving: Sequence[tuple[_Seen, Flight]], rotor: float, play: float) -> float:
        changes = [(each.error, each.change(flight, rotor, play)) for each, flight in moving]
        square = sum(float(np.vdot(change, change).real) for _, change in changes)
        along = sum(float(np.vdot(error, change).real) for error, change in changes)
        return along**2 / (square * power) if along > 0.0 else 0.0

    loads = [each.load for each in seen]
    jerk = max(float(np.sqrt((np.diff(load.torque) ** 2).mean())) / load.interval for load in loads) / mean
    best, values, still = 0.0, np.zeros(3), list[float]()
    for share in GRID.rotors:
        rotor = share * mean
        if not flights(rotor, 0.0):
            still.append(rotor)
            continue
        for relative in GRID.drags:
            drag = relative * (mean - rotor) * band
            moving = flights(rotor, drag)
            for length in GRID.flights:
                play = min(jerk * (length / band) ** 3 / 6.0, GRID.widest * length)
                share_explained = explained(moving, rotor, play)
                if share_explained > best:
                    best, values = share_explained, np.array([play, rotor, drag])
    if best < GRID.material:
        rotor = still[len(still) // 2] if still else GRID.rotors[0] * mean
        return LikelyPlay(0.0, rotor, GRID.drags[0] * (mean - rotor) * band)
    limits = np.array(
        [[0.0, np.inf], [0.0, GRID.heaviest * mean], mean * band * np.array([1.0 / GRID.damped, GRID.damped])]
    )
    steps = np.array(GRID.steps)
    while steps[0] > GRID.finest:
        before = best
        for k, factor in ((k, factor) for k in range(3) for factor in (steps[k], 1.0 / steps[k])):
            tried = values.copy()
            tried[k] = np.clip(tried[k] * factor, *limits[k])
            share_explained = explained(flights(*tried[1:].tolist()), float(tried[1]), float(tried[0]))
            if share_explained > best:
                best, values = share_explained, tried
        if best == before:
            steps = np.sqrt(steps)
    return LikelyPlay(*values.tolist())
