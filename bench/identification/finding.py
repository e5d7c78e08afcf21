"""What limits an answer, as codes with their numbers; `bench.identification.finding_words` has the sentences."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from enum import StrEnum, auto
from typing import Literal


class Code(StrEnum):
    """What is noted about an answer."""

    # the whole answer is in doubt
    GAIN_NOT_DETERMINED = auto()
    GAIN_RUNAWAY = auto()
    PARAMETER_WITHOUT_DEVIATION = auto()
    ROUNDING_DECIDES = auto()
    NOISE_DECIDES = auto()
    UNITS_UNLIKE = auto()
    TIME_BASE = auto()
    COLUMNS_SWAPPED = auto()
    CURRENT_REVERSED = auto()
    POSITION_REVERSED = auto()
    POSITIONS_SWAPPED = auto()
    OTHER_LOAD = auto()
    LOADS_EXCHANGED = auto()
    LOAD_UNDECLARED = auto()
    PAYLOAD_HEAVY = auto()
    NOT_REAL = auto()
    # what the data do not determine
    NOT_FROM_GAIN = auto()
    NOISE_LET_THROUGH = auto()
    PAYLOAD_NOT_DECLARED = auto()
    GAINS_NOMINAL = auto()
    GAINS_NOT_WANTED = auto()
    PAYLOAD_NOT_WEIGHED = auto()
    GAINS_NOT_FIXED = auto()
    GAINS_FIXED_FOR_SOME = auto()
    REDUNDANT = auto()
    LOCKED = auto()
    RANK_DEFICIENT = auto()
    ILL_CONDITIONED = auto()
    TAKEN_UP = auto()
    HARDLY_APART = auto()
    NOT_SETTLED = auto()
    PERIODS_NOT_WHOLE = auto()
    ROWS_REPEATED = auto()
    BAND_NARROWED = auto()
    BAND_MATTERS = auto()
    BAND_UNCHECKED = auto()
    EXTRAPOLATED = auto()
    JUDGED_BEYOND = auto()
    # what is impossible
    GAINS_A_THOUSAND = auto()
    GAINS_A_THOUSANDTH = auto()
    GAINS_ALIKE = auto()
    NO_MODEL_IS_BETTER = auto()
    SIGN_REVERSED = auto()
    GAIN_NEGATIVE = auto()
    GAIN_FAR = auto()
    GAINS_NEGATIVE = auto()
    CLOSURE_CONTRADICTED = auto()
    VELOCITY_UNLIKE = auto()
    CHECKED_UNLIKE_FITTED = auto()
    CHECKED_HAS_OTHER_VALUES = auto()
    MOUNTED_OTHERWISE = auto()
    PAYLOAD_IMPOSSIBLE = auto()
    PAYLOAD_TAKEN_AS_POINT = auto()
    GAINS_ASSUMED_EQUAL = auto()
    # what was asked for
    PHYSICAL = auto()
    VELOCITY_TAKEN = auto()
    # what to record or leave out
    STANDS_STILL = auto()
    NEVER_REVERSES = auto()
    POORLY_DETERMINED = auto()
    SHORT = auto()
    BAD_STRETCH = auto()
    NO_VALUE_OF_ITS_OWN = auto()
    # a sentence in a model file of an earlier version
    TOLD = auto()


@dataclass(frozen=True)
class Unknown:
    """An unknown, or a row of a covariance. place: the joint of a gain, or the place of an effect."""

    kind: Literal["parameter", "gain", "effect"]
    name: str
    place: str = ""
    effect: str = ""


@dataclass(frozen=True)
class Finding:
    """One finding. names: of joints, recordings or payloads; of: unknowns; numbers: by name; unit: of the values."""

    code: Code
    names: tuple[str, ...] = ()
    of: tuple[Unknown, ...] = ()
    numbers: Mapping[str, float] = field(default_factory=dict)
    unit: str = ""


NEGATIVE = frozenset({Code.GAINS_NEGATIVE, Code.GAIN_NEGATIVE, Code.SIGN_REVERSED})
"""Of a gain with an impossible sign."""

UNBELIEVABLE = NEGATIVE | frozenset(
    {
        Code.GAIN_NOT_DETERMINED,
        Code.GAIN_RUNAWAY,
        Code.PARAMETER_WITHOUT_DEVIATION,
        Code.ROUNDING_DECIDES,
        Code.NOISE_DECIDES,
        Code.GAINS_A_THOUSAND,
        Code.GAINS_A_THOUSANDTH,
    }
)
"""Of an answer that is not credible."""

CAUSES = frozenset(
    {
        Code.UNITS_UNLIKE,
        Code.TIME_BASE,
        Code.COLUMNS_SWAPPED,
        Code.CURRENT_REVERSED,
        Code.POSITION_REVERSED,
        Code.POSITIONS_SWAPPED,
        Code.OTHER_LOAD,
        Code.LOADS_EXCHANGED,
        Code.LOAD_UNDECLARED,
        Code.PAYLOAD_HEAVY,
        Code.CLOSURE_CONTRADICTED,
        Code.MOUNTED_OTHERWISE,
    }
)
"""Errors of the data or the robot that make a diagnosis name false effects."""

WRONG_DATA = frozenset(
    {Code.CURRENT_REVERSED, Code.POSITION_REVERSED, Code.POSITIONS_SWAPPED, Code.LOADS_EXCHANGED}
)
"""Of columns and loads that make every statement of a diagnosis wrong."""

BY_MISSING_EFFECTS = frozenset(
    {Code.GAIN_NOT_DETERMINED, Code.GAIN_RUNAWAY, Code.GAIN_NEGATIVE, Code.PARAMETER_WITHOUT_DEVIATION}
)
"""Of an answer that is not credible, but becomes right with the effects that the model lacks."""

MEND_FIRST = UNBELIEVABLE | CAUSES | {Code.NO_MODEL_IS_BETTER, Code.GAINS_ALIKE}
"""Faults to correct before anything else is done with the data."""


def mended_first(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """The findings in their order, but faults to correct first."""
    return tuple(sorted(findings, key=lambda finding: finding.code not in MEND_FIRST))


def to_mend(findings: Iterable[Finding], *, error_left: bool) -> bool:
    """Whether to correct something before a diagnosis, which helps if effects explain a remaining error."""
    codes = {finding.code for finding in findings} & MEND_FIRST
    return bool(codes - BY_MISSING_EFFECTS if error_left else codes)
