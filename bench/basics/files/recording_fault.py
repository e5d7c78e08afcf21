"""A fault of a recording as an error that says, for programs, what mends it."""

from collections.abc import Mapping
from enum import Enum, auto

from bench.basics.errors import BenchError


class Remedy(Enum):
    """What mends a fault; which words that takes depends on where the recording comes from."""

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
    LEAVE_ROWS_OUT = auto()  # rows without a measurement, amid others
    REMOVE_ROWS = auto()  # such rows at the end, or without a time
    OTHER_COLUMN = auto()  # this one has no measurement
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
"""Which columns a log has in which unit, where a check takes them for that."""


class RecordingFaultError(BenchError):
    """What is wrong with a recording, reported as for a file of a dataset.

    said: what is wrong and where; advice: what helps in a dataset, with the punctuation before it. remedy: the same as
    a code, None where there is none. check: the name by which the check that found it is switched off. column: where
    it is. others: all other faults of the recording, of which the message names the columns.
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
        """The same fault as the first of several."""
        return RecordingFaultError(
            self.said, self.advice, self.remedy, self.check, column=self.column, others=others
        )
