"""The figures of a trial, and their bounds."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from math import inf, isfinite
from typing import Self, TypeVar

import numpy as np

from bench.basics.chi_squared import WITHIN_95

Case = TypeVar("Case")
FLOOR_FACTOR = 1.15
GAIN_FACTOR = 1.5
LAW_FACTOR = 1.5


class Attained(Enum):
    """Whether a bound is certainly kept, in words."""

    YES = "yes"
    NO = "no"
    TOO_FEW = "too few cases"


class TargetFigure(Enum):
    """A figure of a trial, in words. main: a main figure; the others follow one and add details to it.

    relative: a deviation relative to the true value, not a share of cases.
    """

    words: str
    main: bool
    relative: bool

    ONE_FIRST = "one hidden effect: named first", True
    ONE_UNDECIDED = "or openly undecided"
    TWO_EXACT = "two hidden effects: the set exactly", True
    TWO_UNDECIDED = "or openly undecided"  # noqa: PIE796 - distinct by __new__
    THREE_EXACT = "three: the set exactly", True
    THREE_UNDECIDED = "or openly undecided"  # noqa: PIE796 - distinct by __new__
    PLACES = "named effects at motors: at exactly the motors that have them", True
    ALARM = "nothing hidden: any alarm", True
    ALARM_NAMED = "an effect named"
    OUTSIDE_HONEST = "outside the catalogue: a law or unexplained, no wrong name", True
    OUTSIDE_UNEXPLAINED = "unexplained"
    OUTSIDE_LAW = f"a law, and with it an error not fitted of at most {LAW_FACTOR} × the noise floor"
    OUTSIDE_NO_WRONG_NAME = "no wrong name with the verdict `missing`"
    GAIN_ERROR_MEDIANS = (
        "gain errors with the identified effects, relative to those with the true effects: medians",
        True,
    )
    GAIN_ERROR_RMS = "root mean squares"
    GAIN_ERROR_WITHIN = f"within {GAIN_FACTOR} of it"
    GAIN_ERROR_BEFORE = "largest gain error, root mean square: before", False, True
    GAIN_ERROR_AFTER = "after", False, True
    GAIN_ERROR_TOLD = "with the true effects", False, True
    FLOOR_MEDIAN = "error not fitted after the ladder, over the noise floor: median", True
    FLOOR_WITHIN = f"at most {FLOOR_FACTOR}"
    FLOOR_WITHIN_TOLD = "the same for a model with the true effects"
    INTERVALS = "effect parameters: 95 % intervals that contain the truth", True
    UNKNOWN_LAW = "a law in no catalogue: error not fitted at the noise floor, no wrong name"
    GAINS_HELD = "drive gains: 95 % intervals that contain the truth"
    STABLE_NOISE = "certain verdicts that stay with a quarter of the noise added"
    STABLE_LOG = "certain verdicts that stay without the last log"

    def __new__(cls, words: str, main: bool = False, relative: bool = False) -> Self:
        """Number the members, so that those with the same words are distinct."""
        member = object.__new__(cls)
        member._value_, member.words = len(cls.__members__), words
        member.main, member.relative = main, relative
        return member


@dataclass(frozen=True)
class Share:
    """A share of cases, with a 95 % interval (Wilson 1927)."""

    count: int
    of: int

    @property
    def value(self) -> float:
        """The share; nan without cases."""
        return self.count / self.of if self.of else float("nan")

    @property
    def interval(self) -> tuple[float, float]:
        """Lower and upper bound."""
        if not self.of:
            return 0.0, 1.0
        n, p, z = self.of, self.value, WITHIN_95
        middle = (p + z * z / (2 * n)) / (1 + z * z / n)
        half = z * np.sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
        return float(max(middle - half, 0.0)), float(min(middle + half, 1.0))


def ends_of(shares: Iterable[Share]) -> np.ndarray:
    """Values of shares and the ends of their intervals (3, n)."""
    return np.array([(share.value, *share.interval) for share in shares]).reshape(-1, 3).T


def share_of(rows: Iterable[Case], test: Callable[[Case], object]) -> Share:
    """The share of cases that pass a test."""
    passed = [bool(test(row)) for row in rows]
    return Share(sum(passed), len(passed))


@dataclass(frozen=True)
class Target:
    """A figure with its bounds; `share` if it is a share of cases."""

    figure: TargetFigure
    value: float
    least: float | None
    most: float | None
    share: Share | None = None

    @property
    def bounds(self) -> tuple[float, float]:
        """`least` and `most`, infinite where there is none."""
        return (-inf if self.least is None else self.least), (inf if self.most is None else self.most)

    @property
    def reached(self) -> bool | None:
        """Whether the value is within its bounds; None without cases."""
        least, most = self.bounds
        return least <= self.value <= most if isfinite(self.value) else None

    @property
    def kept(self) -> Attained | None:
        """Whether the bound is kept, if there are enough cases to say so; None without a bound or without cases.

        There are enough if they could show it with all of them successful; of two bounds, with so narrow an interval.
        """
        if self.reached is None or (self.least is None and self.most is None):
            return None
        if self.share is None:
            return Attained.YES if self.reached else Attained.NO
        least, most = self.bounds
        low, high = self.share.interval
        if not self.reached:
            return Attained.NO if high < least or low > most else Attained.TOO_FEW
        if self.least is not None and self.most is not None:
            enough = high - low <= most - least
        else:
            of = self.share.of
            enough = Share(of, of).interval[0] >= least and Share(0, of).interval[1] <= most
        return Attained.YES if enough else Attained.TOO_FEW
