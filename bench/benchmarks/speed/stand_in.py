"""A sweep without work, with rows as wide as real ones, and the process of Dask's scheduler or workers.

Run as a module it is a scheduler or, with a scheduler's address and a number, that many workers in one process. It
prints its address, runs until its standard input ends, and prints its processor time, s, in between.
"""

import asyncio
import sys
import time
from contextlib import AsyncExitStack
from functools import partial
from typing import Any

from bench.studies.sweep.dask_pool import distributed
from bench.studies.sweep.journal import Row
from bench.studies.sweep.plan import Run
from bench.studies.sweep.run_plan import Work
from bench.studies.sweep.work import failed_row

LOCAL = "127.0.0.1"


def nothing(_: None) -> dict[str, Any]:
    """Replaces a design or a motion."""
    return {}


def rows_at_once(runs: tuple[Run, ...], _: None) -> list[Row]:
    """Replaces identifications: returns one row per run."""
    return [failed_row(run, "") | {"status": "ok", "reason": None, "gain_error": 0.0} for run in runs]


NO_WORK = Work(
    design=lambda _run: nothing,
    motion=lambda _run, _trajectories: nothing,
    runs=lambda runs, _trajectories: partial(rows_at_once, runs),
    failed=failed_row,
)
"""The tasks of a sweep that only schedules, sends and writes its journal."""


async def serve(address: str = "", workers: int = 1) -> None:
    """Run a scheduler, or `workers` workers of the one at `address`, until the standard input ends."""
    if address:
        made = [
            distributed.Worker(address, nthreads=1, memory_limit=0, dashboard=False) for _ in range(workers)
        ]
    else:
        made = [distributed.Scheduler(host=LOCAL, dashboard=False, dashboard_address=":0")]
    async with AsyncExitStack() as stack:
        await asyncio.gather(*(stack.enter_async_context(entry) for entry in made))
        before = time.process_time()
        _say(made[0].address)
        await asyncio.to_thread(sys.stdin.read)
        _say(f"{time.process_time() - before}")


def _say(text: str) -> None:
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    asyncio.run(serve(sys.argv[1], int(sys.argv[2])) if sys.argv[1:] else serve())
