"""Numerical bounds of identification and diagnosis, in one value: `TOLERANCES`.

What decides between models is in `bench.identification.decision`.
"""

from dataclasses import dataclass, field


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
    ridge_of_sets: float = 1e-13  # added to a unit diagonal, so that one dependent set does not stop all
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
    halvings: int = 8  # of a step; after them a set is solved alone
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
    expansion: float = 5.0  # times its nodes: range in which a column of an effect is taken as linear


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
class Tolerances:
    """All bounds, by topic."""

    rank: RankBounds = field(default_factory=RankBounds)
    steps: StepBounds = field(default_factory=StepBounds)
    shapes: ShapeBounds = field(default_factory=ShapeBounds)
    robust: RobustBounds = field(default_factory=RobustBounds)


TOLERANCES = Tolerances()
