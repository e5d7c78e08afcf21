"""Summaries, tables and figures of sweeps."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.page.sweep_page import _over_all, _tiles
from bench.studies.sweep.plan import make_plan
from bench.studies.sweep.results import default_plots, write_plots, write_summary
from bench.studies.sweep.summary import (
    Summary,
    SummaryLine,
    explanation,
    share_interval,
    spread,
    summarise,
    summary_markdown,
)
from bench.studies.sweep.sweep_file import load_sweep
from tests.sweep_stand_in import Accidents, StandIn, plan_of, run

pytestmark = pytest.mark.pictures


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A finished sweep in which two runs failed."""
    folder = tmp_path_factory.mktemp("sweep")
    run(plan_of(folder, seeds=20), folder / "out", work=StandIn(Accidents(refused=(0, 7))))
    return folder / "out"


def test_a_summary_is_what_the_rows_say(folder):
    rows = pq.read_table(folder / "runs.parquet").to_pylist()
    summary = summarise(folder / "runs.parquet", ["payloads.disc.mass", "method"], ["gain_error"])
    assert [line.values for line in summary.lines] == [
        (m, e) for m in (0.2, 0.4, 0.8) for e in ("ls", "current")
    ]
    assert sum(line.failed for line in summary.lines) == 2
    for line in summary.lines:
        mass, method = line.values
        own = [row for row in rows if row["payloads.disc.mass"] == mass and row["method"] == method]
        values = [row["gain_error"] for row in own if row["gain_error"] is not None]
        found = line.spreads["gain_error"]
        assert (line.runs, found.count) == (len(own), len(values))
        assert (found.low, found.middle, found.high) == pytest.approx(np.quantile(values, [0.05, 0.5, 0.95]))


def test_intervals_of_a_share_hold_it_as_often_as_they_say():
    random = np.random.default_rng(3)
    hits = 0
    for _ in range(2000):
        low, high = share_interval(random.binomial(200, 0.95), 200)
        hits += low <= 0.95 <= high
    assert hits / 2000 == pytest.approx(0.95, abs=0.02)
    assert share_interval(0, 10)[0] == 0.0
    assert share_interval(10, 10)[1] == 1.0


def test_a_sweep_writes_summary_and_figures(folder):
    plan = plan_of(folder.parent, seeds=20)
    write_summary(plan, folder)
    text = (folder / "summary.md").read_text()
    assert text.count("\n| ") == 1 + 18
    assert "failed" in text
    paths = write_plots(plan, folder)
    assert paths
    before = [path.read_bytes() for path in paths]
    write_plots(plan, folder)
    assert [path.read_bytes() for path in paths] == before


@pytest.mark.parametrize(
    ("text", "against"),
    [
        ("seeds = 1", []),
        ("seeds = 1\n[axes]\nmethod = ['ls']", []),
        ("seeds = 3", ["seed", "seed"]),
        ("seeds = 3\n[axes]\nmethod = ['ls']", ["seed", "seed"]),
        ("seeds = 1\n[axes]\nmethod = ['ls', 'current']", ["method", "method"]),
    ],
)
def test_nothing_is_drawn_against_what_does_not_vary(text, against, tmp_path):
    (tmp_path / "one.toml").write_text(f"base = 'five_bar'\n{text}\n")
    plan = make_plan(load_sweep(tmp_path / "one.toml"))
    assert [plot.x for plot in default_plots(plan)] == against


@pytest.mark.parametrize("suffix", ["svg", "png", "pdf"])
@pytest.mark.parametrize("lines", [[], ["--lines", "method"]])
@pytest.mark.parametrize("x", ["payloads.disc.mass", "method", "seed"])
def test_figures_of_any_kind(folder, tmp_path, suffix, lines, x, capsys):
    target = tmp_path / f"figure.{suffix}"
    assert main(["plot", str(folder), "--x", x, "--y", "gain_error", *lines, "-o", str(target)]) == 0
    wrote, step = capsys.readouterr().out.splitlines()
    assert wrote == f"wrote {target} (figure)"
    assert step.startswith(f"next: bench view {folder}    ")
    assert target.stat().st_size > 2000


