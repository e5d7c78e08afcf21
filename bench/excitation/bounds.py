"""Bounds of designed motions and of their search, by topic."""

from dataclasses import dataclass


@dataclass(frozen=True)
class MotionLimitBounds:
    """Margins of a motion, and assumptions for a robot without limits."""

    margin: float = 0.05  # share of a joint's range, kept free at both ends
    amplification: float = 3.0  # times that of the home pose: passive for active speed
    # share of the smallest singular value of the closures at home: less is nearly singular
    held: float = 0.1
    poses: int = 64  # of a motion to examine, those nearest to a singularity
    crossing: float = 1.0  # s in which a joint crosses its range at the speed that is assumed
    reaching: float = 0.1  # s in which it reaches that speed


@dataclass(frozen=True)
class MotionDesignBounds:
    """Random sets of trajectories, the best of which is improved."""

    starts: int = 12  # random sets
    steps: int = 120  # of the improvement
    points: int = 12  # samples of a period of the highest harmonic
    shrink: float = 0.9  # factor that shrinks a motion beyond its limits
    shrinks: int = 25  # of a motion
    first_spread: float = 0.4  # of a change, relative to a coefficient's size, at the start
    last_spread: float = 0.05  # the same at the end
    current_band: float = 3.0  # times a motion's highest harmonic: products of two rates have twice that
    # share of the power of a current with its mean: one that varies by less does not vary
    steady: float = 1e-18


@dataclass(frozen=True)
class DiscriminationBounds:
    """The motion that distinguishes two effects."""

    starts: int = 40  # random motions, the best of which is improved
    steps: int = 80  # of the improvement
    first_spread: float = 0.5  # of a change, relative to a coefficient's size, at the start
    # shares of the largest speed: some effects show in slow motion only
    speeds: tuple[float, ...] = (1.0, 1.0, 0.5, 0.2, 0.05)
    harmonics: tuple[int, ...] = (2, 4, 8)  # of a motion
    least_periods: float = 1.0  # of the base frequency in a motion
    band: float = 2.5  # of a fit to the new motion, in units of its highest harmonic
    payload_evidence: float = 1.2  # times the evidence: least gain that justifies a payload
    ramp: float = 1.0  # s, the longest
    points: float = 60.0  # samples of a period of the highest harmonic, and of a ramp
    span: float = 1e-3  # rad or m, the smallest
    longest: float = 30.0  # s, of a motion whose duration is not given
    shortest: float = 5.0  # s, of such a motion
    alike: float = 3e-4  # share of an effect: another that leaves less imitates it
    alike_motions: int = 8  # on which that is tested
    wider: float = 2.0  # times the limits: tried if these are not enough
    heavier: float = 2.0  # times the heaviest payload: a second one
    faint: float = 0.5  # nats that a motion promises: less is not worth a recording
    faster: float = 3.0  # times the highest frequency of the recorded motions
    current: float = 1.1  # times the largest recorded current
    # share of the recorded travel: in a smaller one encoders and sticking joints decide
    stroke: float = 0.15
    rate: float = 200.0  # Hz, at which reversals are counted
    slow: float = 0.01  # share of the largest speed: changes of sign below are no reversals
    decimation: int = 4  # samples of a planned motion for each row of the fit
    current_settled: float = 1e-6  # relative, of the current if an effect depends on it
    current_rounds: int = 12  # for such a current
    loud: float = 3.0  # times the noise of the currents: an error that no correct model has
    much: float = 1.5  # times another figure: reported
    beyond: float = 0.05  # share of the recorded travel: a motion further out is reported
    dependent: float = 1e-10  # share of the largest singular value of scaled columns


