"""Models side by side, in a terminal."""

from collections.abc import Sequence

from rich.console import Console
from rich.text import Text

from bench.document.side_by_side import compared_errors_table, compared_gains_table
from bench.document.terminal.identification import section, sentences_list
from bench.document.terminal.tables import printed
from bench.residuals.side_by_side import SideBySide


def side_by_side_report(
    comparison: SideBySide, changed: Sequence[str], console: Console | None = None
) -> None:
    """Print errors and gains of every model, and what changed."""
    console = console or Console()
    console.print()
    console.print(
        Text.assemble((comparison.robot, "bold"), "  ", (f"{len(comparison.models)} models", "dim"))
    )
    section(
        console,
        "Error of the modelled current, RMS(error) / RMS(measured)",
        printed(compared_errors_table(comparison), console.width),
    )
    section(console, "Drive gains [95 % intervals]", printed(compared_gains_table(comparison), console.width))
    section(console, "What changed", sentences_list(changed))
    console.print()
