"""Bounds of the checks of a robot's description, by topic."""

from dataclasses import dataclass


@dataclass(frozen=True)
class AgreementBounds:
    """How far two libraries may differ, relative to a quantity's size (at least 1, in its SI unit)."""

    rounding: float = 1e-10  # of a tree
    closed: float = 1e-8  # of closed loops, which are closed to 1e-9
    moment: float = 1e-4  # s between the five residuals whose differences represent rates
    rates: float = 1e-5  # of these differences
    # share of a body's largest force or torque in the opened tree: of less, rounding counts by this
    unfelt: float = 1e-3
    length: float = 0.1  # m, of the random centres of mass and radii of gyration
    poses: int = 20  # random ones, open and closed
    travel: float = 0.5  # m by which slides and free bodies are moved in a random open pose


@dataclass(frozen=True)
class PlausibleBounds:
    """Sizes that a robot hardly has."""

    length: float = 20.0  # m: no robot is as large
    mass: float = 1e4  # kg: no link is as heavy
    fast: float = 20.0  # rad/rad, m/rad ...: passive for active speed at home, above which it is reported
    singular: float = 1e-6  # smallest singular value at home, below which it is singular
    regular: float = 0.02  # the same of a home that is proposed: with less, a pose further away is looked for
    rounded_tilt: float = 1e-5  # rad: a smaller one is the rounding that loops may have
    meant_tilt: float = 0.02  # rad: a larger one is on purpose
    still: float = 1e-6  # rad or m: a smaller travel is none
    end: float = 1e-9  # rad or m: rounding of a home position on the end of its range
    named: int = 4  # joints in a sentence


@dataclass(frozen=True)
class SingularityBounds:
    """The search for singular poses."""

    steps: int = 24  # of a path from home to the edge of the ranges
    corners: int = 16  # of the ranges
    directions: int = 24  # random ones, in addition to the axes and corners
    starts: int = 6  # poses of the scan, the worst first
    singular: float = 2e-3  # share of the smallest singular value at home: a smaller one counts as none
    apart: float = 0.1  # share of a motor's range: nearer poses need no separate start
    descent: int = 200  # steps of one descent


AGREEMENT = AgreementBounds()
PLAUSIBLE = PlausibleBounds()
SINGULARITY = SingularityBounds()
