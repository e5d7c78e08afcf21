"""The simulated machine of a planned scenario: stiffness of its controller, and its time steps."""

from dataclasses import dataclass
from math import ceil

STIFF = 30.0  # Hz: the controller that is tried first, so that the motion is the planned one
COARSE = 0.00025  # s: the step that is tried first


@dataclass(frozen=True)
class SimulatedDrive:
    """natural_frequency of the controller, Hz, by the inertia at home; step: the largest of the simulation, s."""

    natural_frequency: float = STIFF
    step: float = COARSE

    def step_at(self, rate: float) -> float:
        """The step, s, a whole number of which is a sample of a log at this rate, Hz."""
        return 1.0 / (rate * ceil(1.0 / (rate * self.step) - 1e-6))


FIRST = SimulatedDrive()
DRIVES = (
    FIRST,
    SimulatedDrive(15.0),
    SimulatedDrive(STIFF, 0.0001),
    SimulatedDrive(10.0, 0.0001),
    SimulatedDrive(5.0, 0.00005),
)
"""Tried in turn. A controller that is stiff for the inertia at home is too stiff where the apparent inertia is smaller:
in a pose in which motors hardly move a heavy tool, explicit steps diverge unless it is softer or they are shorter.
Coarse steps come first, since the time of a simulation grows with their number.
"""
