"""How far a sweep is: rate, time left, failures."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, ProgressColumn, Task, TextColumn
from rich.text import Text

from bench.sweep.drive import Report
from bench.sweep.journal import Journal

SAY_EVERY = 30.0  # s between lines where there is no terminal to draw a bar on


class _Rate(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Runs per second, or per minute where they are slow."""
        return Text(rate_text(_mean_rate(task)), "dim")


class _Left(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Time left at the mean rate since the start."""
        rate = _mean_rate(task)
        left = (task.total or 0) - task.completed
        return Text(f"{duration_text(left / rate)} left" if rate and left else "", "cyan")


class _Failures(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Failed runs, in red if there are any."""
        failed = task.fields["failed"]
        return Text(f"{failed} failed" if failed else "", "red")


@contextmanager
def shown_progress(console: Console, total: int) -> Iterator[Report]:
    """A bar on a terminal, a line every half minute elsewhere."""
    if not console.is_terminal:
        yield _spoken(console, total)
        return
    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        _Rate(),
        _Left(),
        _Failures(),
    )
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("runs", total=total, before=None, failed=0)

        def report(journal: Journal) -> None:
            if progress.tasks[0].fields["before"] is None:
                progress.update(task, before=journal.count)
            progress.update(task, completed=journal.count, failed=len(journal.failed))

        yield report


def _spoken(console: Console, total: int) -> Report:
    start, said, before = time.monotonic(), time.monotonic(), -1

    def report(journal: Journal) -> None:
        nonlocal said, before
        now = time.monotonic()
        if before < 0:
            before = journal.count
        if now - said < SAY_EVERY:
            return
        said = now
        rate = _rate(journal.count - before, now - start)
        left = f", {duration_text((total - journal.count) / rate)} left" if rate else ""
        failed = f", {len(journal.failed)} failed" if journal.failed else ""
        console.print(f"{journal.count} of {total} runs, {rate_text(rate)}{left}{failed}", highlight=False)

    return report


def rate_text(rate: float) -> str:
    """Runs per second or per minute."""
    if not rate:
        return ""
    return f"{rate:.1f} runs/s" if rate >= 1 else f"{60 * rate:.1f} runs/min"


def duration_text(seconds: float) -> str:
    """A duration as people say it."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def _mean_rate(task: Task) -> float:
    """Runs per second since the start; runs kept from an earlier start say nothing about it."""
    before = task.fields["before"]
    return 0.0 if before is None else _rate(task.completed - before, task.elapsed or 0.0)


def _rate(runs: float, seconds: float) -> float:
    return runs / seconds if runs > 0 and seconds > 0 else 0.0
