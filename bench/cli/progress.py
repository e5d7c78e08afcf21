"""Phase, progress and remaining time of long work, only on a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import click

from bench.basics.progress import SILENT, Progress
from bench.cli.last_lines import set_quiet
from bench.cli.termination import LeavingProgress

QUIET = "Print nothing but errors, and show no progress."

_elsewhere: ContextVar[Progress | None] = ContextVar("progress shown elsewhere", default=None)


def quiet_option(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add the option --quiet: no progress, only errors."""
    return click.option("-q", "--quiet", is_flag=True, callback=set_quiet, help=QUIET)(command)


@contextmanager
def shown_progress(quiet: bool, phase: str = "starting") -> Iterator[Progress]:
    """Show a temporary bar on standard error inside the context, if that is a terminal.

    Nothing may be printed inside, since it would interrupt the bar. phase: the first one. Inside `progress_to`, its
    receiver gets the progress instead.
    """
    if (listener := _elsewhere.get()) is not None:
        listener.phase(phase)
        yield LeavingProgress(listener)
        return
    if quiet or not sys.stderr.isatty():
        yield LeavingProgress(SILENT)
        return
    from bench.cli.progress_bar import ProgressBar

    with ProgressBar(phase) as bar:
        yield LeavingProgress(bar)


@contextmanager
def progress_to(progress: Progress) -> Iterator[None]:
    """Send the progress of commands that run inside the context to `progress` instead of the terminal."""
    before = _elsewhere.set(progress)
    try:
        yield
    finally:
        _elsewhere.reset(before)
