"""Which dataset a row of a trial is of: no two rows are of one."""

from collections.abc import Sequence

from bench.basics.errors import BenchError
from bench.studies.sweep.journal import Row

ALL = "all effects"


def check_numbers(rows: Sequence[Row]) -> None:
    """Raise BenchError where two rows have one number among the datasets of their kind, drawn from the same effects.

    A number means another dataset where others are drawn from, as with `--effects`. Older rows do not say which: all.
    """
    taken: set[tuple[str, str, int]] = set()
    for row in rows:
        drawn_from = row.get("drawn_from") or ""
        number = row["kind"], drawn_from, row["run"]
        if number in taken:
            raise BenchError(
                f"trial: two rows of kind {row['kind']!r}, drawn from {drawn_from or ALL}, have the number "
                f"{row['run']}: they are of two trials, which a table cannot distinguish"
            )
        taken.add(number)
