"""Numerical bounds of identification and diagnosis, in one value: `TOLERANCES`.

What decides between models is in `bench.identification.decision`.
"""

from dataclasses import dataclass, field

from bench.basics.in_force import InForce


@dataclass(frozen=True)
class RankBounds:
    """What counts as dependent, invisible or zero: shares of a length, unless stated."""

    columns: float = 1e-13  # share of the largest singular value, below which columns are dependent
    products: float = 1e-12  # the same for inner products of unit columns, which are squares
    instruments: float = 1e-9  # the same for the instruments of a motor, columns of unit length
    terms: float = 1e-10  # the same for the columns of a law's terms
    pivot: float = 1e-6  # least pivot of scaled unknowns for which a Cholesky factorisation is accurate
    triangle: float = 1e-9  # least diagonal of a triangular factor of unit columns that is inverted
    # part of a column outside the model's columns, above which an effect is identifiable
    independent: float = 1e-7
    visible_effect: float = 1e-4  # the same for a proposed effect: it cannot be distinguished below
    visible_term: float = 1e-3  # the same for a term of a law
    candidate: float = 1e-10  # the same for a column among all candidates: below, it is rounding
    remainder: float = 1e-6  # the same where only inner products are known: they cannot resolve less
    torque: float = 1e-9  # share of the motors' torque: a smaller column is rounding
    motor_error: float = 1e-9  # share of the largest torque: least error of a motor
    # least share of the information on a combination that the other blocks must have
    combination: float = 1e-9
    column_error: float = 1e-9  # error of a column for which no error is known
    square: float = 1e-150  # times the nominal gain: the square of a smaller number underflows
    ridge_of_terms: float = 1e-9  # added to a unit diagonal, so that equal parts of a term can be solved
    ratio: float = 1e-6  # distance of the ratio of two rates from a whole number
    digits: int = 7  # decimals of the explained share by which terms are sorted


@dataclass(frozen=True)
class StepBounds:
    """Steps of Gauss and Newton for values and gains, and the rounds around them."""

    most: int = 50  # steps to a minimum
    reweightings: int = 3  # of the motors, by their errors
    total_reweightings: int = 5  # the same for total least squares
    converged: float = 1e-12  # relative decrease of the cost in the last step
    between_weights: float = 1e-9  # the same while the weights still change
    set_converged: float = 1e-7  # the same for a set of effects in a search
    runaway_set_converged: float = 1e-4  # the same for a set with a runaway gain, which is useless
    endless: float = 1e-12  # the same, above which gains run away without end
    rounding: float = 1e-9  # relative growth of the cost that rounding can cause
    least_share: float = 1e-3  # of a step; a shorter one is not tried
    gain_factor: float = 4.0  # largest factor by which one step changes a gain
    runaway_factor: float = 30.0  # factor between a gain and its start, beyond which it has run away
    recentred_factor: float = 2.0  # the same, beyond which products are too inexact and are formed again
    recentred: int = 4  # times that products are formed again at other gains
    # decrease of the cost over that of the last step, above which steps creep along a valley
    creeping: float = 0.1
    creeping_nats: float = 1e-3  # decrease below which creeping steps end: chance has a larger effect
    scale_ratio: float = 100.0  # between motors, beyond which a basis is formed for other scales
    rounds: int = 6  # of gains and shape parameters
    settled: float = 1e-4  # relative change of gains and shape parameters between rounds
    # relative change of the RMS errors between rounds: chance has a far larger effect
    errors_settled: float = 1e-6
    settled_nats: float = 5e-3  # of all errors together: the data do not determine a smaller change
    linearisations_at_bounds: int = 4  # to see whether a parameter goes beyond its bound
    gains_at_bounds: float = 1e-3  # relative change of gains between them
    linearisations_of_candidates: int = 3  # of a proposed effect
    # share of a value by which it may differ from where its effect is linearised
    linearisation_reached: float = 0.1
    reaction_rounds: int = 3  # of torques in joints that depend on the bearing forces that they cause


@dataclass(frozen=True)
class ShapeBounds:
    """The search for nonlinear parameters; relative to the parameter, unless stated."""

    tolerance: float = 1e-4  # of a shape parameter of an effect
    number_tolerance: float = 1e-3  # of a number in a law
    values: int = 500  # of one parameter in one search
    nodes: int = 7  # values within a bracket at which columns are evaluated
    # ratio of a bracket's ends, above which its nodes are spread by their logarithm
    logarithmic: float = 2.0
    nearby: float = 0.02  # largest distance from the present value in a local step
    stride: float = 0.5  # largest change in one step of all parameters
    # of such a step that are tried, until one does not increase the errors
    shares: tuple[float, ...] = (1.0, 0.3, 0.1)
    difference: float = 1e-3  # for the derivative by a shape parameter
    expansion: float = 5.0  # times its nodes: range in which a column is taken as linear


