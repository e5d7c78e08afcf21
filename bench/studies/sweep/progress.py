"""Progress of a sweep: rate, remaining time, failures."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
)
from rich.text import Text

from bench.studies.sweep.journal import Journal

SAY_EVERY = 30.0  # s between lines if the output is not a terminal


class _Rate(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Runs per second, or per minute if they are slow."""
        return Text(rate_text(_mean_rate(task)), "dim")


class _RunsLeft(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Time remaining at the mean rate since the start."""
        rate = _mean_rate(task)
        remaining = (task.total or 0) - task.completed
        return Text(f"{duration_text(remaining / rate)} left" if rate and remaining else "", "cyan")


class _Failures(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Failed runs, in red if there are any."""
        failed = task.fields["failed"]
        return Text(f"{failed} failed" if failed else "", "red")


class ShownProgress(Protocol):
    """Receives reports of finished runs, and of the phases before them."""

    def __call__(self, journal: Journal) -> None:
        """Show how many runs are finished."""

    def phase(self, name: str) -> None:
        """Show the current phase."""


@contextmanager
def shown_progress(console: Console, total: int) -> Iterator[ShownProgress]:
    """A bar on a terminal, otherwise a line every half minute; nothing on a quiet console."""
    if not console.is_terminal:
        yield _Spoken(console, total)
        return
    columns = (
        SpinnerColumn(),
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _Rate(),
        _RunsLeft(),
        _Failures(),
    )
    with Progress(*columns, console=console, disable=console.quiet) as progress:
        yield _Bar(progress, total)


def progress_console(quiet: bool) -> Console:
    """Standard error, for progress bars; quiet: without output."""
    return Console(stderr=True, quiet=quiet)


class _Bar:
    """A bar with the number of finished runs, or the phase before them."""

    def __init__(self, progress: Progress, total: int) -> None:
        self._progress = progress
        self._task = progress.add_task("runs", total=total, before=None, failed=0)
        self._phase = "runs"

    def __call__(self, journal: Journal) -> None:
        task = self._progress.tasks[0]
        before = journal.count if task.fields["before"] is None else task.fields["before"]
        name = self._phase if journal.count == before else "runs"
        self._progress.update(
            self._task, description=name, completed=journal.count, failed=len(journal.failed), before=before
        )

    def phase(self, name: str) -> None:
        self._phase = name
        task = self._progress.tasks[0]
        if task.completed == (task.fields["before"] or 0):
            self._progress.update(self._task, description=name)


class _Spoken:
    """Lines of text for output that is not a terminal."""

    def __init__(self, console: Console, total: int) -> None:
        self._console, self._total = console, total
        self._start = self._said = time.monotonic()
        self._before = -1

    def __call__(self, journal: Journal) -> None:
        now = time.monotonic()
        if self._before < 0:
            self._before = journal.count
        if now - self._said < SAY_EVERY:
            return
        self._said = now
        rate = _rate(journal.count - self._before, now - self._start)
        remaining = f", {duration_text((self._total - journal.count) / rate)} left" if rate else ""
        failed = f", {len(journal.failed)} failed" if journal.failed else ""
        self._console.print(
            f"{journal.count} of {self._total} runs, {rate_text(rate)}{remaining}{failed}", highlight=False
        )

    def phase(self, name: str) -> None:
        """Not shown, since a log only lists finished runs."""


def rate_text(rate: float) -> str:
    """Runs per second or per minute."""
    if not rate:
        return ""
    return f"{rate:.1f} runs/s" if rate >= 1 else f"{60 * rate:.1f} runs/min"


def duration_text(seconds: float) -> str:
    """A duration in s, min or h."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def _mean_rate(task: Task) -> float:
    """Runs per second since the start, without runs kept from earlier."""
    before = task.fields["before"]
    return 0.0 if before is None else _rate(task.completed - before, task.elapsed or 0.0)


def _rate(runs: float, seconds: float) -> float:
    return runs / seconds if runs > 0 and seconds > 0 else 0.0
