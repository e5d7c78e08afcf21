"""Where tables of figures are printed: the terminal, or a file or a log wide enough for them."""

from __future__ import annotations

import os

from rich.console import Console

WIDE = 132  # columns where nobody's terminal sets a limit


def table_console() -> Console:
    """The standard output: as wide as its terminal, or as $COLUMNS says, or `WIDE` for a file or a log."""
    console = Console()
    if console.is_terminal or os.environ.get("COLUMNS", "").isdecimal():
        return console
    return Console(width=WIDE)
