"""`bench sweep`: many scenarios, one table."""

from pathlib import Path

import click

from bench.cli.completion import sweeps
from bench.cli.last_lines import next_line, say, wrote
from bench.cli.progress import quiet_option, shown_progress


@click.command("sweep")
@click.argument("sweep_file", metavar="FILE", shell_complete=sweeps)
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Folder of the results.")
@click.option(
    "--workers",
    type=click.IntRange(1, 256),
    metavar="N",
    help="Processes on this machine. [default: one a core]",
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="A Dask scheduler, for example tcp://HOST:8786, instead of local processes.",
)
@click.option("--retry-failed", is_flag=True, help="Repeat failed runs.")
@click.option("--dry-run", is_flag=True, help="Check the file, estimate the work, and stop.")
@quiet_option
def sweep(
    sweep_file: str,
    output: Path | None,
    workers: int | None,
    scheduler: str | None,
    retry_failed: bool,
    dry_run: bool,
    quiet: bool,
) -> int:
    """Run a sweep of scenarios: noise, gains, payloads, estimators.

    FILE is a sweep file or the name of a built-in sweep. Finished runs are kept in DIR: if the sweep is
    interrupted and started again on the same folder, it resumes.
    """
    from bench.basics.errors import BenchError

    if output is None and not dry_run:
        raise BenchError("sweep: give the folder of the results with -o DIR")

    with shown_progress(quiet):
        from bench.studies.sweep.command import run_command
        from bench.studies.sweep.workers import Workers

    code = run_command(
        sweep_file,
        output,
        workers=Workers(workers, scheduler),
        retry_failed=retry_failed,
        dry_run=dry_run,
        quiet=quiet,
    )
    if output is not None and not dry_run:
        with shown_progress(quiet, "drawing the page"):
            from bench.page.write import REPORT_FILE
            from bench.page.write_studies import write_sweep_report

            page = write_sweep_report(output, output / REPORT_FILE)
        say([wrote(page, "report"), next_line(["table", output], "summarises it by axis")])
    return code
