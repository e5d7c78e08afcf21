"""`bench open`: the whole loop on one page."""

import contextlib
import io
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import click

from bench.basics.progress import Progress


@click.command("open")
@click.argument("folder", type=click.Path(path_type=Path), default=Path(), metavar="[DATASET_OR_FOLDER]")
@click.option(
    "--robot",
    "robots",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="FOLDER",
    help="A robot folder elsewhere, to choose from. Repeat for more.",
)
@click.option(
    "--port", type=click.IntRange(0, 65535), default=0, help="Of the address. [default: a free one]"
)
@click.option("--no-browser", is_flag=True, help="Only print the address.")
def open_page(folder: Path, robots: tuple[Path, ...], port: int, no_browser: bool) -> None:
    """Go from logs to the named effect on a page in the browser.

    The page takes logs, checks and imports them, compares, diagnoses, tries effects and applies them. It does so
    with the commands, shows each, and works on the same files, in DATASET_OR_FOLDER (by default the folder that one
    is in) and nowhere else. It is served on this machine alone, until Ctrl+C.
    """
    from bench.local.server import opened, serve

    words = [str(folder)] if folder != Path() else []
    words += [word for robot in robots for word in ("--robot", str(robot))]

    def ready(address: str) -> None:
        click.echo(f"Open {address}")
        click.echo("It answers this machine alone, and only at this address. Ctrl+C ends it.")
        if not no_browser:
            import webbrowser

            webbrowser.open(address)

    serve(opened(folder, robots, _line(words), port), {"command": "bench.cli.open:run_command"}, ready)


def _line(words: list[str]) -> str:
    from bench.basics.program import typed
    from bench.basics.shell_word import quoted

    return " ".join([typed(), *(quoted(word) for word in ["open", *words])])


def run_command(arguments: Mapping[str, Any], progress: Progress) -> dict[str, Any]:
    """Run a command as the shell would, in the worker; what it prints, what it says is wrong, its exit code."""
    from bench.cli import main
    from bench.cli.progress import progress_to

    os.environ["COLUMNS"] = "100"  # of tables that no terminal limits
    out, err = io.StringIO(), io.StringIO()
    with progress_to(progress), contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main(arguments["words"])
    faults = [line.removeprefix("bench: ") for line in err.getvalue().splitlines()]
    return {"output": out.getvalue(), "error": "\n".join(faults), "code": code}
