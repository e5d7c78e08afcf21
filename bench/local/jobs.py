"""Commands that wait, run or have ended; one runs at a time, in the order of the requests."""

import asyncio
import time
from collections.abc import AsyncIterator, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from bench.basics.errors import BenchError
from bench.local.worker import CancelledError, DiedError, Worker

State = Literal["waiting", "running", "done", "refused", "cancelled", "ended"]
KEPT = 60  # jobs that are listed; their results are in files
OFTEN = 0.1  # s between two messages, at least
HEARTBEAT = 15.0  # s without a change after which an open page receives a message


@dataclass
class Job:
    """One command. step: the page's step that requested it; subject: the dataset, log, robot or model it works on.

    line: the command as typed; files: what it writes, relative to the folder; error: why it failed.
    """

    number: int
    step: str
    subject: str
    line: str
    files: Mapping[str, str]
    state: State = "waiting"
    phase: str = ""
    done: int = 0
    total: int | None = None
    seconds: float = 0.0
    output: str = ""
    error: str = ""
    began: float = field(default=0.0, repr=False)

    def as_json(self) -> dict[str, Any]:
        """The job as the page receives it."""
        answer = asdict(self)
        began = answer.pop("began")
        if self.state == "running":
            answer["seconds"] = time.monotonic() - began
        return answer


class Jobs:
    """The jobs of a server; every open page receives every change."""

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self._jobs: list[Job] = []
        self._turn = asyncio.Lock()
        self._running: set[asyncio.Task[None]] = set()
        self._changed = asyncio.Event()
        self._version = 0

    def as_json(self) -> list[dict[str, Any]]:
        """All jobs, oldest first."""
        return [job.as_json() for job in self._jobs]

    def start(self, step: str, subject: str, line: str, files: Mapping[str, str], words: list[str]) -> Job:
        """Queue a command; it runs after those before it."""
        number = self._jobs[-1].number + 1 if self._jobs else 1
        job = Job(number, step, subject, line, files)
        self._jobs = [*self._jobs, job][-KEPT:]
        task = asyncio.create_task(self._run(job, words))
        self._running.add(task)
        task.add_done_callback(self._running.discard)
        self.tell()
        return job

    def cancel(self, number: int) -> None:
        """End a running job, or remove a waiting one from the queue. Raises BenchError for any other."""
        job = next((queued for queued in self._jobs if queued.number == number), None)
        if job is None or job.state not in ("waiting", "running"):
            raise BenchError(f"nothing to cancel: no command {number} runs or waits")
        if job.state == "running":
            self._worker.cancel()
        else:
            self._over(job, "cancelled")

    def tell(self) -> None:
        """Notify every page of a change."""
        self._version += 1
        self._changed.set()
        self._changed = asyncio.Event()

    async def changes(self) -> AsyncIterator[int]:
        """Yield a number now and after every change, at most once in `OFTEN`; the same number again is a heartbeat."""
        while True:
            seen = self._version
            yield seen
            await asyncio.sleep(OFTEN)
            if self._version == seen:
                try:
                    await asyncio.wait_for(self._changed.wait(), HEARTBEAT)
                except TimeoutError:
                    continue

    async def _run(self, job: Job, words: list[str]) -> None:
        async with self._turn:
            if job.state != "waiting":
                return
            job.state, job.began = "running", time.monotonic()
            self.tell()
            progress = _Heard(self, job, asyncio.get_running_loop())
            try:
                answer = await asyncio.to_thread(self._worker.call, "command", {"words": words}, progress)
            except CancelledError:
                self._over(job, "cancelled")
            except DiedError as error:
                job.error = f"The command ended unexpectedly: {error}. Nothing half-written is left."
                self._over(job, "ended")
            else:
                job.output, job.error = answer["output"], answer["error"]
                self._over(job, "done" if answer["code"] == 0 else "refused")

    def _over(self, job: Job, state: State) -> None:
        job.seconds = time.monotonic() - job.began if job.began else 0.0
        said = "Cancelled; nothing was written." if state == "cancelled" else ""
        job.state, job.error = state, job.error or said
        self.tell()


class _Heard:
    """Progress of a job, reported from the thread that waits for the worker."""

    def __init__(self, jobs: Jobs, job: Job, loop: asyncio.AbstractEventLoop) -> None:
        self._jobs, self._job, self._loop = jobs, job, loop

    def phase(self, name: str, total: int | None = None) -> None:
        self._job.phase, self._job.done, self._job.total = name, 0, total
        self._loop.call_soon_threadsafe(self._jobs.tell)

    def advance(self, steps: int = 1) -> None:
        self._job.done += steps
        self._loop.call_soon_threadsafe(self._jobs.tell)
