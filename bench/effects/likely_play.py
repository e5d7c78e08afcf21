"""The play, rotor and drag that the error of a motor suggests."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, product

import numpy as np

from bench.effects.play import Flight, Load
from bench.effects.signals import RobotSignals


@dataclass(frozen=True)
class PlayGrid:
    """Where a search for play begins, and where it ends.

    rotors: shares of the inertia at the joint. drags: over the inertia behind the play times the band, both lightly and
    strongly damped. flights: times through the play, over the shortest period of the band; shorter ones look alike.
    stride: rotors and flights this far apart are tried first, then the neighbours of the `kept` best. widest: play, rad
    or m, at a flight of one period. material: share of the motor's squared error that must be explained, below which
    nothing moves through the play. steps: first factors of play, rotor and drag in the local search; finest: factor of
    the play in its last step. heaviest: share of the inertia at the joint that the rotor can have. damped: largest
    factor between a drag and the band.
    """

    rotors: tuple[float, ...] = tuple(0.04 + 0.06 * i for i in range(16))
    drags: tuple[float, ...] = (0.3, 5.0)
    flights: tuple[float, ...] = tuple(0.25 * 1.19**i for i in range(13))
    stride: int = 2
    kept: int = 3
    widest: float = 0.03
    material: float = 0.03
    steps: tuple[float, float, float] = (1.3, 1.3, 2.0)
    finest: float = 1.02
    heaviest: float = 0.97
    damped: float = 100.0


GRID = PlayGrid()


@dataclass(frozen=True)
class LikelyPlay:
    """play: rad or m; rotor: inertia, kg*m2 or kg; drag: in the gap, N*m*s/rad or N*s/m."""

    play: float
    rotor: float
    drag: float


def likely_play(robots: Sequence[RobotSignals], joint: str) -> LikelyPlay:
    """The play, rotor and drag with which a link's way through the play explains most of its motor's error.

    Play and drag are zero if the link never changes its flank or that explains nothing; the rotor is then the one with
    which it is farthest from that.
    """
    search = PlaySearch(tuple(MotorError.of(robot, joint) for robot in robots), robots[0].joints[joint].band)
    if not (search.inertia > 0.0 and search.power > 0.0):
        return LikelyPlay(0.0, 0.0, 0.0)
    explained, best = search.best_of_grid()
    return search.refined(best, explained) if explained > GRID.material else search.without_crossing()


@dataclass(frozen=True)
class MotorError:
    """A recording: the load of a joint, and the spectrum of the motor's error inside the band, without its mean."""

    load: Load
    error: np.ndarray

    @classmethod
    def of(cls, robot: RobotSignals, joint: str) -> "MotorError":
        """The torque that the present model lacks at the joint's motor."""
        signals, load = robot.joints[joint], Load.of(robot, joint)
        error = (signals.motor_torque - signals.needed_torque)[:: robot.every]
        count = int(signals.band * load.interval * len(error))
        return cls(load, np.fft.rfft(error[1:-1])[1:count])

    def change(self, flight: Flight, rotor: float, play: float) -> np.ndarray:
        """The spectrum of the torque by the link's acceleration through the play."""
        torque = -np.diff(flight.lag(play), 2) / self.load.interval**2 * self.load.behind(rotor)[1:-1]
        return np.fft.rfft(torque)[1 : len(self.error) + 1]


Recording = tuple[MotorError, Flight]


