"""Dates and times of day in a log, converted to seconds from the first."""

import re
from collections.abc import Iterable
from datetime import date

import numpy as np
import numpy.typing as npt

DAY = 86400.0  # s
CLOCK = re.compile(
    r"(?:(?:(?P<year>\d{4})[-/.](?P<month>\d\d?)[-/.](?P<day>\d\d?)|(?P<d>\d\d?)\.(?P<m>\d\d?)\.(?P<y>\d{4}))[T ]+)?"
    r"(?P<hours>\d\d?):(?P<minutes>\d\d):(?P<seconds>\d\d(?:[.,]\d+)?)(?:Z| ?[+-]\d\d:?\d\d)?"
)


def seconds_from_first(cells: Iterable[str]) -> npt.NDArray[np.float64] | None:
    """The times (N,) in cells such as 2026-11-20T09:14:05.25Z, 20.11.2026 09:14:05,25 or 09:14:05.25, in s from the
    first; None if a cell is no time. Where the time of day falls by more than half a day, a new day begins.
    """
    days, times = [], []
    for cell in cells:
        match = CLOCK.fullmatch(cell)
        day = None if match is None else _day(match)
        if match is None or day is None:
            return None
        days.append(day)
        times.append(_seconds(match))
    if not times:
        return None
    of_day = np.array(times)
    if not any(days):
        days = np.cumsum(np.append(0, np.diff(of_day) < -0.5 * DAY)).tolist()
    return np.array(days, dtype=np.float64) * DAY - days[0] * DAY + of_day - of_day[0]


def _day(match: re.Match[str]) -> int | None:
    """The ordinal of a day, 0 if a cell has no date; None for a date that does not exist."""
    year, month, day = match["year"] or match["y"], match["month"] or match["m"], match["day"] or match["d"]
    if year is None:
        return 0
    try:
        return date(int(year), int(month), int(day)).toordinal()
    except ValueError:
        return None


def _seconds(match: re.Match[str]) -> float:
    hours, minutes, seconds = match["hours"], match["minutes"], match["seconds"].replace(",", ".")
    return 3600.0 * int(hours) + 60.0 * int(minutes) + float(seconds)
