"""Workers that run tasks: processes on this machine, with the same interface as a cluster."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import traceback
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from multiprocessing import forkserver
from multiprocessing.connection import Connection, wait
from pathlib import Path
from typing import Any, Protocol, Self, TypeAlias

from bench.basics.errors import BenchError

Task: TypeAlias = Callable[[Any], Any]
"""A function of the value shared with other tasks, or of None: a `partial`, which can be pickled."""
ATTEMPTS = 3  # attempts in all at a task whose worker dies
ONE_THREAD = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMEXPR_NUM_THREADS")
PRELOADED = ["bench.studies.sweep.work"]
FORKED = "forkserver" in multiprocessing.get_all_start_methods()


@dataclass(frozen=True)
class Shared:
    """A value that many tasks need, such as a simulation. It is sent to each worker once. `name` distinguishes
    values.
    """

    name: str
    value: Any


@dataclass(frozen=True)
class Outcome:
    """A finished task, with its value or the reason for its failure."""

    key: int
    value: Any
    fault: str | None


class Pool(Protocol):
    """Workers that run tasks; the end of a `with` stops them."""

    @property
    def slots(self) -> int:
        """Number of tasks that run at the same time."""

    def submit(self, key: int, task: Task, shared: Shared | None = None) -> None:
        """Queue a task under a key of the caller, with the value that it is called with."""

    def outcomes(self) -> list[Outcome]:
        """Wait until a task ends, at most for a second, and return all that have ended."""

    def close(self) -> None:
        """Stop, including running tasks."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


@dataclass
class _Worker:
    process: multiprocessing.process.BaseProcess
    connection: Connection
    job: _Job | None = None
    ready: bool = False
    """Whether it has reported that it runs."""
    holds: str | None = None
    """Name of the shared value that was last sent to it."""


@dataclass
class _Job:
    key: int
    task: Task
    shared: Shared | None
    attempts: int = 0


class LocalPool(Pool):
    """Worker processes on this machine; one that dies is replaced, and its task repeated."""

    def __init__(self, workers: int) -> None:
        self._queue: deque[_Job] = deque()
        self._outcomes: list[Outcome] = []
        self._stillborn = 0
        start_server()
        self._context: Any = multiprocessing.get_context("forkserver" if FORKED else "spawn")
        self._workers = [self._start() for _ in range(workers)]

    @property
    def slots(self) -> int:
        """Number of workers."""
        return len(self._workers)

    def submit(self, key: int, task: Task, shared: Shared | None = None) -> None:
        """Queue a task."""
        self._queue.append(_Job(key, task, shared))
        self._hand_out()

    def outcomes(self) -> list[Outcome]:
        """Wait until a task ends, at most for a second, and return all that have ended."""
        if not self._outcomes:
            busy = [worker for worker in self._workers if worker.job is not None]
            waited = [w.connection for w in busy] + [w.process.sentinel for w in busy]
            ready = set(wait(waited, timeout=1.0))
            for worker in busy:
                if worker.connection in ready or worker.process.sentinel in ready:
                    self._collect(worker)
            self._hand_out()
        ended, self._outcomes = self._outcomes, []
        return ended

    def close(self) -> None:
        """Stop all workers at once."""
        for worker in self._workers:
            worker.process.kill()
        for worker in self._workers:
            worker.process.join()
            worker.connection.close()

    def _start(self) -> _Worker:
        ours, theirs = self._context.Pipe()
        process: multiprocessing.process.BaseProcess = self._context.Process(
            target=_work, args=(theirs,), daemon=True
        )
        with _one_thread_each(), _without_main():
            process.start()
        theirs.close()
        return _Worker(process, ours)

    def _hand_out(self) -> None:
        for index, worker in enumerate(self._workers):
            if worker.job is None and self._queue:
                job = self._queue.popleft()
                worker.job = job
                job.attempts += 1
                name = job.shared.name if job.shared else None
                try:
                    worker.connection.send((job.task, name, None if name == worker.holds else job.shared))
                    worker.holds = name
                except (BrokenPipeError, ConnectionResetError):
                    self._replace(index)

    def _collect(self, worker: _Worker) -> None:
        assert worker.job is not None
        try:
            answer = worker.connection.recv()
        except (EOFError, ConnectionResetError):
            self._replace(self._workers.index(worker))
            return
        if answer is None:
            worker.ready, self._stillborn = True, 0
            return
        self._outcomes.append(Outcome(worker.job.key, *answer))
        worker.job = None

    def _replace(self, index: int) -> None:
        """Replace a dead worker, and put its task back into the queue."""
        worker = self._workers[index]
        worker.process.join()
        worker.connection.close()
        job, code = worker.job, worker.process.exitcode
        self._stillborn += not worker.ready
        if self._stillborn >= ATTEMPTS:
            raise BenchError("a worker process cannot start; its output is printed above")
        self._workers[index] = self._start()
        if job is None:
            return
        if job.attempts < ATTEMPTS:
            self._queue.appendleft(job)
            return
        name = f"signal {signal.Signals(-code).name}" if code and code < 0 else f"exit code {code}"
        self._outcomes.append(Outcome(job.key, None, f"the worker died {ATTEMPTS} times ({name})"))


