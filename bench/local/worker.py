"""Work in a separate process: it keeps what it has loaded, tells its progress, and can be ended at any moment."""

import importlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.progress import Progress

Function = Callable[[Mapping[str, Any], Progress], Any]
"""What a worker can do: plain arguments to a plain answer; a user's mistake is a BenchError."""
Home = str
"""Where a function is, as `module:name`: the process imports it, and who asks for it need not."""

GRACE = 5.0  # s that an ended process has to remove its half-written files


class CancelledError(Exception):
    """The work was ended because somebody asked for it, or because the worker is closed."""


class DiedError(Exception):
    """The process could not start, or ended by itself: why, in words. A fault's traceback is in the terminal."""


class Worker:
    """One process that runs one function at a time; it starts with the first, and again after a cancellation."""

    def __init__(self, functions: Mapping[str, Home]) -> None:
        self._functions = dict(functions)
        self._one_at_a_time = threading.Lock()
        self._changing = threading.Lock()
        self._process: Any = None
        self._connection: Connection | None = None
        self._busy = self._cancelled = self._gone = self._closed = False

    def call(self, name: str, arguments: Mapping[str, Any], progress: Progress) -> Any:
        """Run a function and wait for its answer; progress is reported on the way.

        Raises BenchError as the function did, CancelledError after `cancel` or `close`, DiedError where the process
        cannot start or ended itself.
        """
        with self._one_at_a_time:
            connection, fault = self._started(), ""
            try:
                connection.send((name, dict(arguments)))
                while True:
                    kind, *content = connection.recv()
                    if kind == "phase":
                        progress.phase(*content)
                    elif kind == "advance":
                        progress.advance(*content)
                    elif kind == "refused":
                        raise BenchError(content[0])
                    elif kind == "fault":
                        fault = content[0]
                    else:
                        return content[0]
            except (EOFError, ConnectionError) as error:
                self._gone = True  # also where the system has not noticed yet
                if self._cancelled or self._closed:
                    raise CancelledError from error
                raise DiedError(fault or self._why()) from error
            finally:
                with self._changing:
                    self._busy = False

    def cancel(self) -> None:
        """End the process if it works; its files are whole or not there. The call raises CancelledError."""
        with self._changing:
            if self._process is not None and self._busy:
                self._cancelled = True
                self._process.terminate()

    def close(self) -> None:
        """End the process for good; who waits for it hears of it."""
        with self._changing:
            self._closed = True
            self._end()

    def _why(self) -> str:
        """How the process ended that said nothing of it."""
        process = self._process
        process.join(GRACE)
        code = process.exitcode
        if code is not None and code < 0:
            ended = signal.Signals(-code).name
            memory = ", as when memory runs out" if ended == "SIGKILL" else ""
            return f"its process was ended by {ended}{memory}"
        try_it = f"import sys; sys.path[:] = {sys.path!r}; import {__name__}"  # whether one like it can start at all
        tried = subprocess.run([sys.executable, "-c", try_it], capture_output=True, text=True, check=False)
        said = tried.stderr.strip().splitlines()
        return f"its process cannot start: {said[-1]}" if said else f"its process ended with exit code {code}"

    def _started(self) -> Connection:
        with self._changing:
            if self._closed:
                raise CancelledError
            self._busy = True
            if self._process is None or self._cancelled or self._gone or not self._process.is_alive():
                self._end()
            if self._connection is None:
                context = get_context("spawn")  # a fork of a process with threads may hang
                self._connection, theirs = context.Pipe()
                self._process = context.Process(target=_serve, args=(theirs, self._functions), daemon=True)
                try:
                    self._process.start()
                except OSError as error:
                    self._process, self._busy = None, False
                    raise DiedError(f"its process cannot start: {error.strerror}") from error
                finally:
                    theirs.close()
                self._cancelled = self._gone = False
            return self._connection

    def _end(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            process.terminate()
            if process.is_alive() and hasattr(signal, "SIGCONT"):
                with suppress(ProcessLookupError):
                    os.kill(process.pid, signal.SIGCONT)  # one that is stopped ends, too
            process.join(GRACE)
            if process.is_alive():
                process.kill()
                process.join()
        if self._connection is not None and not (self._closed and self._busy):  # who waits reads its end
            self._connection.close()
            self._connection = None


class _Told:
    """Progress that goes through the pipe."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def phase(self, name: str, total: int | None = None) -> None:
        self._connection.send(("phase", name, total))

    def advance(self, steps: int = 1) -> None:
        self._connection.send(("advance", steps))


def _serve(connection: Connection, functions: Mapping[str, Home]) -> None:
    """What the process does: one request after the other until nobody asks any more."""
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # Ctrl+C in the terminal is the server's, which ends this one
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    progress = _Told(connection)
    while True:
        try:
            name, arguments = connection.recv()
        except EOFError:
            return
        try:
            answer = _function(functions[name])(arguments, progress)
        except BenchError as error:
            connection.send(("refused", str(error)))
        except Exception as error:
            connection.send(("fault", f"a fault of the program, {type(error).__name__}: {error}"))
            raise
        else:
            connection.send(("done", answer))


def _function(home: Home) -> Function:
    module, _, name = home.partition(":")
    function: Function = getattr(importlib.import_module(module), name)
    return function


def _leave_with_parent() -> None:
    """A killed server leaves nobody to work for: end as a terminated command does."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
