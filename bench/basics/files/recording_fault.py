"""A fault of a recording as an error with a code for its cure."""

from collections.abc import Mapping
from enum import Enum, auto

from bench.basics.errors import BenchError


class Remedy(Enum):
    """The cure for a fault, as a code; its wording depends on the source of the recording."""

    FROM_DEGREES = auto()  # the column is in that unit
    FROM_MILLIRADIANS = auto()
    FROM_MILLIMETRES = auto()
    FROM_CENTIMETRES = auto()
    FROM_MICROMETRES = auto()
    FROM_MILLISECONDS = auto()
    FROM_MICROSECONDS = auto()
    FROM_NANOSECONDS = auto()
    FROM_LONGER_UNIT = auto()
    FROM_THOUSANDTHS = auto()
    LEAVE_ROWS_OUT = auto()  # rows without a measurement between others
    REMOVE_ROWS = auto()  # such rows at the end, or without a time
    OTHER_COLUMN = auto()  # the column has no measurement
    CUT_AT_GAPS = auto()  # samples were lost
    CUT_WHERE_BACK = auto()  # time does not rise there


IN_UNIT: Mapping[Remedy, tuple[str, str]] = {
    Remedy.FROM_DEGREES: ("position", "deg"),
    Remedy.FROM_MILLIRADIANS: ("position", "mrad"),
    Remedy.FROM_MILLIMETRES: ("position", "mm"),
    Remedy.FROM_CENTIMETRES: ("position", "cm"),
    Remedy.FROM_MICROMETRES: ("position", "um"),
    Remedy.FROM_MILLISECONDS: ("time", "ms"),
    Remedy.FROM_MICROSECONDS: ("time", "us"),
    Remedy.FROM_NANOSECONDS: ("time", "ns"),
    Remedy.FROM_THOUSANDTHS: ("current", "mA"),
}
"""Remedy -> group of columns, and the unit that they appear to be in."""


class RecordingFaultError(BenchError):
    """A fault of a recording, worded as for a file of a dataset.

    said: the fault and its place; advice: the cure in a dataset, with the preceding punctuation. remedy: the cure as
    a code, or None. check: name of the check, with which it can be accepted. column: the faulty column. others: all
    other faults of the recording; the message names their columns.
    """

    column: str

    def __init__(
        self,
        said: str,
        advice: str = "",
        remedy: Remedy | None = None,
        check: str | None = None,
        *,
        column: str = "",
        others: tuple["RecordingFaultError", ...] = (),
    ) -> None:
        elsewhere = sorted({other.column for other in others} - {column})
        more = f"; more in {', '.join(elsewhere)}" if elsewhere else ""
        super().__init__(f"{said}{more}{advice}")
        self.said, self.advice, self.remedy, self.check = said, advice, remedy, check
        self.column, self.others = column, others

    def among(self, others: tuple["RecordingFaultError", ...]) -> "RecordingFaultError":
        """The same fault with the other faults of its recording."""
        return RecordingFaultError(
            self.said, self.advice, self.remedy, self.check, column=self.column, others=others
        )