def attempt(task: Task, shared: Any = None) -> tuple[Any, str | None]:
    """The value of a task and None, or None and the reason for its failure."""
    try:
        return task(shared), None
    except Exception as error:  # noqa: BLE001 - any failure of a run is recorded, and the others continue
        if isinstance(error, BenchError):
            return None, str(error)
        where = traceback.extract_tb(error.__traceback__)[-1]
        return None, f"{type(error).__name__}: {error} ({Path(where.filename).name}:{where.lineno})"


def _work(connection: Connection) -> None:
    """The loop of a worker process, which ends when its connection is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent handles interrupts
    try:
        held: Shared | None = None
        connection.send(None)
        while True:
            task, name, sent = connection.recv()
            held = sent or (held if name is not None else None)
            connection.send(attempt(task, held.value if held else None))
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def start_server() -> None:
    """Begin to import in the background what workers need.

    Workers are forked from a server that has imported everything once; without a fork server, they are spawned.
    """
    if FORKED:
        forkserver.set_forkserver_preload(PRELOADED)
        with _one_thread_each():
            forkserver.ensure_running()


@contextmanager
def _without_main() -> Iterator[None]:
    """Processes started inside do not run the main program again, since their tasks are not defined there.

    A script without the `__main__` guard, or one read from a pipe, can thus run a sweep.
    """
    main = sys.modules["__main__"]
    hidden = {name: getattr(main, name) for name in ("__file__", "__spec__") if hasattr(main, name)}
    if "__file__" in hidden:
        del main.__file__
    main.__spec__ = None
    try:
        yield
    finally:
        for name, value in hidden.items():
            setattr(main, name, value)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes started inside use one thread for linear algebra, since there is a worker for every core."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@dataclass(frozen=True)
class Workers:
    """The workers that a command requests. processes: number on this machine, None for one per core; scheduler: an
    address of a cluster instead.
    """

    processes: int | None = None
    scheduler: str | None = None

    @property
    def count(self) -> int:
        """Number of processes on this machine."""
        return self.processes or len(os.sched_getaffinity(0))

    def warm_up(self) -> None:
        """Begin to import in the background what processes on this machine need."""
        if self.scheduler is None:
            start_server()

    def pool(self) -> Pool:
        """Start the processes, or connect to the scheduler."""
        if self.scheduler is None:
            return LocalPool(self.count)
        from bench.studies.sweep.dask_pool import DaskPool  # noqa: PLC0415 - an optional extra

        return DaskPool(self.scheduler)


ON_ALL_CORES = Workers()
