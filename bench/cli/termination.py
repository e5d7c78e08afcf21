"""The end of a command that SIGTERM asks to end.

Python drops what a signal handler raises if the program is in a callback of the garbage collector just then, for
example during an import. So the request is kept, and every report of progress repeats it: none is part of a clean-up.
"""

import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

from bench.basics.progress import Progress

TERMINATED = 143  # exit code: 128 + SIGTERM

_asked: ContextVar[threading.Event | None] = ContextVar("whether the command was asked to end", default=None)


@contextmanager
def leaving_on_termination(say: Callable[[], object]) -> Iterator[None]:
    """Turn SIGTERM into an exception, so that incomplete files are removed before the exit. say: prints that."""
    if threading.current_thread() is not threading.main_thread():  # Python handles signals only there
        yield
        return
    asked = threading.Event()

    def leave(*_: object) -> None:
        asked.set()
        say()
        sys.exit(TERMINATED)

    handler, before = signal.signal(signal.SIGTERM, leave), _asked.set(asked)
    try:
        yield
    finally:
        _asked.reset(before)
        signal.signal(signal.SIGTERM, handler)


class LeavingProgress:
    """Passes progress on, and ends a command that was asked to end."""

    def __init__(self, progress: Progress) -> None:
        self._progress, self._asked = progress, _asked.get()

    def phase(self, name: str, total: int | None = None) -> None:
        """Begin another phase."""
        self._leave()
        self._progress.phase(name, total)

    def advance(self, steps: int = 1) -> None:
        """Report more finished steps."""
        self._leave()
        self._progress.advance(steps)

    def _leave(self) -> None:
        if self._asked is not None and self._asked.is_set():
            sys.exit(TERMINATED)