@dataclass(frozen=True)
class PlanSearchBounds:
    """The search for a planned experiment."""

    steps: int = 90  # of the improvement
    random: int = 50  # motions, the best few of which are improved
    # random motions for validation, of which the best is taken: the robot moves well there
    validation: int = 5
    tries: int = 20  # of a random motion, until one keeps the limits at some size
    shrinks: int = 40  # of a motion
    # of a motion that cannot be proven yet; then larger ones, since each proof takes seconds
    small_shrinks: int = 3
    standing: float = 0.02  # s at home, examined before any motion: a few intervals of a proof
    sparse_harmonics: int = 3  # for each joint of a sparse motion
    points: float = 8.0  # samples of a period of the highest harmonic
    ramp_points: int = 20  # samples of a ramp, at least
    torque_motions: int = 5  # random motions that show how large the torques are
    frequency_range: float = 2.0  # factor to the base frequency, up or down
    table_points: float = 8.0  # rows of the controller's table in a period of the highest harmonic, at least
    # of the mean of all errors next to the largest: where that one cannot fall, others shall
    mean_weight: float = 0.03
    # how many motions go on, and their share of the steps together
    rounds: tuple[tuple[int, float], ...] = ((8, 0.3), (3, 0.3), (1, 0.4))
    first_step: float = 0.1  # share of the largest size of a coefficient: trusted at the start
    smallest_step: float = 1e-4  # the same: the smallest that is trusted
    largest_step: float = 0.5  # the same: the largest
    enough: float = 0.1  # share of the predicted fall, for a step to be accepted
    good: float = 0.6  # the same, for larger steps to be trusted
    # share of a joint's room, speed and acceleration, for difference quotients of the motion
    difference: float = 1e-5
    # share of the largest size of a coefficient, for those of the errors
    coefficient_difference: float = 1e-4
    near: float = 0.5  # share of a limit and of the largest error: less is omitted in one step
    finer: int = 3  # times as many samples for ranges, speeds and accelerations


@dataclass(frozen=True)
class ForecastBounds:
    """Forecast standard errors."""

    # share of the largest eigenvalue, columns of unit length: a direction with less is not determined
    undetermined: float = 1e-12
    # share of the largest entry of a direction: unknowns with less do not belong to it
    takes_part: float = 0.1
    open: float = 1e6  # times its size: standard error of an undetermined unknown, in a search
    # times the standard error by the currents' noise alone: beyond, the encoders' steps matter
    encoder_steps: float = 1.2
    encoder_difference: float = 1e-4  # rad or m and rates, for difference quotients
    encoder_points: float = 40.0  # samples of a period of the highest harmonic
    masses: float = 1.25  # from one tried payload to the next
    lightest: float = 0.02  # share of the robot's moving mass
    heaviest: float = 3.0  # times the robot's moving mass
    longest: float = 20.0  # times the duration: longer recordings are no advice
    # of a motor's RMS torque: the size to which a parameter of an effect is compared
    effect_share: float = 0.1
    # share of the largest base parameter of its unit, to which a smaller one is compared
    smallest_size: float = 0.05
    named: int = 3  # parameters of a list


@dataclass(frozen=True)
class ProofBounds:
    """The proof that a motion keeps its limits between its samples."""

    rate: float = 1000.0  # intervals per second, before any is cut
    shortest: float = 2.0**-10  # of such an interval: shorter ones are not cut
    parts: int = 16  # into which one is cut at once
    ahead: int = 16  # intervals, by the first of which it is known into how many parts these are cut
    # times as many parts as proportion asks for: it is nearly one, and a second cut costs more
    more_parts: float = 1.15
    together: int = 4096  # intervals
    around: float = 0.05  # s around a time at which a larger motion failed: examined first
    period_points: float = 60.0  # samples of a period of the highest harmonic
    ramp_points: float = 200.0  # samples of a ramp, at least
    # times what is passed through at the speeds of the middle: the set of poses has the end of the interval before in
    # it, and what is passed through at other speeds; with more, it has to be cut sooner
    wider: float = 3.0
    # share of the largest radius of a pose's set: a joint that hardly moves has that
    least_radius: float = 0.5
    # rad, or share of the robot's length: error of a closed pose, in addition to its residual
    closed: float = 1e-12
    cached: int = 250_000  # bytes of matrices processed together
    # of I - C A_p, below 1: with less, sets are smaller; with more, speeds in them vary more
    turned: float = 0.75
    # rad, or share of the robot's length: of a ball or free joint in its set, whose rates turn with it
    moved: float = 0.1
    rounding: float = 1e-9  # share of a bound, reserved for rounding of radii and singular values


LIMITS = MotionLimitBounds()
DESIGN = MotionDesignBounds()
DISCRIMINATION = DiscriminationBounds()
SEARCH = PlanSearchBounds()
FORECAST = ForecastBounds()
PROOF = ProofBounds()
