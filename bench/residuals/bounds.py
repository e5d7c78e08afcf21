"""Thresholds for naming patterns of errors. Those that also decide in diagnosis are in the decision rule."""

from dataclasses import dataclass


@dataclass(frozen=True)
class NamingBounds:
    """Least strength to be named; shares of the squared error, unless stated."""

    chance: float = 1e-6  # probability of so strong a line or dependence by chance
    regions_nats: float = 14.0  # against chance for all regions together: odds of a million to one
    region_nats: float = 0.05  # a row; 33 % of the squared error in 20 % of the time is just more
    regions: int = 2  # named for one motor
    dependence: float = 0.2  # of the best variable
    # share of the best variable's: a direction or a constant with as much is preferred to it
    as_good: float = 0.95
    variables: int = 2  # named for one motor
    line: float = 0.15  # of a line
    # share of the error's: a line so strong in the current itself comes from the motion
    line_of_motion: float = 0.25
    drift: float = 0.2  # of the RMS error: smaller changes are not named
    drift_deviations: float = 6.0  # standard errors by which two means must differ
    unasked: float = 3.0  # times the noise: reported without request


@dataclass(frozen=True)
class ErrorGridBounds:
    """Rows, bins and frequencies in which errors are examined."""

    rows: int = 20  # in which a motor moves, for a recording to count
    swift: int = 3  # rows excluded between two directions: more is a standstill, not a reversal
    near_reversal: float = 1.5  # rows on either side of a reversal that belong to it
    around_reversal: int = 8  # rows before and after a reversal that are drawn
    fifth: float = 0.2  # share of a recording, or of a range
    third: float = 1.0 / 3.0  # of a recording: its start, and its end
    cycles: float = 3.0  # in the record or in the travel: fewer are a trend, not a line
    frequencies: int = 400  # at most
    oversampling: int = 2  # frequencies for each line that can be resolved
    finer: int = 41  # frequencies between a line's neighbours on the grid
    segment: int = 256  # rows


NAMING = NamingBounds()
ERROR_GRID = ErrorGridBounds()
