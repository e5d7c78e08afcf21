"""Workers on a cluster: Dask distributed, with the same interface as the processes of this machine."""

import queue
import time
from concurrent.futures import CancelledError
from importlib import import_module
from typing import Any

from bench.basics.errors import BenchError
from bench.basics.versions import versions
from bench.studies.sweep.pool import Outcome, Pool, Shared, Task, attempt

try:
    distributed: Any = import_module("distributed")
except ImportError as error:
    raise BenchError(
        "a Dask scheduler needs the extra `cluster`: pip install 'parabench[cluster]'"
    ) from error

CONNECTING = 20.0  # s
COUNT_EVERY = 5.0  # s between two counts of the workers
MOST_SHARED = 8  # number of shared values that are kept on the cluster
SENDINGS = 5  # attempts to send a value or a task whose worker dies


class DaskPool(Pool):
    """The workers of an existing scheduler. If a worker dies, only its runs are lost, and they are repeated.

    Dask repeats a task whose worker died `distributed.scheduler.allowed-failures` times.
    Raises BenchError if there is no scheduler, no worker, or a worker with another version of this program.
    """

    def __init__(self, address: str) -> None:
        self.address = address
        try:
            self._client = distributed.Client(address, timeout=CONNECTING, set_as_default=False)
        except (OSError, TimeoutError, ValueError) as error:
            raise BenchError(f"no Dask scheduler at {address}: {error}") from error
        self._done: queue.Queue[int] = queue.Queue()
        self._futures: dict[int, Any] = {}
        self._tasks: dict[int, tuple[Task, Shared | None, int]] = {}  # last: how often it was sent
        self._shared: dict[str, Any] = {}
        self._counted, self._slots = -COUNT_EVERY, 0
        try:
            self._client.wait_for_workers(1, timeout=CONNECTING)
            _check_versions(self._client)
        except TimeoutError:
            self.close()
            raise BenchError(f"the Dask scheduler at {address} has no worker") from None
        except BenchError:
            self.close()
            raise

    @property
    def slots(self) -> int:
        """Current number of threads of all workers."""
        if time.monotonic() - self._counted > COUNT_EVERY:
            try:
                self._slots = sum(self._client.nthreads().values())
            except OSError as error:
                raise self._gone() from error
            self._counted = time.monotonic()
        return max(1, self._slots)

    def submit(self, key: int, task: Task, shared: Shared | None = None) -> None:
        """Queue a task."""
        self._send(key, task, shared, 1)

    def _send(self, key: int, task: Task, shared: Shared | None, sendings: int) -> None:
        self._tasks[key] = task, shared, sendings
        arguments = () if shared is None else (self._placed(shared),)
        future = self._client.submit(attempt, task, *arguments, pure=False)
        self._futures[key] = future
        future.add_done_callback(lambda _: self._done.put(key))

    def outcomes(self) -> list[Outcome]:
        """Wait until a task ends, at most for a second, and return all that have ended."""
        keys = []
        try:
            keys.append(self._done.get(timeout=1.0))
            while True:
                keys.append(self._done.get_nowait())
        except queue.Empty:
            pass
        ended = {key: self._futures.pop(key) for key in keys}
        values = self._gathered({key: entry for key, entry in ended.items() if entry.status == "finished"})
        outcomes = []
        for key in keys:
            value, (task, shared, sendings) = values.get(key), self._tasks.pop(key)
            if value is not None:
                outcomes.append(Outcome(key, *value))
            elif ended[key].status != "error" and self._client.status == "running" and sendings < SENDINGS:
                # a worker died that held its value or the shared value
                self._send(key, task, shared, sendings + 1)
            else:
                outcomes.append(self._failed(key, ended[key]))
        return outcomes

    def close(self) -> None:
        """Cancel running tasks and disconnect from the cluster."""
        self._client.cancel(list(self._futures.values()))
        self._futures.clear()
        self._tasks.clear()
        self._shared.clear()
        self._client.close()

    def _placed(self, shared: Shared) -> Any:
        """The value on the cluster, sent once; the oldest values are removed."""
        if shared.name in self._shared and self._shared[shared.name].status != "finished":
            del self._shared[shared.name]  # lost with the worker that held it
        if shared.name not in self._shared:
            while len(self._shared) >= MOST_SHARED:
                del self._shared[next(iter(self._shared))]
            self._shared[shared.name] = self._scattered(shared.value)
        return self._shared[shared.name]

    def _scattered(self, value: Any) -> Any:
        """Send a value; if the receiving worker dies, it is sent to another."""
        for _ in range(SENDINGS):
            try:
                return self._client.scatter(value, hash=False, timeout=CONNECTING)
            except (OSError, TimeoutError):
                time.sleep(1.0)
        raise self._gone()

    def _gathered(self, futures: dict[int, Any]) -> dict[int, tuple[Any, str | None] | None]:
        """Results of `attempt` by key, fetched together; None or missing if the worker that held a result is lost.

        A slow answer is awaited as long as the scheduler is connected.
        """

        async def gather() -> Any:
            return await self._client.gather(futures, errors="skip", asynchronous=True)

        while futures:
            try:
                values: dict[int, tuple[Any, str | None] | None] = self._client.sync(
                    gather, callback_timeout=CONNECTING
                )
            except TimeoutError as late:
                if self._client.status != "running":
                    raise self._gone() from late
            except (OSError, CancelledError) as lost:
                raise self._gone() from lost
            else:
                return values
        return {}

    def _failed(self, key: int, future: Any) -> Outcome:
        """The outcome of a task without a value, with the reason."""
        try:
            error = future.exception(timeout=CONNECTING) if future.status == "error" else None
        except (OSError, TimeoutError) as lost:
            raise self._gone() from lost
        if error is None:
            raise self._gone()
        if isinstance(error, distributed.KilledWorker):
            return Outcome(key, None, "the worker died, and so did others that tried it again")
        return Outcome(key, None, f"{type(error).__name__}: {error}")

    def _gone(self) -> BenchError:
        return BenchError(
            f"the Dask scheduler at {self.address} is gone; finished runs are kept, and the same command resumes"
        )


def _check_versions(client: Any) -> None:
    """Raise BenchError unless all workers run the same versions as this process, so that a table has one version."""
    local = versions().columns()
    for worker, worker_versions in client.run(versions).items():
        theirs = worker_versions.columns()
        for name, version in local.items():
            if theirs.get(name) != version:
                different = f"{name} {theirs.get(name)}, local {version}"
                raise BenchError(f"the worker {worker} has {different}: install the same on both")
