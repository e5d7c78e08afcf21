"""The evaluation on a Dask scheduler with eight workers in this process, one of which is closed in the middle."""

from logging import CRITICAL
from pathlib import Path

import pytest

from bench.benchmarks.trust.cells import TrustCells
from bench.benchmarks.trust.evaluation import read_evaluation
from bench.benchmarks.trust.run import TrustRequest, run_trust, setups_of
from tests.sweep_stand_in import Inline
from tests.trust_stand_in import TrustStandIn

WORKERS = 8
HOURS = 1e6
PAUSE = 0.02  # s for each case


@pytest.mark.filterwarnings("ignore")
def test_a_worker_that_goes_away_changes_no_row(tmp_path: Path) -> None:
    import distributed

    from bench.studies.sweep.dask_pool import DaskPool

    cells = TrustCells(setups_of(["two_link"]), 5000)
    request = TrustRequest(cells.setups, "0.0, entry 5", cells.first, HOURS)
    closed = []

    def close_one(tally, _budget):
        def report(_journal):
            if tally.finished > 20 and not closed:
                worker = next(iter(cluster.workers.values()))
                closed.append(worker)
                cluster.loop.add_callback(worker.close, executor_wait=False)

        return report

    def pool():
        pool = DaskPool(cluster.scheduler_address)
        pool._client.wait_for_workers(WORKERS)
        return pool

    def rows(folder, make_pool, report, pause):
        path = run_trust(request, folder, make_pool, report, work=TrustStandIn(cells, pause=pause))
        return read_evaluation(path).rows

    with distributed.LocalCluster(
        n_workers=WORKERS,
        processes=False,
        threads_per_worker=1,
        dashboard_address=None,
        silence_logs=CRITICAL,
    ) as cluster:
        there = rows(tmp_path / "there", pool, close_one, PAUSE)
    alone = rows(tmp_path / "alone", Inline, lambda *_: lambda _: None, 0.0)
    assert closed
    assert len(there) == sum(len(cell.numbers) for cell in cells.all)
    assert there == alone
