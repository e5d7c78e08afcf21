"""A sweep from start to table, with a stand-in for the work: resumed, interrupted, with failures."""

import itertools
import os
import signal
import subprocess
import sys
import time
import tracemalloc
from collections import Counter

import pyarrow.parquet as pq
import pytest

from bench.basics.errors import BenchError
from bench.studies.sweep.pool import LocalPool
from bench.studies.sweep.run_sweep import JOURNAL, TABLE
from tests.sweep_stand_in import NONE, Accidents, Inline, StandIn, plan_of, run


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Bytes of the table of a sweep that nothing disturbed, and the folder."""
    folder = tmp_path_factory.mktemp("undisturbed")
    finished = run(plan_of(folder), folder / "out")
    assert (finished.runs, finished.failed) == (90, 0)
    return finished.table.read_bytes()


def table_of(finished):
    return pq.read_table(finished.table).to_pydict()


def test_the_table_has_a_row_a_run_in_order(tmp_path):
    table = table_of(run(plan_of(tmp_path), tmp_path / "out"))
    assert table["run"] == list(range(90))
    assert set(table["status"]) == {"ok"}
    assert set(zip(table["seed"], table["method"], table["payloads.disc.mass"], strict=True)) == set(
        itertools.product(range(1, 6), ["ls", "current"], [0.2, 0.4, 0.8])
    )


@pytest.mark.parametrize("workers", [1, 3])
def test_the_table_does_not_depend_on_the_workers(tmp_path, undisturbed, workers):
    finished = run(plan_of(tmp_path), tmp_path / "out", lambda: LocalPool(workers))
    assert finished.table.read_bytes() == undisturbed


def test_a_motion_is_simulated_once(tmp_path):
    log = tmp_path / "motions"
    run(plan_of(tmp_path), tmp_path / "out", lambda: LocalPool(2), StandIn(log=log))
    assert list(Counter(log.read_text().split()).values()) == [1, 1, 1]


def test_a_motion_of_a_single_run_is_left_to_it(tmp_path):
    log = tmp_path / "motions"
    plan = plan_of(tmp_path, 'base = "five_bar"\n[axes]\n"payloads.disc.mass" = [0.1, 0.2, 0.3]')
    run(plan, tmp_path / "out", work=StandIn(log=log))
    assert not log.exists()


def test_killed_again_and_again_the_table_is_the_same_to_the_last_bit(tmp_path, undisturbed):
    plan_of(tmp_path)
    folder, journal = tmp_path / "out", tmp_path / "out" / JOURNAL
    program = "from tests.sweep_stand_in import main; main()"
    command = [sys.executable, "-c", program, str(tmp_path / "sweep.toml"), str(folder)]
    for kept in (12, 50):
        with subprocess.Popen([*command, "0.02"]) as process:
            while not journal.exists() or journal.read_bytes().count(b"\n") < kept:
                assert process.poll() is None
                time.sleep(0.005)
            os.kill(process.pid, signal.SIGKILL)
        lines = journal.read_bytes().count(b"\n")
        assert kept <= lines < 90
        assert not (folder / TABLE).exists()
    subprocess.run([*command, "0"], check=True)
    assert (folder / TABLE).read_bytes() == undisturbed
    assert journal.read_bytes().count(b"\n") == 90, "no run was made twice"


@pytest.mark.parametrize("cut", [1, 40, 200])
def test_a_line_that_was_cut_off_is_made_again(tmp_path, undisturbed, cut):
    plan = plan_of(tmp_path)
    finished = run(plan, tmp_path / "out")
    journal = tmp_path / "out" / JOURNAL
    content = journal.read_bytes()
    journal.write_bytes(content[:-cut])
    finished.table.unlink()
    assert run(plan, tmp_path / "out").table.read_bytes() == undisturbed


def test_a_journal_that_is_spoilt_is_refused(tmp_path):
    plan = plan_of(tmp_path)
    run(plan, tmp_path / "out")
    journal = tmp_path / "out" / JOURNAL
    journal.write_bytes(b"{]\n" + journal.read_bytes())
    with pytest.raises(BenchError, match="byte 0: not a row"):
        run(plan, tmp_path / "out")


def test_failed_runs_have_their_reason_and_the_rest_goes_on(tmp_path):
    accidents = Accidents(refused=(3,), broken=(10,), killed=(21,))
    finished = run(plan_of(tmp_path), tmp_path / "out", lambda: LocalPool(2), StandIn(accidents))
    table = table_of(finished)
    failed = {i: reason for i, reason in enumerate(table["reason"]) if reason is not None}
    assert finished.failed == 3
    assert failed[3] == "nothing moves"
    assert "ZeroDivisionError: a bug" in failed[10]
    assert "the worker died 3 times (signal SIGKILL)" in failed[21]
    assert [number for number, status in enumerate(table["status"]) if status == "failed"] == [3, 10, 21]
    assert table["gain_error"][3] is None


def test_a_worker_that_dies_once_leaves_no_trace(tmp_path, undisturbed):
    marks = tmp_path / "marks"
    marks.mkdir()
    accidents = Accidents(killed_once=(0, 17, 18, 60), marks=marks)
    finished = run(plan_of(tmp_path), tmp_path / "out", lambda: LocalPool(2), StandIn(accidents))
    assert finished.table.read_bytes() == undisturbed
    assert len(list(marks.iterdir())) == 4


def test_a_motion_that_fails_fails_its_runs_with_the_same_reason(tmp_path):
    finished = run(plan_of(tmp_path), tmp_path / "out", work=StandIn(Accidents(motionless=True)))
    assert finished.failed == 90
    assert set(table_of(finished)["reason"]) == {"the motion is impossible"}


def test_failed_runs_are_tried_again_on_request_only(tmp_path, undisturbed):
    plan = plan_of(tmp_path)
    first = run(plan, tmp_path / "out", work=StandIn(Accidents(broken=(4, 5))))
    assert (first.failed, first.kept) == (2, 0)
    told = []
    second = run(plan, tmp_path / "out", work=StandIn(NONE), resumed=told.append)
    assert (second.failed, second.kept) == (2, 90)
    finished = run(plan, tmp_path / "out", work=StandIn(NONE), retry_failed=True, resumed=told.append)
    assert (finished.failed, finished.kept) == (0, 88)
    assert told == [90, 88]
    assert finished.table.read_bytes() == undisturbed


def test_a_folder_of_another_sweep_is_refused(tmp_path):
    run(plan_of(tmp_path, seeds=2), tmp_path / "out")
    with pytest.raises(BenchError, match="holds another sweep"):
        run(plan_of(tmp_path, seeds=3), tmp_path / "out")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "letter.txt").write_text("")
    with pytest.raises(BenchError, match="holds no sweep"):
        run(plan_of(tmp_path, seeds=3), tmp_path / "mine")
    with pytest.raises(BenchError, match="is not a folder"):
        run(plan_of(tmp_path, seeds=3), tmp_path / "mine" / "letter.txt")
    assert [path.name for path in (tmp_path / "mine").iterdir()] == ["letter.txt"]


def test_a_full_disk_is_told_in_a_line_and_the_sweep_goes_on_later(tmp_path, undisturbed):
    resource = pytest.importorskip("resource", reason="no limits for the size of files here")
    plan = plan_of(tmp_path)
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (5000, before[1]))
    try:
        with pytest.raises(
            BenchError, match=r"out: (File too large|No space left).*finished runs are kept"
        ) as told:
            run(plan, tmp_path / "out")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert "\n" not in str(told.value)
    assert 4000 < (tmp_path / "out" / JOURNAL).stat().st_size <= 5000
    finished = run(plan, tmp_path / "out")
    assert finished.kept > 20
    assert finished.table.read_bytes() == undisturbed


def test_an_interrupt_keeps_what_is_finished(tmp_path, undisturbed):
    plan = plan_of(tmp_path)

    def interrupt(journal):
        if journal.count > 30:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        run(plan, tmp_path / "out", report=interrupt)
    assert 30 < (tmp_path / "out" / JOURNAL).read_bytes().count(b"\n") < 90
    assert run(plan, tmp_path / "out").table.read_bytes() == undisturbed


def test_memory_hardly_grows_with_the_runs(tmp_path):
    """Ten thousand of them, with what the whole process takes: test_sweep_ten_thousand.py."""

    def peak(seeds, name):
        plan = plan_of(tmp_path / name, seeds=seeds)
        tracemalloc.start()
        finished = run(plan, tmp_path / name / "out", Inline)
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert (finished.runs, finished.failed) == (18 * seeds, 0)
        return most

    peak(5, "first")  # what is imported on the way
    few, many = (
        peak(120, "few"),
        peak(200, "many"),
    )  # 2,160 runs, from which on all buffers are full, and 3,600
    assert many < few + 1_440 * 24, f"{(many - few) / 1_440:.0f} bytes a run"
