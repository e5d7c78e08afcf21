"""`bench sweep`, `table`, `plot` and `check`: many scenarios, their table, summaries, plots, and accuracy."""

from pathlib import Path

import click

from bench.basics.plural import plural
from bench.cli.last_lines import next_line, say, wrote
from bench.cli.options import path_option, scheduler_option, sweeps, workers_option
from bench.cli.progress import quiet_option, shown_progress


@click.command("sweep")
@click.argument("sweep_file", metavar="FILE", shell_complete=sweeps)
@path_option("-o", "--output", metavar="DIR", help="Folder of the results.")
@workers_option
@scheduler_option
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
        from bench.studies.sweep.pool import Workers

    pool = Workers(workers, scheduler)
    code = run_command(
        sweep_file, output, workers=pool, retry_failed=retry_failed, dry_run=dry_run, quiet=quiet
    )
    if output is not None and not dry_run:
        with shown_progress(quiet, "drawing the page"):
            from bench.page.write import REPORT_FILE
            from bench.page.write_studies import write_sweep_report

            page = write_sweep_report(output, output / REPORT_FILE)
        say([wrote(page, "report"), next_line(["table", output], "summarises it by axis")])
    return code


@click.command("plot")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--x", "x", required=True, metavar="AXIS", help="Axis of the abscissa.")
@click.option("--y", "y", required=True, metavar="METRIC", help="Metric to plot: median and middle 90 %.")
@click.option("--lines", metavar="AXIS", help="A line for each value of this axis.")
@click.option("--log/--linear", "logarithmic", default=None, help="Axis of METRIC. [default: by its range]")
@path_option(
    "-o",
    "--output",
    metavar="FILE",
    help="An .svg, .png or .pdf file. [default: named after the axes, in DIR]",
)
def plot(
    folder: Path, x: str, y: str, lines: str | None, logarithmic: bool | None, output: Path | None
) -> None:
    """Draw a metric of a sweep against an axis.

    DIR is the folder of a sweep.
    """
    from bench.studies.sweep.plot import plot_sweep
    from bench.studies.sweep.rerun_runs import is_sweep_folder
    from bench.studies.sweep.results import plot_name, table_in

    table = table_in(folder)
    path = output or table.with_name(plot_name(x, y, lines))
    plot_sweep(table, path, x, y, lines, logarithmic=logarithmic)
    seen = next_line(["view", folder], "shows a good, a median and a bad run in motion")
    say([wrote(path, "figure"), *([seen] if is_sweep_folder(folder) else [])])


@click.command("table")
@click.argument("folder", metavar="DIR", type=click.Path(path_type=Path))
@click.option("--by", "axes", multiple=True, metavar="AXIS", help="One row per value. Repeat for more axes.")
@click.option(
    "--show",
    "metrics",
    multiple=True,
    metavar="METRIC",
    help="Metric to summarise. Repeat for more. [default: gain_error]",
)
def table(folder: Path, axes: tuple[str, ...], metrics: tuple[str, ...]) -> None:
    """Summarise the runs of a sweep by axis.

    DIR is the folder of a sweep. Prints median and spread, and writes them to the folder as Markdown. Every
    column of the table can be an axis, and every column of numbers a metric.
    """
    from bench.cli.next_steps import after_table
    from bench.studies.sweep.results import pooled_axes, table_in, write_table_summary
    from bench.studies.sweep.summary import print_summary, table_console

    runs = table_in(folder)
    metrics = metrics or ("gain_error",)
    summary, path = write_table_summary(runs, axes, metrics)
    print_summary(summary, table_console())
    pooled = pooled_axes(runs, axes)
    values = ", ".join(f"{name} ({plural(count, 'value')})" for name, count in pooled.items())
    messages = [f"values of {values} are pooled; --by separates them"] if pooled else []
    say([*messages, wrote(path, "summary"), after_table(folder, axes, metrics, tuple(pooled))])


@click.command("check")
@click.option("--full", is_flag=True, help="All seeds of all reference scenarios, instead of the quick set.")
@click.option("--update", is_flag=True, help="Make the results the new reference; runs all seeds.")
@click.option("--reason", metavar="TEXT", help="Why the reference changes; stored in it.")
@click.option("--only", multiple=True, metavar="NAME", help="Only this reference scenario. Repeat for more.")
@click.option("--workers", type=click.IntRange(1, 256), metavar="N", help="Processes. [default: one a core]")
@path_option("--reference", metavar="DIR", help="Folder. [default: results/reference]")
@path_option("--scenarios", metavar="DIR", help="Folder. [default: scenarios/reference]")
@click.option("-v", "--verbose", is_flag=True, help="Print every figure, not only the changed ones.")
def check(
    full: bool,
    update: bool,
    reason: str | None,
    only: tuple[str, ...],
    workers: int | None,
    reference: Path | None,
    scenarios: Path | None,
    verbose: bool,
) -> int:
    """Compare the accuracy with the reference; fail if it is worse.

    Runs the reference scenarios and compares gains, parameters, errors, coverage and diagnosis with
    results/reference, seed by seed; then cases that were right in results/trust. The exit code is 1 if anything got
    worse by more than its tolerance.
    """
    from bench.basics.errors import BenchError

    if update and not (reason or "").strip():
        raise BenchError("check --update: give the reason for the change with --reason")

    from bench.studies.sweep.check import CheckOptions, check_accuracy, update_reference
    from bench.studies.sweep.reference import reference_folder
    from bench.studies.sweep.summary import table_console
    from bench.studies.sweep.work import identification_work

    options = CheckOptions(
        reference=reference or reference_folder(),
        full=full or update,
        only=only,
        scenarios=scenarios,
        workers=workers,
        verbose=verbose,
    )
    if not update:
        worse = check_accuracy(options, table_console(), identification_work)
        everything = not only and reference is None and scenarios is None
        return max(worse, _kept_cases(workers)) if everything else worse
    update_reference(options, reason or "", table_console(), identification_work)
    return 0


def _kept_cases(workers: int | None) -> int:
    """1 if a case of the evaluation that was correct is now wrong, else 0."""
    from bench.benchmarks.trust.kept_cases import check_kept_cases
    from bench.benchmarks.trust.run import TABLE
    from bench.studies.sweep.pool import Workers
    from bench.studies.sweep.reference import reference_folder
    from bench.studies.sweep.summary import table_console

    with Workers(workers, None).pool() as pool:
        return min(check_kept_cases(reference_folder().parent / "trust" / TABLE, pool, table_console()), 1)
