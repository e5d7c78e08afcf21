"""Work in a separate process, which keeps what it has loaded, reports progress and can be ended at any time."""

import importlib
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from contextlib import suppress
from multiprocessing import get_context, parent_process
from multiprocessing.connection import Connection
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.progress import Progress

Home = str
"""The location of a function of arguments and `Progress`, as `module:name`; only the worker's process imports it."""

GRACE = 5.0  # s that an ended process has to remove its half-written files


class CancelledError(Exception):
    """The work was cancelled, or the worker was closed."""


class DiedError(Exception):
    """The process could not start, or ended by itself; the text says why. A fault's traceback is in the terminal."""


class Worker:
    """A process that runs one function at a time; started by the first call, and again after a cancellation."""

    def __init__(self, functions: Mapping[str, Home]) -> None:
        self._functions = dict(functions)
        self._one_at_a_time = threading.Lock()
        self._changing = threading.Lock()
        self._process: Any = None
        self._connection: Connection | None = None
        self._busy = self._cancelled = self._gone = self._closed = False

    def call(self, name: str, arguments: Mapping[str, Any], progress: Progress) -> Any:
        """Run a function and wait for its answer. progress: receives its progress.

        Raises the function's BenchError, CancelledError after `cancel` or `close`, and DiedError if the process does
        not start or ends.
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
                self._gone = True  # even if the system does not report it yet
                if self._cancelled or self._closed:
                    raise CancelledError from error
                raise DiedError(fault or self._why()) from error
            finally:
                with self._changing:
                    self._busy = False

    def cancel(self) -> None:
        """End the process if it is busy, without half-written files. The running call raises CancelledError."""
        with self._changing:
            if self._process is not None and self._busy:
                self._cancelled = True
                self._process.terminate()

    def close(self) -> None:
        """End the process for good; a waiting call raises CancelledError."""
        with self._changing:
            self._closed = True
            self._end()

    def _why(self) -> str:
        """Why the process ended, if it sent no reason."""
        process = self._process
        process.join(GRACE)
        code = process.exitcode
        if code is not None and code < 0:
            ended = signal.Signals(-code).name
            memory = ", as when memory runs out" if ended == "SIGKILL" else ""
            return f"its process was ended by {ended}{memory}"
        try_it = (
            f"import sys; sys.path[:] = {sys.path!r}; import {__name__}"  # can such a process start at all?
        )
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
                context = get_context("spawn")  # a forked process with threads may hang
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
                    os.kill(process.pid, signal.SIGCONT)  # a stopped process ends only when continued
            process.join(GRACE)
            if process.is_alive():
                process.kill()
                process.join()
        if self._connection is not None and not (self._closed and self._busy):  # a waiting call reads its end
            self._connection.close()
            self._connection = None


class _Told:
    """Progress sent through the pipe."""

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def phase(self, name: str, total: int | None = None) -> None:
        self._connection.send(("phase", name, total))

    def advance(self, steps: int = 1) -> None:
        self._connection.send(("advance", steps))


def _serve(connection: Connection, functions: Mapping[str, Home]) -> None:
    """Answer requests, one at a time, until the pipe is closed."""
    signal.signal(
        signal.SIGINT, signal.SIG_IGN
    )  # Ctrl+C in the terminal goes to the server, which ends this process
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    progress = _Told(connection)
    while True:
        try:
            name, arguments = connection.recv()
        except EOFError:
            return
        try:
            module, _, function = functions[name].partition(":")
            answer = getattr(importlib.import_module(module), function)(arguments, progress)
        except BenchError as error:
            connection.send(("refused", str(error)))
        except Exception as error:
            connection.send(("fault", f"a fault of the program, {type(error).__name__}: {error}"))
            raise
        else:
            connection.send(("done", answer))


def _leave_with_parent() -> None:
    """End this process, as a terminated command does, once the server has ended, killed or not."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os.kill(os.getpid(), signal.SIGTERM)
