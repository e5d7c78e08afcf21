"""Worker processes: results, failures, deaths."""

import os
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.studies.sweep import pool as module
from bench.studies.sweep.pool import ATTEMPTS, LocalPool, Shared


@dataclass(frozen=True)
class Task:
    """Answers `value` and what is shared; or refuses, breaks, or dies as often as told."""

    value: int = 0
    refuses: bool = False
    breaks: bool = False
    deaths: int = 0
    marks: Path | None = None

    def __call__(self, shared):
        if self.refuses:
            raise BenchError("the payload is too heavy")
        if self.breaks:
            return 1 / self.value
        if self.marks is not None and len(os.listdir(self.marks)) < self.deaths:
            (self.marks / f"{os.getpid()}").touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return self.value, shared, os.environ["OPENBLAS_NUM_THREADS"]


@pytest.fixture(scope="module")
def pool():
    pool = LocalPool(2)
    yield pool
    pool.close()


def processes(pool):
    return {worker.process.pid for worker in pool._workers}


def outcomes_of(pool, count):
    found = []
    while len(found) < count:
        found += pool.outcomes()
    return {outcome.key: outcome for outcome in found}


def test_every_task_is_answered_with_one_thread_each(pool):
    for key in range(20):
        pool.submit(key, Task(value=key))
    found = outcomes_of(pool, 20)
    assert {key: outcome.value for key, outcome in found.items()} == {k: (k, None, "1") for k in range(20)}


def test_reasons_of_failure_are_told(pool):
    pool.submit(1, Task(refuses=True))
    pool.submit(2, Task(breaks=True))
    pool.submit(3, Task(value=3))
    found = outcomes_of(pool, 3)
    assert found[1].fault == "the payload is too heavy"
    assert "ZeroDivisionError: division by zero (test_sweep_pool.py:" in found[2].fault
    assert found[3].fault is None


def test_a_task_whose_worker_dies_is_tried_again(pool, tmp_path):
    before = processes(pool)
    pool.submit(1, Task(value=7, deaths=ATTEMPTS - 1, marks=tmp_path))
    pool.submit(2, Task(value=8))
    found = outcomes_of(pool, 2)
    assert [found[key].value[0] for key in (1, 2)] == [7, 8]
    assert processes(pool) != before
    assert pool.slots == 2


def test_a_task_that_always_kills_its_worker_is_given_up(pool, tmp_path):
    pool.submit(1, Task(deaths=ATTEMPTS, marks=tmp_path))
    pool.submit(2, Task(value=5))
    found = outcomes_of(pool, 2)
    assert found[1].fault == f"the worker died {ATTEMPTS} times (signal SIGKILL)"
    assert found[2].value[0] == 5


def test_an_idle_worker_that_is_killed_is_replaced(pool):
    os.kill(min(processes(pool)), signal.SIGKILL)
    time.sleep(0.2)
    for key in range(6):
        pool.submit(key, Task(value=key))
    assert len(outcomes_of(pool, 6)) == 6


def test_shared_values_reach_the_tasks_they_belong_to(pool):
    values = [Shared("a", [1, 2]), Shared("b", [3]), None]
    for key in range(30):
        pool.submit(key, Task(value=key), values[key // 3 % 3])
    found = outcomes_of(pool, 30)
    for key in range(30):
        shared = values[key // 3 % 3]
        assert found[key].value[1] == (shared and shared.value)


def test_closing_stops_workers_at_once():
    pool = LocalPool(1)
    (process,) = processes(pool)
    pool.submit(0, time.sleep)  # called with None: fails, but only after the worker has started
    outcomes_of(pool, 1)
    pool.close()
    with pytest.raises(ProcessLookupError):
        os.kill(process, 0)


def test_a_script_without_a_guard_can_use_workers(tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        "from bench.studies.sweep.pool import LocalPool\n"
        "from tests.test_sweep_pool import Task, outcomes_of\n"
        "pool = LocalPool(1)\n"
        "pool.submit(1, Task(value=6))\n"
        "print(outcomes_of(pool, 1)[1].value[0])\n"
        "pool.close()\n"
    )
    for arguments, text in (([str(script)], None), (["-"], script.read_text())):
        done = subprocess.run(
            [sys.executable, *arguments], input=text, capture_output=True, text=True, check=True
        )
        assert done.stdout == "6\n", done.stderr


def test_workers_that_cannot_start_are_told_instead_of_tried_for_ever(monkeypatch):
    monkeypatch.setattr(module, "_work", _dies)
    pool = LocalPool(1)
    pool.submit(0, Task())
    with pytest.raises(BenchError, match="a worker process cannot start"):
        outcomes_of(pool, 1)
    pool.close()


def _dies(connection):
    os._exit(3)
