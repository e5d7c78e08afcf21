"""Ten thousand runs, with a cheap stand-in for the work: cut off, killed, gone on with, summarised."""

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from bench.cli import main
from bench.studies.sweep.run_sweep import JOURNAL, TABLE
from tests.sweep_stand_in import plan_of

SEEDS, RUNS = 560, 10_080
CUT_AT, KILLED_AT = 7_000, 8_000
GROWTH = 4_000  # kB from the first thousand runs to the last; measured: 90


def command(folder):
    program = "from tests.sweep_stand_in import main; main()"
    return [sys.executable, "-c", program, str(folder / "sweep.toml"), str(folder / "out"), "0"]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """The folder of a sweep that nothing disturbed, with a note of its memory where there is /proc."""
    folder = tmp_path_factory.mktemp("undisturbed")
    assert plan_of(folder, seeds=SEEDS).size == RUNS
    if Path("/proc/self/status").exists():
        (folder / "memory.txt").touch()
    subprocess.run(command(folder), check=True)
    return folder


def test_cut_off_and_killed_the_table_is_the_same_to_the_last_bit(tmp_path, undisturbed):
    """As a loss of power in the middle of a line leaves it; killed twice from its start: test_sweep_run.py."""
    plan_of(tmp_path, seeds=SEEDS)
    shutil.copytree(undisturbed / "out", tmp_path / "out")
    (tmp_path / "out" / TABLE).unlink()
    journal = tmp_path / "out" / JOURNAL
    lines = journal.read_bytes().splitlines(keepends=True)
    journal.write_bytes(b"".join(lines[:CUT_AT]) + lines[CUT_AT][:10])
    with subprocess.Popen(command(tmp_path)) as process:
        while journal.read_bytes().count(b"\n") < KILLED_AT:
            assert process.poll() is None
            time.sleep(0.01)
        os.kill(process.pid, signal.SIGKILL)
    assert KILLED_AT <= journal.read_bytes().count(b"\n") < RUNS
    subprocess.run(command(tmp_path), check=True)
    assert journal.read_bytes().count(b"\n") == RUNS, "no run was made twice"
    assert (tmp_path / "out" / TABLE).read_bytes() == (undisturbed / "out" / TABLE).read_bytes()


def test_memory_does_not_grow(undisturbed):
    memory = undisturbed / "memory.txt"
    if not memory.exists():
        pytest.skip("no /proc to read the memory from")
    counts, kilobytes = zip(
        *(map(int, line.split()) for line in memory.read_text().splitlines()), strict=True
    )
    assert counts[0] < 2_100
    assert counts[-1] > 9_900
    assert kilobytes[-1] - kilobytes[0] < GROWTH, f"{kilobytes} kB at {counts} runs"


def test_all_are_in_the_table_and_in_its_summary(undisturbed, capsys):
    assert pq.read_metadata(undisturbed / "out" / TABLE).num_rows == RUNS
    assert main(["table", str(undisturbed / "out"), "--by", "seed", "--by", "method"]) == 0
    assert "1 … 47" in capsys.readouterr().out
    text = (undisturbed / "out" / "gain_error_by_seed_method.md").read_text()
    rows = [line.split(" | ") for line in text.splitlines()[2:-2]]
    assert len(rows) == 12 * 2
    assert sum(int(row[2]) for row in rows) == RUNS
