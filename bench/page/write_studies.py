"""Write the page of a sweep or of a trial."""

from pathlib import Path

from bench.basics.shell_word import quoted
from bench.page.sweep_page import read_sweep, sweep_page
from bench.page.trial_page import again_line, read_trial, trial_page
from bench.page.write import write_page
from bench.studies.sweep.run_sweep import FILE


def write_sweep_report(folder: Path, output: Path) -> Path:
    """Write the page of the sweep in a folder. Raises BenchError if it is incomplete or cannot be read."""
    sweep = read_sweep(folder)
    again = [f"bench sweep {quoted(folder / FILE)} -o {quoted(folder)}"]
    return write_page(
        output, sweep_page(sweep, [*again, f"bench report {quoted(folder)} -o {quoted(output)}"])
    )


def write_trial_report(table: Path, output: Path) -> Path:
    """Write the page of a trial from its table. Raises BenchError if it cannot be read."""
    trial = read_trial(table)
    again = [again_line(trial), f"bench report {quoted(table)} -o {quoted(output)}"]
    return write_page(output, trial_page(trial, again))
