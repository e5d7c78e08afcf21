"""Progress of a sweep: rate, remaining time, failures."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, SpinnerColumn, TextColumn

from bench.studies.sweep.journal import Journal

SAY_EVERY = 30.0  # s between lines if the output is not a terminal
STYLES = (("dim", "rate"), ("cyan", "remaining"), ("red", "failed"))


class ShownProgress:
    """Shows reports of finished runs: as a bar, with the phases before them, or as a line every half minute."""

    def __init__(self, console: Console, total: int, bar: Progress | None = None) -> None:
        self._console, self._total, self._bar = console, total, bar
        self._start = self._said = time.monotonic()
        self._count, self._before = 0, -1
        self._phase = "runs"
        if bar is not None:
            bar.add_task("runs", total=total, rate="", remaining="", failed="")

    def __call__(self, journal: Journal) -> None:
        """Show how many runs are finished."""
        now, self._count = time.monotonic(), journal.count
        if self._before < 0:
            self._before = journal.count
        runs, pending = journal.count - self._before, self._total - journal.count
        rate = runs / (now - self._start) if runs > 0 and now > self._start else 0.0
        remaining = f"{duration_text(pending / rate)} left" if rate and pending else ""
        failed = f"{len(journal.failed)} failed" if journal.failed else ""
        if self._bar is not None:
            texts: dict[str, Any] = {"rate": rate_text(rate), "remaining": remaining, "failed": failed}
            name = "runs" if runs else self._phase
            self._bar.update(self._bar.task_ids[0], description=name, completed=journal.count, **texts)
        elif now - self._said >= SAY_EVERY:
            self._said = now
            said = (f"{journal.count} of {self._total} runs", rate_text(rate), remaining, failed)
            self._console.print(", ".join(filter(None, said)))

    def phase(self, name: str) -> None:
        """Show the current phase, until the first run is finished."""
        self._phase = name
        if self._bar is not None and self._count == max(self._before, 0):
            self._bar.update(self._bar.task_ids[0], description=name)


@contextmanager
def shown_progress(console: Console, total: int) -> Iterator[ShownProgress]:
    """A bar on a terminal, otherwise a line every half minute; nothing on a quiet console."""
    if not console.is_terminal:
        yield ShownProgress(console, total)
        return
    texts = [TextColumn(f"[{style}]{{task.fields[{name}]}}") for style, name in STYLES]
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), *texts)
    with Progress(*columns, console=console, disable=console.quiet) as bar:
        yield ShownProgress(console, total, bar)


def progress_console(quiet: bool) -> Console:
    """Standard error, for progress bars; quiet: without output."""
    return Console(stderr=True, quiet=quiet, highlight=False)


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
