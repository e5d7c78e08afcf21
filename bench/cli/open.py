"""`bench open`: the whole loop on one page."""

import contextlib
import io
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from bench.basics.progress import Progress
from bench.cli.options import path_option


@click.command("open")
@click.argument("folder", type=click.Path(path_type=Path), default=Path(), metavar="[DATASET_OR_FOLDER]")
@path_option(
    "--robot",
    "robots",
    multiple=True,
    metavar="FOLDER",
    help="A further robot folder to choose from. Repeat for more.",
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Port of the address. [default: a free one]"
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
def open_page(folder: Path, robots: tuple[Path, ...], port: int, no_browser: bool) -> None:
    """Go from logs to the named effect on a page in the browser.

    The page checks and imports logs, compares, diagnoses, tries effects and applies them. It runs and shows the
    corresponding commands and works only on the files in DATASET_OR_FOLDER (by default the current folder). The server
    accepts connections from this machine only, until Ctrl+C.
    """
    from bench.basics.program import typed
    from bench.basics.shell_word import each, quoted
    from bench.local.server import opened, serve

    words = ["open", *([str(folder)] if folder != Path() else []), *each("--robot", robots)]
    line = " ".join([typed(), *map(quoted, words)])

    def ready(address: str) -> None:
        click.echo(f"Open {address}")
        click.echo("It accepts connections from this machine only. Ctrl+C ends it.")
        if not no_browser:
            import webbrowser

            webbrowser.open(address)

    serve(opened(folder, robots, line, port), {"command": "bench.cli.open:run_command"}, ready)


def run_command(arguments: Mapping[str, Any], progress: Progress) -> dict[str, Any]:
    """Run a command in the worker as the shell would; returns its output, its errors and its exit code."""
    from bench.cli import main
    from bench.cli.progress import progress_to

    os.environ["COLUMNS"] = "100"  # width of tables without a terminal
    out, err = io.StringIO(), io.StringIO()
    with progress_to(progress), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(arguments["words"])
    faults = [line.removeprefix("bench: ") for line in err.getvalue().splitlines()]
    return {"output": out.getvalue(), "error": "\n".join(faults), "code": code}
