"""What `make speed` and `make peers` print and keep."""

import json
import subprocess
import sys
from io import StringIO

import numpy as np
import pytest
from click.testing import CliRunner
from rich.console import Console

from bench.basics.errors import BenchError
from bench.benchmarks.peers.__main__ import EXPLANATION, HEADERS, Score, cells, scores_table
from bench.benchmarks.speed import sweep
from bench.benchmarks.speed.__main__ import MEASUREMENTS, main
from bench.benchmarks.speed.figures import HISTORY, SpeedFigure, append_history, figures_table, last_values
from bench.benchmarks.speed.memory import STATUS, peak_bytes
from bench.studies.sweep.summary import WIDE, table_console

SLOW = SpeedFigure("identify", 1.2, "s", 1.0)
GAIN = SpeedFigure("two workers over one", 1.9, "", 1.8, at_least=True)
FREE = SpeedFigure("report", 3.0, "s")
SCORES = [
    Score(
        "five_bar",
        True,
        "parabench, rest from CAD, with coulomb_friction",
        40,
        0.05,
        8e-4,
        0.962,
        2e-3,
        0.925,
    ),
    Score("five_bar", True, "mujoco.sysid, 0.25 ms step, as the truth", 1, 1.81, 0.0133, 0.0, None, None),
]


def printed(renderable, width):
    console = Console(file=StringIO(), width=width)
    console.print(renderable)
    return console.file.getvalue()


def test_limits_are_kept_or_not():
    assert [one.kept for one in (SLOW, GAIN, FREE)] == [False, True, True]


def test_every_figure_stands_beside_that_of_the_last_time(tmp_path):
    history = tmp_path / "speed" / "history.jsonl"
    assert last_values(history) == {}
    append_history([SLOW, FREE], history)
    append_history([SpeedFigure("identify", 0.6, "s", 1.0)], history)
    assert last_values(history) == {"identify": 0.6, "report": 3.0}
    assert {"cores", "commit", "version.mujoco"} <= set(json.loads(history.read_text().splitlines()[0]))
    rows = printed(figures_table([SLOW, GAIN, FREE], last_values(history)), 100).splitlines()[2:]
    assert [" ".join(row.split()) for row in rows] == [
        "identify 0.6 1.2 s +100 % ≤ 1",
        "two workers over one – 1.9 – ≥ 1.8",
        "report 3 3 s +0 %",
    ]


def test_every_figure_of_the_history_has_a_unit():
    records = [json.loads(line) for line in HISTORY.read_text(encoding="utf-8").splitlines()]
    assert [record["commit"] for record in records if set(record["units"]) != set(record["figures"])] == []
    units = {name: unit for record in records for name, unit in record["units"].items()}
    assert {"s", "×", "MB", "GB"} <= set(units.values())
    assert units["peak memory of a hexapod's diagnosis"] == "MB"


def test_a_spoilt_history_is_told_with_its_line(tmp_path):
    history = tmp_path / "history.jsonl"
    append_history([FREE], history)
    history.write_text(history.read_text() + "[]\n")
    with pytest.raises(BenchError, match=r"history\.jsonl: line 2: no speed record"):
        last_values(history)


def test_measurements_can_be_added_as_functions_without_arguments():
    assert len(set(MEASUREMENTS.values())) == len(MEASUREMENTS)
    assert MEASUREMENTS["sweep"] is sweep.sweep_figures


def test_an_unknown_part_is_refused():
    done = CliRunner().invoke(main, ["swep"])
    assert done.exit_code == 2
    assert "scheduling" in done.output


def test_a_sweep_that_does_not_start_is_no_quick_start(tmp_path):
    file = tmp_path / "sweep.toml"
    file.write_text('base = "six_bar"\n')
    with pytest.raises(BenchError, match=r"the sweep to be timed does not start: .*six_bar"):
        sweep._start_seconds(file, tmp_path / "out")


def test_timing_the_start_leaves_nothing_on_the_screen(tmp_path, capfd):
    file = tmp_path / "sweep.toml"
    file.write_text('base = "five_bar"\n')
    assert sweep._start_seconds(file, tmp_path / "out") > 0
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("width", [80, 100, WIDE])
def test_numbers_of_the_peers_are_never_cut(width):
    text = printed(scores_table(SCORES), width)
    assert "…" not in text
    for score in SCORES:
        for cell in cells(score)[1:]:
            assert cell in text
    assert max(map(len, text.splitlines())) <= width
    assert set(" ".join(HEADERS).split()) <= set(text.split())


def test_what_is_timed_of_the_peers_is_said():
    assert "once beforehand is not timed" in EXPLANATION


def test_a_log_is_wide_and_columns_are_obeyed():
    program = "from bench.studies.sweep.summary import table_console as c; print(c().width)"

    def width(**environment):
        done = subprocess.run(
            [sys.executable, "-c", program], env=environment, capture_output=True, check=True
        )
        return int(done.stdout)

    assert width() == WIDE
    assert width(COLUMNS="97") == 97
    assert table_console().width


@pytest.mark.skipif(not STATUS.is_file(), reason="no /proc: the system's own figure is all there is")
def test_the_memory_of_a_process_is_not_that_of_the_one_that_started_it():
    large = np.ones(20_000_000)
    program = "from bench.benchmarks.speed.memory import peak_bytes; print(peak_bytes())"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert 1e6 < int(found.stdout) < large.nbytes < peak_bytes()