@dataclass(frozen=True)
class RobustBounds:
    """Maximum likelihood with Student's distribution."""

    least_freedom: float = 1.0  # degrees of freedom: Cauchy's distribution
    most_freedom: float = 200.0  # degrees of freedom: the normal distribution in practice
    first_freedom: float = 4.0  # degrees of freedom at the start
    start_rounds: int = 10  # to choose a start
    rounds: int = 100  # to the maximum
    settled: float = 1e-6  # largest change of a row's weight between rounds


@dataclass(frozen=True)
class StatisticsBounds:
    """Standard errors, noise and patterns of the errors. Rows are those of the fit."""

    equations: int = 2  # for each unknown, at the least
    low_pass_lags: int = 6  # rows over which the low-pass of the fit correlates white noise
    most_lags: int = 64  # rows: 25 periods of the fit's highest frequency, and more than one of the motion
    longest_memory: int = 60  # rows over which errors can be correlated
    pattern_lags: int = 12  # lags of the test for errors that follow each other
    blocks: int = (
        8  # of a recording, of a joint's travel and of its velocities, between which an estimate scatters
    )
    block_rows: int = 32  # fewest rows of such a block: many times the reach of the fit's low-pass
    fewest_blocks: int = 6  # that determine a scatter
    # of a recording, alternately fitted and validated, so that both have about the same motion
    validated_blocks: int = 10
    # of all rows, in each of which the logged current is compared with the control law
    compared_parts: int = 16
    law_current: float = 1e-4  # share of a current by which the control law may differ
    held_out: float = 0.3  # share of a recording, at its end, for validation
    leverage: float = 1.0  # largest that a fitted row can have; a larger one extrapolates
    bins: int = 12  # of a variable in which errors are averaged
    shuffles: int = 400  # of the errors, for the variation between bins by chance
    shuffled_rows: int = 12  # rows that stay together, since neighbouring errors correlate
    follows: float = 1.0  # strength of time as a variable where errors only follow each other
    # share of these blocks: impacts where they have most of the squared error; of noise they have a sixth
    impacts: float = 0.05
    # share of the noise's squares: where a fit has less, the noise is not white, and its floor unknown
    white: float = 0.8
    # of the fit's band: there a model's error is small, since motions are slower, and noise is alone
    noise_alone: tuple[float, float] = (0.5, 0.9)


@dataclass(frozen=True)
class MotionBounds:
    """Standstill, filters and what the motion of a recording shows."""

    slow: float = 0.01  # share of the RMS speed: a slower joint is at rest
    slow_start: float = 0.3  # share of the RMS speed: with a slower first sample a joint starts from rest
    first_way: float = 0.03  # share of the travel: before it, friction depends on how the joint came to rest
    # cut-off periods over which the position filter spreads a jump of acceleration, either way
    smeared: float = 0.5
    # cut-off periods around it that are compared; the noise in them is averaged as by the low-pass
    surroundings: float = 4.0
    stuck: float = 0.5  # share of the spread that a joint without a motor has to be slow, to count as stuck
    still_rows: float = 0.2  # share of a decimated row from standstill, above which it is excluded
    # share of a velocity's power in the band of the motion; the rest is noise or negligible
    band_power: float = 0.999
    samples_in_period: float = 10.0  # of the highest frequency of the motion
    # times the band of the motion that the twin follows; an instrument may lack the rest
    twin_band: float = 2.0
    turn: float = 1e-2  # rad, change of a hinge for a difference quotient
    slide: float = 1e-3  # m, change of a slide for a difference quotient
    rate_share: float = 0.1  # share of the RMS velocity or acceleration, for the same
    sparse_samples: int = 100  # fewest that remain; a shorter recording is not thinned
    centre: float = 0.3  # share of the robot's length: assumed distance of a payload's centre of mass
    gyration: float = 0.1  # share of the robot's length: assumed radius of gyration of a payload


