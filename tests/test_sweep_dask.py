"""A sweep on a real Dask scheduler with two worker processes, one of which is killed in the middle."""

import os
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

from bench.basics.errors import BenchError
from bench.basics.versions import Versions
from bench.studies.sweep.pool import Shared
from bench.studies.sweep.run_sweep import JOURNAL, TABLE
from tests.sweep_stand_in import Accidents, StandIn, plan_of, run

STARTING = 60.0  # s
ACCIDENTS = Accidents(refused=(3,), broken=(9,))
QUIET = {
    **os.environ,
    "DASK_DISTRIBUTED__DASHBOARD__LINK": "",
    "OPENBLAS_NUM_THREADS": "1",
    "PYTHONWARNINGS": "ignore",
}


def started(module, *arguments):
    return subprocess.Popen(
        [sys.executable, "-m", module, *arguments],
        env=QUIET,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """The address of a scheduler, and its process before those of its two workers; each test leaves less of it."""
    folder = tmp_path_factory.mktemp("cluster")
    file = folder / "scheduler.json"
    processes = [
        started(
            "distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--host", "127.0.0.1",
            "--scheduler-file", str(file),
        )
    ]  # fmt: skip
    worker = ["--scheduler-file", str(file), "--nthreads", "1", "--no-nanny", "--no-dashboard"]
    local = ["--local-directory", str(folder)]
    try:
        processes += [started("distributed.cli.dask_worker", *worker, *local) for _ in range(2)]
        yield address_of(file), processes
    finally:
        for process in processes:
            process.kill()
            process.wait()


def address_of(file):
    import json

    deadline = time.monotonic() + STARTING
    while True:
        if file.exists() and (text := file.read_text()):
            return json.loads(text)["address"]
        assert time.monotonic() < deadline, "the scheduler does not start"
        time.sleep(0.05)


@pytest.mark.filterwarnings("ignore")
def test_tasks_whose_shared_value_is_lost_are_sent_again(cluster):
    """As where it was only on a worker that died: the scheduler then cancels all that need it."""
    from bench.studies.sweep.dask_pool import DaskPool

    pool, shared = DaskPool(cluster[0]), Shared("motion", 40)
    try:
        for key in range(6):
            pool.submit(key, partial(slowly_added, key), shared)
        pool._client.cancel([pool._shared["motion"]])
        ended = {}
        while len(ended) < 6:
            ended |= {outcome.key: outcome.value for outcome in pool.outcomes()}
        assert ended == {key: 40 + key for key in range(6)}
    finally:
        pool.close()


def slowly_added(key, value):
    time.sleep(0.2)
    return value + key


@pytest.mark.filterwarnings("ignore")
def test_one_worker_is_killed_and_the_table_is_the_same_to_the_last_bit(tmp_path, cluster):
    from bench.studies.sweep.dask_pool import DaskPool

    address, (_, *workers) = cluster
    here = run(
        plan_of(tmp_path / "here"),
        tmp_path / "here" / "out",
        work=StandIn(Accidents(refused=(3,), broken=(9,))),
    )
    killed = []

    def kill_one(journal):
        if journal.count > 20 and not killed:
            killed.append(workers[0].pid)
            os.kill(workers[0].pid, signal.SIGKILL)

    def pool():
        pool = DaskPool(address)
        pool._client.wait_for_workers(2, timeout=STARTING)
        return pool

    work = StandIn(ACCIDENTS, pause=0.02)
    there = run(plan_of(tmp_path / "there"), tmp_path / "there" / "out", pool, work, kill_one)
    assert killed
    assert there.failed == here.failed == 2
    assert there.table.read_bytes() == here.table.read_bytes()


@pytest.mark.filterwarnings("ignore")
def test_a_scheduler_that_goes_away_is_told_and_what_is_finished_is_kept(tmp_path, cluster):
    from bench.studies.sweep.dask_pool import DaskPool

    address, (scheduler, *_) = cluster

    def kill(journal):
        if journal.count > 20:
            scheduler.kill()

    plan = plan_of(tmp_path / "plan")
    with pytest.raises(BenchError, match=r"scheduler at .* is gone; finished runs are kept"):
        run(plan, tmp_path / "out", lambda: DaskPool(address), StandIn(pause=0.01), kill)
    kept = (tmp_path / "out" / JOURNAL).read_bytes().count(b"\n")
    assert 20 < kept < 90
    run(plan, tmp_path / "out")
    assert (tmp_path / "out" / TABLE).exists()


def test_no_scheduler_is_told_in_one_line(monkeypatch):
    from bench.studies.sweep import dask_pool

    monkeypatch.setattr(dask_pool, "CONNECTING", 0.3)
    with pytest.raises(BenchError, match=r"no Dask scheduler at tcp://127\.0\.0\.1:9"):
        dask_pool.DaskPool("tcp://127.0.0.1:9")


def test_a_worker_with_another_version_is_refused():
    from bench.studies.sweep.dask_pool import _check_versions

    class Client:
        def run(self, function):
            own = function()
            return {
                "tcp://node7:4": Versions(own.python, (("mujoco", "3.9.0"), *own.packages[1:]), own.commit)
            }

    with pytest.raises(BenchError, match=r"the worker tcp://node7:4 has "):
        _check_versions(Client())
