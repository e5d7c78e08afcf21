"""`bench check`: has the accuracy changed?"""

from pathlib import Path

import click


@click.command("check")
@click.option("--full", is_flag=True, help="All seeds of all reference scenarios, instead of the quick set.")
@click.option("--update", is_flag=True, help="Make the results the new reference; runs all seeds.")
@click.option("--reason", metavar="TEXT", help="Why the reference changes; stored in it.")
@click.option("--only", multiple=True, metavar="NAME", help="Only this reference scenario. Repeat for more.")
@click.option("--workers", type=click.IntRange(1, 256), metavar="N", help="Processes. [default: one a core]")
@click.option(
    "--reference", type=click.Path(path_type=Path), metavar="DIR", help="Folder. [default: results/reference]"
)
@click.option(
    "--scenarios",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Folder. [default: scenarios/reference]",
)
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
    results/reference, seed by seed; then cases that were right in results/trust. The exit
    code is 1 if anything got worse by more than its tolerance.
    """
    from bench.basics.errors import BenchError

    if update and not (reason or "").strip():
        raise BenchError("check --update: give the reason for the change with --reason")

    from bench.studies.sweep.check import CheckOptions, check_accuracy, identification_work, update_reference
    from bench.studies.sweep.console import table_console
    from bench.studies.sweep.reference import reference_folder

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
    """1 if a case of the evaluation that was right is wrong now."""
    from bench.benchmarks.trust.kept_cases import check_kept_cases
    from bench.benchmarks.trust.run import TABLE
    from bench.studies.sweep.console import table_console
    from bench.studies.sweep.reference import reference_folder
    from bench.studies.sweep.workers import Workers

    pool = Workers(workers, None).pool()
    try:
        return min(check_kept_cases(reference_folder().parent / "trust" / TABLE, pool, table_console()), 1)
    finally:
        pool.close()