@dataclass(frozen=True)
class MemoryBounds:
    """Sizes of joint computations and caches, and rows that suffice for a choice."""

    compressed_rows: int = 65_536  # rows that are compressed together
    samples: int = 5_120  # for which columns are formed together: they stay in the cache of the processor
    filtered_bytes: int = 2_000_000  # of columns that are filtered together
    motion_numbers: int = 8_000_000  # of a motion of all joints that is kept: 64 MB
    lasting_numbers: int = 2_000_000  # of a motion that is kept to the end: 16 MB
    # of forces in joints that are kept; more would be discarded before their next use
    force_bytes: int = 5_000_000
    fixed_bytes: int = 100_000_000  # of orthogonalised columns that are kept
    perturbation_bytes: int = 80_000_000  # of small changes that are kept
    # that are kept: of every joint of every recording, at all its samples and at few
    interpolations: int = 256
    set_bytes: int = 4_000_000  # of inner products of sets that are solved together
    rank_rows: int = 1_000  # of a recording, evenly spread: more do not change the rank
    screened_rows: int = 4_000  # for a first choice of terms: more do not change it
    screened_columns: int = 256  # of terms that are formed together
    screened_bytes: int = 20_000_000  # of the columns of terms at a motor that are kept


@dataclass(frozen=True)
class SearchBounds:
    """The search for effects of the catalogue. Numbers of sets, unless stated."""

    rounds: int = 6  # of proposals, choice and fit
    alike: int = 2  # like the present one, which are fitted where the best of the search is no better
    alone: int = 9  # effects on the shortlist for what they explain alone
    with_best: int = 7  # effects on the shortlist for what they explain with the best set
    # effects: up to this size all sets are compared; larger ones grow by one effect at a time
    exhaustive: int = 3
    largest: int = 6  # effects in a set
    changes: int = 6  # of a set
    starts: int = 4  # from which the search starts, apart from the empty one
    together_unknowns: float = 1.2  # ratio of the unknowns of sets that are solved together
    one_more: int = 2  # with one effect more than the answer that are fitted, the best supported first
    # of an effect that is too small to be named, over the standard error of what shows best of it
    random_sizes: tuple[float, float] = (0.03, 300.0)
    random_steps: int = 40  # sizes between them
    by_recording: int = 3  # of values by recording with which the search is repeated
    revealed: int = 2  # effects that are tried after others have changed their columns
    revealed_share: float = 0.1  # of the squared error, above which such an effect is tried
    smooth_unknowns: int = 3  # of a smooth function at a motor, at the least


@dataclass(frozen=True)
class LawBounds:
    """The search for laws outside the catalogue: numbers that are tried, and limits of the search."""

    exponents: tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 3.0)  # of a power
    # of a power that replaces several effects, at the start
    merged_exponents: tuple[float, ...] = (0.5, 1.5, 2.5)
    # of powers whose sum is within 0.2 % of one with any exponent from 0.2 to 3
    summed_exponents: tuple[float, ...] = (0.25, 0.5, 1.0, 2.0, 3.0)
    exponent_range: float = 0.5  # by which an exponent is adapted, either way
    durations: tuple[float, ...] = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0)  # s, time constants of what has a memory
    # s, of the longest log: in a shorter one no law of the time alone is looked for
    of_time: float = 11.0
    duration_factor: float = 2.0  # by which a time constant is adapted, either way
    # shares of a recording's duration: time constants of a decay
    decays: tuple[float, ...] = (0.05, 0.1, 0.2, 0.4, 0.8)
    # shares of the travel or of a recording: where a step is
    onsets: tuple[float, ...] = (0.2, 0.35, 0.5, 0.65, 0.8)
    harmonics: tuple[float, ...] = (1.0, 2.0, 3.0, 4.0, 6.0, 8.0)  # periods of a turn of a hinge
    waves: tuple[float, ...] = (0.5, 1.0, 1.5, 2.0, 3.0, 4.0)  # periods in the travel of a slide
    pulses: int = 2  # frequencies over time that are tried at every motor
    pulse_steps: int = 8  # of the search for them, for each period more in a recording
    power_unknowns: int = 2  # of a power
    knots: int = 8  # of a smooth function
    functions: int = 2  # smooth functions of a motor, added
    rounds: int = 4  # of proposals, choice and fit
    terms: int = 16  # that are added to the effects of the catalogue in a round
    starts: int = 12  # sets of terms from which the search starts
    kept: int = 6  # sets of terms that a step of the beam search keeps
    added: int = 5  # terms that are added to each of them
    depth: int = 3  # terms in a set
    models: int = 18  # that are tried to refine an answer
    # share of `DecisionRule.prior` by which a model may seem less probable before it is converged
    nearby: float = 0.5
    # times the best squared error: a model with more at its start is not converged
    start_error: float = 1.5**2
    merged_laws: int = 1000  # that could replace several effects: their number enters the prior