def test_table_prints_and_writes(folder, capsys):
    assert main(["table", str(folder), "--by", "method", "--show", "gain_error"]) == 0
    out = capsys.readouterr().out
    assert "current" in out
    path = folder / "gain_error_by_method.md"
    assert path.read_text().startswith("| method | runs | failed | gain_error |")
    *_, pooled, wrote, step = out.splitlines()
    assert pooled.startswith("values of payloads.disc.mass (3 values), sensors.current_noise_ratio")
    assert wrote == f"wrote {path} (summary)"
    assert step.startswith(f"next: bench plot {folder} --x method --y gain_error    ")
    assert main(["table", str(folder), "--by", "method", "--by", "payloads.disc.mass"]) == 0
    line = f"next: bench plot {folder} --x method --y gain_error --lines payloads.disc.mass    "
    assert capsys.readouterr().out.splitlines()[-1].startswith(line)
    assert main(["table", str(folder)]) == 0
    step = capsys.readouterr().out.splitlines()[-1]
    assert step.startswith(
        f"next: bench table {folder} --by payloads.disc.mass --by sensors.current_noise_ratio "
    )


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["table", "{folder}", "--by", "metod"], "no column 'metod'; did you mean method?"),
        (["table", "{folder}", "--show", "method"], "column 'method' does not hold numbers"),
        (["table", "{folder}/nowhere"], "holds no runs.parquet"),
        (["plot", "{folder}", "--x", "seed", "--y", "gain_eror"], "did you mean gain_error?"),
        (["sweep", "nonsense", "-o", "x"], "neither a built-in sweep"),
        (["sweep", "estimators"], "-o DIR"),
    ],
)
def test_mistakes_are_one_line(folder, arguments, told, capsys):
    assert main([part.format(folder=folder) for part in arguments]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert told in error


@pytest.fixture
def drawn(tmp_path):
    """A table in which every run has a mass of its own; three runs failed, one mass is not known."""
    random = np.random.default_rng(5)
    mass = [None, *random.uniform(0.0, 1.0, 503)]
    status = ["ok"] * 501 + ["failed"] * 3
    error = [1.0, *[value**2 for value in mass[1:501]], None, None, None]
    content = {"status": status, "mass": mass, "bits": [20, 16] * 252, "gain_error": error}
    pq.write_table(pa.table(content), tmp_path / "runs.parquet")
    return tmp_path


def test_a_drawn_axis_is_cut_into_parts_that_hold_every_run(drawn):
    summary = summarise(drawn / "runs.parquet", ["mass"], ["gain_error"], in_parts=True)
    *parts, unknown = summary.lines
    assert unknown.values == (None,)
    assert len(parts) == 12
    assert sum(line.runs for line in parts) == 503
    assert sum(line.failed for line in parts) == 3
    for line in parts:
        (part,) = line.values
        assert part.low < part.middle < part.high
        assert part.low**2 <= line.spreads["gain_error"].middle <= part.high**2
    assert [line.values[0].low for line in parts] == sorted(line.values[0].low for line in parts)
    few = summarise(drawn / "runs.parquet", ["bits"], ["gain_error"], in_parts=True)
    assert [line.values for line in few.lines] == [(16,), (20,)]


@pytest.mark.parametrize(("values", "runs", "lines"), [(36, 1, 12), (36, 2, 36), (12, 1, 12), (41, 3, 12)])
def test_values_of_a_single_run_each_are_put_together(tmp_path, values, runs, lines):
    x = list(np.linspace(1.0, 2.0, values)) * runs
    table = tmp_path / "runs.parquet"
    pq.write_table(pa.table({"status": ["ok"] * len(x), "condition": x, "gain_error": x}), table)
    assert len(summarise(table, ["condition"], ["gain_error"], in_parts=True).lines) == lines


def test_a_drawn_axis_is_shown_by_its_parts(drawn, capsys):
    assert main(["plot", str(drawn), "--x", "mass", "--y", "gain_error", "--linear"]) == 0
    assert main(["plot", str(drawn), "--x", "mass", "--y", "gain_error", "--lines", "bits"]) == 0
    assert main(["table", str(drawn), "--by", "mass"]) == 0
    assert capsys.readouterr().out.count(" … ") == 12


def test_ticks_of_a_logarithmic_axis_are_plain_numbers(folder, tmp_path):
    target = tmp_path / "figure.svg"
    x = "sensors.current_noise_ratio"
    assert main(["plot", str(folder), "--x", x, "--y", "gain_error", "-o", str(target)]) == 0
    text = target.read_text()
    assert all(f">{tick}<" in text for tick in ("0.001", "0.01", "0.1"))


def test_a_file_that_is_no_table_is_refused(tmp_path):
    (tmp_path / "runs.parquet").write_text("nothing")
    with pytest.raises(BenchError, match="cannot be read as a Parquet table"):
        summarise(tmp_path / "runs.parquet", [], ["gain_error"])


def test_a_number_that_rounds_up_to_another_digit_stays_readable() -> None:
    from bench.studies.sweep.summary import number

    assert number(99.7, 2) == "100"
    assert number(99.4, 2) == "99"
    assert number(0.0123, 2) == "0.012"
    assert number(12345.0) == "12345"


def test_a_single_run_has_a_value_and_no_spread():
    one = spread("gain_error", np.array([7e-5]))
    summary = Summary((), ("gain_error",), (SummaryLine((), 1, 0, {"gain_error": one}),))
    assert explanation(summary) == ""
    assert "brackets" not in summary_markdown(summary)
    said = _over_all("gain_error", one)
    assert "runs in ten" not in said
    assert said.endswith(": 0.007\xa0%.")
    (_, tile) = _tiles(SimpleNamespace(overall=summary.lines[0], metrics=("gain_error",)))
    assert (tile.value, tile.note) == ("0.007\xa0%", "")
    assert "median" not in tile.label
    two = SummaryLine((), 2, 0, {"gain_error": spread("gain_error", np.array([7e-5, 9e-5]))})
    assert "in brackets the middle 90 %" in explanation(replace(summary, lines=(two,)))
    assert "nine runs in ten" in _over_all("gain_error", two.spreads["gain_error"])
