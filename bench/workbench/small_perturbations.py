"""Small changes of motion or geometry at less cost: for robots with many loops, of which a page has many effects.

The torque that a small shift of an active joint takes is linear in the shift and in its two rates. What stands before
them follows the motion smoothly, and so does what a changed geometry takes: both are computed at few samples.
"""

from dataclasses import dataclass, field, fields

import numpy as np

from bench.basics.interpolation import cubic_spline
from bench.effects import RobotSignals

THINNER = 6  # coarse samples between two at which a change is computed
TURN, SLIDE = 1e-4, 1e-5  # rad, m: shift of a joint for the difference quotient
SHARE = 1e-4  # of the RMS speed or acceleration, likewise

Key = tuple[int, int]
"""0, 1 or 2 for position, velocity or acceleration, and the motor."""


@dataclass(frozen=True)
class SmallChanges(RobotSignals):
    """A recording in which all changes of the torque are small and smooth.

    slopes: torque at the coarse samples (K, n), or (K, n, D) of several models, for one unit of each shift that was
    asked for.
    """

    slopes: dict[Key, np.ndarray] = field(default_factory=dict, compare=False, repr=False)

    def torque_change(
        self,
        shift: np.ndarray | None = None,
        *,
        gravity: np.ndarray | None = None,
        geometry: object = None,
    ) -> np.ndarray:
        """As `RobotSignals.torque_change`, linear in `shift`, which comes alone."""
        if shift is None:
            return self._smooth(self._at_few(gravity=gravity, geometry=geometry), self.time)
        return self.refined(self.coarse_change(shift))

    def coarse_change(
        self,
        shift: np.ndarray | None = None,
        *,
        gravity: np.ndarray | None = None,
        geometry: object = None,
    ) -> np.ndarray:
        """As `RobotSignals.coarse_change`, likewise."""
        if shift is None:
            return self._smooth(self._at_few(gravity=gravity, geometry=geometry), self.coarse.time)
        change = np.zeros_like(self.coarse.torque)
        for order, motor in zip(*np.nonzero(shift.any(axis=1)), strict=True):
            values = shift[order, :, motor]
            slope = self._slope((int(order), int(motor)))
            change += slope * values.reshape(-1, *(1,) * (slope.ndim - 1))
        return change

    def _slope(self, key: Key) -> np.ndarray:
        if key not in self.slopes:
            order, motor = key
            here = self.coarse
            joint = list(self.joints.values())[motor]
            measured = (here.position, here.velocity, here.acceleration)[order][::THINNER]
            step = TURN if joint.rotates else SLIDE
            if order:
                step = SHARE * float(np.sqrt((measured[:, motor] ** 2).mean())) or SHARE
            moved = measured.copy()
            moved[:, motor] += step
            names = ("position", "velocity", "acceleration")
            self.slopes[key] = self._smooth(self._at_few(**{names[order]: moved}) / step, here.time)
        return self.slopes[key]

    def _at_few(self, **changes: object) -> np.ndarray:
        """The change of the torque at every THINNER-th coarse sample."""
        changed = self.torque(**changes, every=self.every * THINNER)  # type: ignore[arg-type]
        return changed - self.coarse.torque[::THINNER]

    def _smooth(self, values: np.ndarray, time: np.ndarray) -> np.ndarray:
        return cubic_spline(self.coarse.time[::THINNER], values)(time)


def small_changes(signals: RobotSignals) -> SmallChanges:
    """The same recording, seen so."""
    given = {
        one.name: getattr(signals, one.name)
        for one in fields(RobotSignals)
        if one.name not in ("passing", "noted")
    }
    return SmallChanges(**given)