@dataclass(frozen=True)
class FindingBounds:
    """Bounds above which an answer doubts data, units, columns or names."""

    far_gain: float = 0.5  # share of the nominal gain: makers state gains within a tenth
    # factor to the nominal gain: a unit or a load is wrong, and laws are not sought
    unit_of_gain: float = 10.0
    alike_gains: float = 1.25  # factor between the largest and the smallest of gains that are off alike
    # factor to the nominal gains, by which all are off: a payload's mass is wrong, since makers are not so alike
    common_gain: float = 1.3
    near_thousand: float = 3.0  # factor to a thousand or a thousandth of the nominal gain: a unit is wrong
    thousand: float = 3.0  # decades between the currents of recordings with unlike units
    # from these, a factor of five: loads and speeds change the currents of all motors by less
    near_decades: float = 0.7
    explained: float = 0.5  # relative error: with a larger one a model does not explain the current
    large_error: float = 0.05  # relative error, above which swapped columns and other loads are tried
    wrong_position: float = (
        0.15  # the same with friction and nominal gains, above which other positions are tried
    )
    swapped_error: float = 0.5  # share of that error that may remain with other columns or another load
    other_motors: float = 1.05  # growth of the errors of the other motors that another load may cause
    # times the fitted error: recordings for validation have another machine, load or unit
    unlike: float = 3.0
    condition: float = 1e3  # of the scaled system: ill-conditioned
    rounding_condition: float = 1e7  # of the scaled system: digits of the data that are rounding decide
    parameter_std: float = 1e6  # SI units: no standard error of a parameter of a robot is as large
    widened: float = 10.0  # factor by which other effects increase a standard error
    # share of the largest part in a combination, above which a parameter belongs to it
    takes_part: float = 0.2
    repeated_rows: float = 1.2  # rows of different periods that count as one
    noise_power: float = 1e-4  # share of an acceleration's power: ten times what chosen filters pass
    loud_noise: float = 0.1  # share of an acceleration's power: noise that is always reported
    noise_moves: float = 2.0  # standard errors between two estimates, above which noise biases the answer
    noise_decides: float = 0.1  # share of a drive gain by which noise biases it: the answer is not credible
    # standard error in half of the band over that in all; none of 76 simulated five-bars is below 0.94
    half_band: float = 0.8
    # periods a turn, from a whole number: only more than fifty turns resolve less
    whole_periods: float = 0.02
    # share of a joint's travel: tolerances of lengths, which change its parameters as little
    closure_error: float = 1e-3
    disturbed: float = 0.05  # share of a recording at either end: more is not dropped without a request
    omitted_growth: float = 1.01  # growth of the error at which the essential parameters are reached
    bad_weight: float = 0.1  # weight of a row, below which it does not fit
    bad_rows: int = 5  # fewest in a stretch that does not fit
    bridged_rows: int = 3  # between two such stretches that count as one
    # times the noise floor: with a larger error the names of effects may be wrong
    remaining_noise: float = 10.0
    best_error: float = 0.01  # relative error of the best models of real machines, however low the noise
    gain_drift: float = 1e-3  # share of a drive gain by a kelvin: remanence of magnets of neodymium
    gain_change: float = 0.005  # share of a drive gain that is reported as a change


@dataclass(frozen=True)
class ReportBounds:
    """How much an answer lists."""

    stretches: int = 8  # that do not fit, the longest
    sets: int = 8  # of effects, the most probable
    set_probability: float = 0.01  # of such a set
    near_certain: float = 0.01  # distance of a probability from 0 or 1, below which no digits are shown
    motions: int = 3  # that are advised: those of an effect and of its nearest alternatives
    places: int = 3  # in a headline, besides the first
    width: int = 100  # letters in a line of generated code
    largest: float = 1e15  # number that is written out; a larger one has more digits than a float


@dataclass(frozen=True)
class Tolerances:
    """All bounds, by topic."""

    rank: RankBounds = field(default_factory=RankBounds)
    steps: StepBounds = field(default_factory=StepBounds)
    shapes: ShapeBounds = field(default_factory=ShapeBounds)
    robust: RobustBounds = field(default_factory=RobustBounds)
    statistics: StatisticsBounds = field(default_factory=StatisticsBounds)
    motion: MotionBounds = field(default_factory=MotionBounds)
    memory: MemoryBounds = field(default_factory=MemoryBounds)
    search: SearchBounds = field(default_factory=SearchBounds)
    laws: LawBounds = field(default_factory=LawBounds)
    findings: FindingBounds = field(default_factory=FindingBounds)
    report: ReportBounds = field(default_factory=ReportBounds)


_FORCE = InForce(Tolerances())
TOLERANCES = _FORCE.read
"""The bounds in force: the defaults, or what `bounded_by` was given."""
tolerances_in_force = _FORCE.value
bounded_by = _FORCE.during
