"""Names in one cell of a trial's table: written and read by this module alone."""

from collections.abc import Iterable

BETWEEN = " + "


def cell_of(names: Iterable[str]) -> str:
    """Names as a text; none as an empty one."""
    return BETWEEN.join(names)


def names_in(cell: str) -> tuple[str, ...]:
    """The names of such a text."""
    return tuple(cell.split(BETWEEN)) if cell else ()
