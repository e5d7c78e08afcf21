"""The phase, the progress and the time left of long work, on a terminal alone."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import click

from bench.progress import SILENT, Progress


def quiet_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Say nothing of the progress."""
    option = click.option("-q", "--quiet", is_flag=True, help="Show no progress on the terminal.")
    return option(command)


@contextmanager
def shown_progress(quiet: bool, phase: str = "starting") -> Iterator[Progress]:
    """Show a bar on standard error while inside, if that is a terminal; it is gone afterwards.

    Nothing may be printed inside: it would stand in the middle of the bar. phase: the first one.
    """
    if quiet or not sys.stderr.isatty():
        yield SILENT
        return
    from bench.cli.progress_bar import ProgressBar

    with ProgressBar(phase) as bar:
        yield bar
