"""A line at the bottom of the terminal: phase, bar, steps, elapsed and remaining time."""

from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    SpinnerColumn,
    Task,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.text import Text


class _Steps(ProgressColumn):
    def render(self, task: Task) -> Text:
        """Finished and total steps, if the total is known."""
        return Text("" if task.total is None else f"{task.completed:g}/{task.total:g}", "dim")


class _TimeLeft(TimeRemainingColumn):
    def render(self, task: Task) -> Text:
        """Remaining time of the phase, estimated from its steps."""
        if task.time_remaining is None:
            return Text("")
        return super().render(task).append(" left")


class ProgressBar:
    """Shows the current phase on standard error inside the context; it disappears afterwards."""

    def __init__(self, phase: str) -> None:
        self._bars = Progress(
            SpinnerColumn(),
            TextColumn("{task.description}", markup=False),
            BarColumn(),
            _Steps(),
            TimeElapsedColumn(),
            _TimeLeft(compact=True),
            console=Console(stderr=True),
            transient=True,
            redirect_stdout=False,
            redirect_stderr=False,
        )
        self._task = self._bars.add_task(phase, total=None)

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, traceback: TracebackType | None
    ) -> None:
        self._bars.stop()

    def phase(self, name: str, total: int | None = None) -> None:
        """Begin another phase."""
        self._bars.remove_task(self._task)
        self._task = self._bars.add_task(name, total=total)

    def advance(self, steps: int = 1) -> None:
        """Move the bar."""
        self._bars.advance(self._task, steps)