@dataclass(frozen=True)
class PlaySearch:
    """The recordings in which play is looked for; band: highest frequency of the fit, Hz."""

    seen: tuple[MotorError, ...]
    band: float

    @cached_property
    def inertia(self) -> float:
        """Inertia at the joint, kg*m2 or kg: that of the recording with the heaviest load."""
        return max(each.load.mean for each in self.seen)

    @cached_property
    def power(self) -> float:
        """Sum of the squared errors."""
        return sum(float(np.vdot(each.error, each.error).real) for each in self.seen)

    def flights(self, rotor: float, drag: float) -> list[Recording]:
        """The recordings in which the link changes its flank."""
        every = ((each, Flight.under(each.load, rotor, drag)) for each in self.seen)
        return [(each, flight) for each, flight in every if flight.happens]

    def explained(self, flights: Sequence[Recording], tried: LikelyPlay) -> float:
        """Share of the squared errors that the way through the play explains; zero with the wrong sign.

        flights: with the rotor and the drag of `tried`.
        """
        changes = [(each.error, each.change(flight, tried.rotor, tried.play)) for each, flight in flights]
        square = sum(float(np.vdot(change, change).real) for _, change in changes)
        along = sum(float(np.vdot(error, change).real) for error, change in changes)
        return along**2 / (square * self.power) if along > 0.0 else 0.0

    @cached_property
    def jerk(self) -> float:
        """RMS change of the load with time over the inertia, of the recording with the largest, rad/s3 or m/s3."""
        steps = [
            float((np.diff(each.load.torque) ** 2).mean()) ** 0.5 / each.load.interval for each in self.seen
        ]
        return max(steps) / self.inertia

    def best_of_grid(self) -> tuple[float, LikelyPlay]:
        """The plays that the link crosses in a given time under its RMS change of load: the one that explains most, and
        the share that it explains.
        """
        rotors, flights = (
            range(GRID.stride // 2, len(each), GRID.stride) for each in (GRID.rotors, GRID.flights)
        )
        tried = self._explained_at(product(rotors, range(len(GRID.drags)), flights))
        best = sorted(tried, key=lambda place: -tried[place][0])[: GRID.kept]
        neighbours = {
            (i, drag, k)
            for rotor, drag, flight in best
            for i, k in product(range(rotor - 1, rotor + 2), range(flight - 1, flight + 2))
            if 0 <= i < len(GRID.rotors) and 0 <= k < len(GRID.flights)
        }
        tried |= self._explained_at(sorted(neighbours - tried.keys()))
        return max(tried.values(), key=lambda pair: pair[0])

    def _explained_at(
        self, places: Iterable[tuple[int, int, int]]
    ) -> dict[tuple[int, int, int], tuple[float, LikelyPlay]]:
        """For indices of rotor, drag and flight, sorted: the share that they explain, and their values."""
        tried = {}
        for (i, j), of_rotor in groupby(places, key=lambda place: place[:2]):
            rotor = GRID.rotors[i] * self.inertia
            drag = GRID.drags[j] * (self.inertia - rotor) * self.band
            flights = self.flights(rotor, drag)
            for place in of_rotor:
                length = GRID.flights[place[2]]
                play = min(self.jerk * (length / self.band) ** 3 / 6.0, GRID.widest * length)
                likely = LikelyPlay(play, rotor, drag)
                tried[place] = self.explained(flights, likely), likely
        return tried

    def refined(self, best: LikelyPlay, explained: float) -> LikelyPlay:
        """The best values in the neighbourhood, one moved after the other by ever smaller factors."""
        steps, flights = np.array(GRID.steps), self.flights(best.rotor, best.drag)
        heaviest, drag = GRID.heaviest * self.inertia, self.inertia * self.band
        least = np.array([0.0, 0.0, drag / GRID.damped])
        most = np.array([np.inf, heaviest, drag * GRID.damped])
        while steps[0] > GRID.finest:
            before = explained
            for k in np.repeat(np.arange(3), 2):
                values = np.array([best.play, best.rotor, best.drag])
                values[k] *= steps[k]
                moved = LikelyPlay(*np.clip(values, least, most).tolist())
                same = (moved.rotor, moved.drag) == (best.rotor, best.drag)
                moved_flights = flights if same else self.flights(moved.rotor, moved.drag)
                share = self.explained(moved_flights, moved)
                if share > explained:
                    explained, best, flights = share, moved, moved_flights
                else:
                    steps[k] = 1.0 / steps[k]
            steps = np.maximum(steps, 1.0 / steps)
            if explained == before:
                steps = np.sqrt(steps)
        return best

    def without_crossing(self) -> LikelyPlay:
        """No play and no drag, and the rotor with which the loads are farthest from a change of sign."""
        rotors = [share * self.inertia for share in GRID.rotors]
        return LikelyPlay(0.0, max(rotors, key=self._margin), 0.0)

    def _margin(self, rotor: float) -> float:
        """The least load on the flank that mostly carries it, N*m or N; negative if the link changes its flank."""
        loads = [each.load.torque - rotor * each.load.acceleration for each in self.seen]
        return min(float((load * np.sign(load.mean())).min()) for load in loads)
