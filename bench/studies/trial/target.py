"""The figures of a trial, and what they must reach."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum, StrEnum, auto

import numpy as np

from bench.basics.chi_squared import WITHIN_95


class Attained(Enum):
    """Whether what must be reached is surely reached; `bench.studies.trial.markdown` has the words."""

    YES = auto()
    NO = auto()
    TOO_FEW = auto()


class TargetFigure(StrEnum):
    """What a trial measures; `bench.studies.trial.markdown` has the words."""

    ONE_FIRST = auto()
    ONE_UNDECIDED = auto()
    TWO_EXACT = auto()
    TWO_UNDECIDED = auto()
    THREE_EXACT = auto()
    THREE_UNDECIDED = auto()
    PLACES = auto()
    ALARM = auto()
    ALARM_NAMED = auto()
    OUTSIDE_HONEST = auto()
    OUTSIDE_UNEXPLAINED = auto()
    OUTSIDE_LAW = auto()
    OUTSIDE_NO_WRONG_NAME = auto()
    GAIN_ERROR_MEDIANS = auto()
    GAIN_ERROR_RMS = auto()
    GAIN_ERROR_WITHIN = auto()
    GAIN_ERROR_BEFORE = auto()
    GAIN_ERROR_AFTER = auto()
    GAIN_ERROR_TOLD = auto()
    FLOOR_MEDIAN = auto()
    FLOOR_WITHIN = auto()
    FLOOR_WITHIN_TOLD = auto()
    INTERVALS = auto()
    UNKNOWN_LAW = auto()
    GAINS_HELD = auto()
    STABLE_NOISE = auto()
    STABLE_LOG = auto()


@dataclass(frozen=True)
class Share:
    """Some of some, with a 95 % interval (Wilson 1927)."""

    count: int
    of: int

    @property
    def value(self) -> float:
        """The share; nan of nothing."""
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


@dataclass(frozen=True)
class Target:
    """A figure with what it must reach; `share` where it is one."""

    figure: TargetFigure
    value: float
    least: float | None
    most: float | None
    share: Share | None = None

    @property
    def reached(self) -> bool | None:
        """Whether it was reached; None where nothing was tried."""
        if not np.isfinite(self.value):
            return None
        return (self.least is None or self.value >= self.least) and (
            self.most is None or self.value <= self.most
        )

    @property
    def kept(self) -> Attained | None:
        """Whether it is where the cases are enough to say so; None without a bound or any case."""
        if self.reached is None or (self.least is None and self.most is None):
            return None
        if self.share is None:
            return Attained.YES if self.reached else Attained.NO
        low, high = self.share.interval
        if not self.reached:
            outside = (self.least is not None and high < self.least) or (
                self.most is not None and low > self.most
            )
            return Attained.NO if outside else Attained.TOO_FEW
        return Attained.YES if self._enough(self.share) else Attained.TOO_FEW

    def _enough(self, share: Share) -> bool:
        """Whether so many cases can show that the bound is kept: if all were as they should be."""
        if self.least is not None and self.most is not None:
            low, high = share.interval
            return high - low <= self.most - self.least
        if self.least is not None:
            return Share(share.of, share.of).interval[0] >= self.least
        return self.most is None or Share(0, share.of).interval[1] <= self.most
