"""Numerical bounds of loop closure, motion and base parameters, by topic."""

from dataclasses import dataclass


@dataclass(frozen=True)
class ClosingBounds:
    """Newton's method for loop closures; m or rad, unless stated."""

    closed: float = 1e-6  # correction: after a smaller one, the loops are closed to rounding
    closed_rates: float = 1e-10  # the same, before the Jacobian and rates are computed
    closed_nearby: float = 1e-9  # the same at a pose near home
    nearly: float = 1e-3  # the same, after which the error is about its square
    assembled: float = 1e-6  # gap at home, above which the description is wrong
    slack: float = 1e-5  # by which redundant closures may disagree; solved by least squares
    open: float = 100.0  # times a correction: it does not close a larger gap, which has no solution
    correction: float = 0.05  # largest one after a prediction or an interpolation
    step: float = 0.3  # of any joint, the largest
    turn: float = 0.2  # change of the amplification over a step
    share: float = 2.0**-12  # of the way to a target: if steps are smaller, it is out of reach
    amplification: float = 200.0  # rad/rad, m/rad ...: passive for active speed; singular beyond
    followed: int = 5  # corrections of one pose
    interpolated: int = 6  # corrections of interpolated poses
    nearby: int = 20  # corrections of a pose near home


@dataclass(frozen=True)
class NodeBounds:
    """The motion of all joints, interpolated between nodes."""

    # active travel between followed nodes, rad, or share of the robot's length for a slide
    travel: float = 0.3
    middle_travel: float = 0.1  # the same between the nodes of the middle level
    stride: int = 16  # samples between the nodes of the middle level
    block: int = 5120  # samples together, at most: more reduce Python's overhead, fewer stay in the cache
    few: float = 0.4  # share of samples that are corrected once more, separately


@dataclass(frozen=True)
class BasisBounds:
    """Base parameters and mobility: shares of the largest singular value, columns of unit length."""

    dependent: float = 1e-4  # a smaller one is the slack of a drawing, and counts as zero
    slack: float = 1e-5  # a smaller one may be the slack of a drawing, where a gap separates it
    gap: float = 100.0  # ratio of neighbouring values: the smaller ones count as zero
    rounding: float = 1e-9  # a smaller one cannot be distinguished from rounding
    # part of a column that is independent of those before it: with less, coefficients reach millions
    clear: float = 1e-3
    coefficient: float = 1e-10  # that counts as zero
    cure: float = 1e-6  # of rows of orthonormal motions: a smaller one is rounding
    # share of the largest entry of a motion: joints with less do not take part in it
    takes_part: float = 0.05
    reaction: float = 1e-6  # of a slide's speed of the closures: what remains is rounding
    # share of the force in a joint of equal bars: more depends on masses that no motor distinguishes
    open: float = 1e-6


@dataclass(frozen=True)
class PoseBounds:
    """Random poses at which ranks are determined."""

    states: int = 60  # at which identifiability is determined
    reaction_states: int = 3  # at which the influence of closures is determined
    # share of the poses, those nearest to a singularity, that is omitted: they cost digits
    near_singular: float = 0.25
    # times that of home, which counts as one at least: the search does not continue beyond
    amplification: float = 20.0
    unlimited: float = 0.8  # rad or m around home where the file gives no joint limits
    # rad, or share of the robot's length: distance from home of the pose that shows the general case
    nearby: float = 0.05


@dataclass(frozen=True)
class BodyBounds:
    """Guessed bodies, and points that coincide."""

    mass: float = 1.0  # kg for every body: only ratios matter
    shortest: float = 0.05  # m, of a body
    on_line: float = 1e-4  # share of the distance of two joints by which a third point may be off their line
    point: float = 1e-9  # m: nearer points are one
    tidy: float = 1e-15  # distance of a constant from an intended 0, 1 or -1


@dataclass(frozen=True)
class KeptBounds:
    """Sizes of blocks and caches."""

    geometries: int = 16  # whose constants, base parameters, spins and models are kept
    joints: int = 64  # whose geometry with a free bearing is kept
    block: int = 6144  # samples of a regressor together, at most


CLOSURE = ClosingBounds()
NODES = NodeBounds()
RANKS = BasisBounds()
RANDOM_POSES = PoseBounds()
BODIES = BodyBounds()
MEMORY = KeptBounds()
