"""`make measured`: identify and diagnose measured logs into results/measured, compared with known values.

    python -m bench.benchmarks.measured [MACHINE ...] [--repeats] [-o DIR]

Only the named machines run again; the pages show all records in the folder.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.basics.versions import versions
from bench.benchmarks.measured.known import known_machines
from bench.benchmarks.measured.machines import MACHINES, dataset_of
from bench.benchmarks.measured.page import measured_page
from bench.benchmarks.measured.repeats import COMPARED, keep_repeats, repeats_of
from bench.benchmarks.measured.run import keep, kept, measured
from bench.benchmarks.measured.tables import measured_markdown
from bench.benchmarks.measured_data import measured_data
from bench.page.render import render_page

RESULT = Path("results/measured")


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the machines, save the records and write the pages. Returns 0, or 2 after an error, printed in one line."""
    parser = argparse.ArgumentParser(
        prog="python -m bench.benchmarks.measured", description=(__doc__ or "").split("\n")[0]
    )
    add = parser.add_argument
    add("machines", nargs="*", metavar="MACHINE", help=f"of {', '.join(MACHINES)}; all by default")
    add("-o", "--output", type=Path, default=RESULT, metavar="DIR", help="[default: %(default)s]")
    add("--repeats", action="store_true", help="only compare logs of one machine with each other")
    given = parser.parse_args(arguments)
    try:
        if given.repeats:
            _repeats(given.output)
            return 0
        _run(given.machines or list(MACHINES), given.output)
    except BenchError as error:
        print(f"bench: {error}", file=sys.stderr)  # noqa: T201 - a separate program
        return 2
    return 0


def _run(names: Sequence[str], output: Path) -> None:
    data = measured_data()
    if unknown := [name for name in names if name not in MACHINES]:
        raise BenchError(f"{unknown[0]}: the measured machines are {', '.join(MACHINES)}")
    tables = known_machines()
    for name in names:
        with TemporaryDirectory() as folder:
            record = measured(name, dataset_of(name, data, Path(folder)), tables[name], _say)
        keep(record, output)
        write_pages(output)
    _say(f"wrote {output / 'measured.md'} and {output / 'measured.html'}")


def _repeats(output: Path) -> None:
    """Compare the logs of each machine, or their halves, with each other."""
    data, rows = measured_data(), []
    for name, kind, logs in COMPARED:
        with TemporaryDirectory() as folder:
            rows.append(repeats_of(name, dataset_of(name, data, Path(folder)), kind, logs))
        _say(f"{name}, {rows[-1].kind}: RMS z {rows[-1].rms:.2f}, within 2 {100 * rows[-1].within:.0f} %")
    _say(f"wrote {keep_repeats(rows, versions().columns(), output)}")


def write_pages(folder: Path) -> None:
    """Write the Markdown and the HTML page of the records in a folder."""
    records, tables = kept(folder), known_machines()
    write_text_atomically(folder / "measured.md", measured_markdown(records, tables))
    page = measured_page(records, tables, "make measured")
    write_text_atomically(folder / "measured.html", render_page(page))


def _say(text: str) -> None:
    print(text, flush=True)  # noqa: T201 - a separate program


if __name__ == "__main__":
    sys.exit(main())
