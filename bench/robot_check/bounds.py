"""Bounds of the checks of a robot's description, by topic."""

from dataclasses import dataclass


@dataclass(frozen=True)
class AgreementBounds:
    """How far two libraries may differ, relative to a quantity's size (at least 1, in its SI unit)."""

    rounding: float = 1e-10  # of a tree
    closed: float = 1e-8  # of closed loops, which are closed to 1e-9
    moment: float = 1e-4  # s between the five residuals whose finite differences are compared with rates
    rates: float = 1e-5  # of these differences
    # share of a body's largest force or torque in the opened tree: smaller motor torques are compared relative to this
    unfelt: float = 1e-3
    length: float = 0.1  # m, of the random centres of mass and radii of gyration
    poses: int = 20  # random ones, open and closed
    travel: float = 0.5  # m by which slides and free bodies are moved in a random open pose


@dataclass(frozen=True)
class PlausibleBounds:
    """Bounds of plausible values."""

    length: float = 20.0  # m: no robot is this large
    mass: float = 1e4  # kg: no link is this heavy
    fast: float = 20.0  # rad/rad, m/rad ...: passive per active speed at home, reported above this
    singular: float = 1e-6  # smallest singular value at home, below which home is singular
    regular: float = 0.02  # the same for a proposed home: below this, a pose further away is searched
    rounded_tilt: float = 1e-5  # rad: a smaller tilt is rounding that loops may have
    meant_tilt: float = 0.02  # rad: a larger tilt is intended
    still: float = 1e-6  # rad or m: a smaller travel counts as zero
    end: float = 1e-9  # rad or m: rounding of a home position at the end of its range
    named: int = 4  # joints listed in a sentence


@dataclass(frozen=True)
class SingularityBounds:
    """The search for singular poses."""

    steps: int = 24  # of a path from home to the edge of the ranges
    corners: int = 16  # of the ranges, at most: with more, none is a target
    directions: int = 24  # random targets, in addition to the axes and corners
    starts: int = 6  # poses of the scan from which the search descends, the worst first
    singular: float = 2e-3  # share of the smallest singular value at home: below this, a pose is singular
    apart: float = 0.1  # share of a motor's range: poses closer than this share one start
    descent: int = 200  # steps of one descent


AGREEMENT = AgreementBounds()
PLAUSIBLE = PlausibleBounds()
SINGULARITY = SingularityBounds()
