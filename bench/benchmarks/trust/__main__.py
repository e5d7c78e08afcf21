"""`make trust`: simulated machines with known truth, of every robot and question, into one table and one page.

    python -m bench.benchmarks.trust [ROBOT ...] [--hours H] [--workers N | --scheduler ADDRESS] [-o DIR]
    python -m bench.benchmarks.trust --case ROBOT/QUESTION/NUMBER

The two robots of OTHERS join where the measured data have them, as copies without friction, with motions planned like
those of `bench excite`. A second start continues with the unfinished cases. `--page` only writes the page of the table
again; `--readme README.md` also writes the table into that file.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from bench.basics.errors import BenchError
from bench.benchmarks.trust.cells import changelog_number
from bench.benchmarks.trust.evaluation import read_evaluation
from bench.benchmarks.trust.one_case import case_lines
from bench.benchmarks.trust.others import OTHERS, PREPARED, scenarios_of_others
from bench.benchmarks.trust.overview import write_readme
from bench.benchmarks.trust.page import write_page
from bench.benchmarks.trust.plan import TrustProgress
from bench.benchmarks.trust.run import ROBOTS, TABLE, WORK, TrustRequest, run_trust, setups_of
from bench.studies.sweep.pool import Workers

RESULT = Path("results/trust")
HOURS = 3.0
STOPPED = 130  # exit code after an interrupt


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the cases and write the page. Returns 0, 2 after an error, printed in one line, or 130 after an interrupt."""
    given = _parser().parse_args(arguments)
    console = Console(stderr=True)
    try:
        if given.case:
            console.file = sys.stdout
            for line in case_lines(given.case, given.also, given.output / WORK / PREPARED):
                console.print(line, markup=False, highlight=False, soft_wrap=True)
            return 0
        if not given.page:
            _run(given, console)
        for path in write_page(given.output / TABLE):
            console.print(f"wrote {path}", markup=False, highlight=False, soft_wrap=True)
        if given.readme is not None:
            write_readme(read_evaluation(given.output / TABLE), given.readme)
    except KeyboardInterrupt:
        console.print("Stopped. Finished cases are kept: the same command goes on with the others.")
        return STOPPED
    except BenchError as error:
        console.print(f"bench: {error}", markup=False, highlight=False, soft_wrap=True)
        return 2
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python -m bench.benchmarks.trust", description=(__doc__ or "").split("\n")[0]
    )
    add = parser.add_argument
    add(
        "robots",
        nargs="*",
        metavar="ROBOT",
        help=f"names or folders; by default {', '.join((*ROBOTS, *OTHERS))}",
    )
    add("--hours", type=float, default=HOURS, help="of all workers at the same time [default: %(default)s]")
    add(
        "--also",
        action="append",
        default=[],
        metavar="ROBOT",
        help="a folder or scenario file, may be repeated",
    )
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--workers", type=int, metavar="N", help="processes; by default one for each core")
    where.add_argument("--scheduler", metavar="ADDRESS", help="of a Dask cluster")
    add("--case", metavar="ROBOT/QUESTION/NUMBER", help="only run this case, and print its result")
    add("--page", action="store_true", help="only write the page of the table that is there")
    add("--readme", type=Path, metavar="FILE", help="write the table between the marks of this file, too")
    add("-o", "--output", type=Path, default=RESULT, metavar="DIR", help="[default: %(default)s]")
    return parser


def _run(given: argparse.Namespace, console: Console) -> None:
    workers = Workers(given.workers, given.scheduler)
    workers.warm_up()
    robots = given.robots or [*ROBOTS, *scenarios_of_others(given.output / WORK / PREPARED)]
    number = changelog_number()
    version = f"{number.version}, entry {number.entries}"
    request = TrustRequest(setups_of([*robots, *given.also]), version, number.first, given.hours)
    console.print(f"{version}: cases from number {number.first} on, {given.hours:g} h", highlight=False)
    run_trust(
        request, given.output, workers.pool, lambda tally, budget: TrustProgress(console, tally, budget)
    )


if __name__ == "__main__":
    sys.exit(main())
