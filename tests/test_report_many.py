"""Pages of sweeps and of trials: what stands on them, and from which folders they can be written."""

import json
import re
from dataclasses import replace

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.cli.next_steps import after_trial
from bench.page.parts import Figure, PageTable
from bench.page.render import render_page
from bench.page.sweep_page import read_sweep, sweep_page
from bench.page.trial_page import again_line, read_trial, trial_page, trial_table
from bench.page.write_studies import write_sweep_report, write_trial_report
from bench.studies.sweep.charts import point_label, value_text
from bench.studies.sweep.metrics import axis_words
from docs.pictures.browser import opened
from tests.report_kit import Tags
from tests.sweep_stand_in import Accidents, StandIn, plan_of, run
from tests.trial_rows import trial_rows

HEAD = 'description = "Gains against mass"\nseeds = 5\nshow = ["gain_error"]\n'
SWEEP = HEAD + 'base = "five_bar"\n[axes]\n"payloads.disc.mass" = [0.2, 0.8]\nmethod = ["ls", "current"]\n'


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("swept")
    plan = plan_of(folder / "file", SWEEP)
    run(plan, folder / "out", work=StandIn(Accidents(refused=(3, 4))))
    return folder / "out"


@pytest.fixture(scope="module")
def tried(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tried")
    pq.write_table(pa.Table.from_pylist(trial_rows()), folder / "five_bar.parquet")
    return folder


def parts_of(page, name):
    (section,) = [one for one in page.sections if one.id == name]
    return section.parts


def checked(page):
    """A page of which every figure and table can be read, and what it says."""
    for section in page.sections:
        for part in section.parts:
            if isinstance(part, PageTable | Figure):
                assert part.title
                assert part.aid
    read = Tags(render_page(page))
    ids = [tag["id"] for _, tag in read.tags if "id" in tag]
    assert len(ids) == len(set(ids))  # a section must not hide the data of the figures
    return read.words


def test_a_sweep_says_what_it_gave_and_where_it_was_worst(swept):
    found = read_sweep(swept)
    page = sweep_page(found, ["bench sweep x -o y"])
    words = checked(page)
    assert page.verdict[0] == "Gains against mass: 20 runs, 18 came to an answer."
    assert len(page.verdict) == 3
    lines = {line.values: line.spreads["gain_error"].middle for line in found.summary.lines}
    worst = max(lines, key=lines.get)
    by_axis = dict(zip(found.summary.axes, worst, strict=True))
    place = " and ".join(f"{axis_words(axis)} {value}" for axis, value in by_axis.items())
    assert page.verdict[2].endswith(f"{place}.")
    assert "nothing moves" in words
    assert "bench sweep x -o y" in words
    assert "0.2, 0.8" in words


def test_the_title_of_a_sweep_whose_file_is_called_sweep_is_what_it_varies(swept):
    found = read_sweep(swept)
    assert found.name == "sweep"
    assert sweep_page(found, []).title == "Sweep of mass of payload disc and estimator"
    assert sweep_page(replace(found, name="mass"), []).title == "Sweep mass"


def test_a_sweeps_figure_shows_every_median_and_spread(swept):
    found = read_sweep(swept)
    _, figure = parts_of(sweep_page(found, []), "plots")
    (chart,) = figure.variants[""].charts
    series = chart.spec["panels"][0]["series"]
    drawn = sorted(value for one in series for value in one["mean"])
    assert drawn == pytest.approx(
        sorted(line.spreads["gain_error"].middle for line in found.summary.lines), rel=1e-4
    )
    assert all(
        low <= mid <= high
        for one in series
        for low, mid, high in zip(one["low"], one["mean"], one["high"], strict=True)
    )
    (table,) = parts_of(sweep_page(found, []), "numbers")
    assert len(table.rows) == len(found.summary.lines)


@pytest.fixture(scope="module")
def of_three_axes(tmp_path_factory):
    """A sweep over mass, noise and estimator, in which two runs failed."""
    folder = tmp_path_factory.mktemp("three")
    run(plan_of(folder / "file"), folder / "out", work=StandIn(Accidents(refused=(0, 7))))
    return folder / "out"


def test_a_matrix_shows_two_axes_and_asks_for_the_others(of_three_axes):
    found = read_sweep(of_three_axes)
    grid = parts_of(sweep_page(found, []), "plots")[0]
    (choice,) = grid.choices
    assert (choice.name, choice.options) == ("estimator", ("ls", "current"))
    medians = {
        tuple(map(point_label, line.values)): line.spreads["gain_error"].middle
        for line in found.summary.lines
    }
    axes = found.summary.axes
    for key, method in enumerate(choice.options):
        (cells,) = grid.variants[str(key)].charts[0].spec["panels"][0]["series"]
        assert len(cells["x"]) == 9
        for text, pick in zip(cells["texts"], cells["pick"], strict=True):
            assert pick["method"] == method
            assert text == value_text("gain_error", medians[tuple(pick[axis] for axis in axes)])
    shares = [
        share
        for one in grid.variants.values()
        for share in one.charts[0].spec["panels"][0]["series"][0]["share"]
    ]
    assert (min(shares), max(shares)) == (0.0, 1.0)
    assert (
        grid.title
        == "Largest gain error over noise of the current over its RMS and mass of payload disc [kg]"
    )
    (plot,) = parts_of(sweep_page(found, []), "plots")[1:]
    assert plot.aid.endswith("All values together of estimator.")


def test_one_axis_has_no_matrix(tmp_path):
    run(plan_of(tmp_path / "file", SWEEP.replace('method = ["ls", "current"]\n', "")), tmp_path / "out")
    page = sweep_page(read_sweep(tmp_path / "out"), [])
    assert all(chart.spec["panels"][0]["series"][0]["kind"] != "cells" for chart in charts_of(page, "plots"))


def charts_of(page, name):
    return [chart for part in parts_of(page, name) for one in part.variants.values() for chart in one.charts]


def test_every_run_stands_on_the_page_with_what_it_failed_of(of_three_axes):
    found = read_sweep(of_three_axes)
    (runs,) = parts_of(sweep_page(found, []), "each")
    assert [one.header for one in runs.columns] == [
        "run",
        "mass of payload disc [kg]",
        "noise of the current over its RMS",
        "estimator",
        "seed",
        "Largest gain error",
    ]
    rows = pq.read_table(of_three_axes / "runs.parquet").to_pylist()
    assert len(runs.columns[0].values) == len(rows) == 90
    assert set(runs.failed) == {"0", "7"}
    at = runs.columns[0].values.index(rows[5]["run"])
    mass, estimator = runs.columns[1], runs.columns[3]
    assert mass.labels[mass.values[at]] == str(rows[5]["payloads.disc.mass"])
    assert estimator.labels[estimator.values[at]] == rows[5]["method"]
    assert runs.columns[5].values[at] == pytest.approx(rows[5]["gain_error"], rel=1e-4)
    assert runs.command == f"bench view {of_three_axes}"


def test_a_click_on_a_cell_shows_its_runs_and_a_run_its_command(chromium, of_three_axes, tmp_path):
    path = write_sweep_report(of_three_axes, tmp_path / "page.html")
    page = opened(chromium, path)
    heard = []
    page.on("pageerror", lambda error: heard.append(str(error)))
    cell = page.locator("#plots rect.pick").nth(4)
    said = cell.get_attribute("aria-label")
    cell.focus()
    page.keyboard.press("Enter")
    runs = page.locator("#each")
    assert "5 of 90 runs" in runs.inner_text()
    shown = [select.evaluate("one => one.selectedOptions[0].text") for select in runs.locator("select").all()]
    assert ", ".join(shown[:3]) == said
    for row in (0, 3):
        runs.locator("tbody tr").nth(row).click()
    numbers = [runs.locator("tbody tr").nth(row).locator("td").first.inner_text() for row in (0, 3)]
    command = f"bench view {of_three_axes} --run {numbers[0]} --run {numbers[1]}"
    assert runs.locator("pre").inner_text() == command
    runs.locator("select").first.select_option("")
    assert "15 of 90 runs" in runs.inner_text()
    page.close()
    assert heard == []


def test_more_lines_than_colours_stand_in_charts_of_their_own(tmp_path):
    masses = [round(0.1 * (i + 1), 1) for i in range(9)]
    text = (
        SWEEP.replace("[0.2, 0.8]", str(masses))
        + '[[plots]]\nx = "method"\ny = "gain_error"\nlines = "payloads.disc.mass"\n'
    )
    run(plan_of(tmp_path / "file", text), tmp_path / "out")
    _, figure = parts_of(sweep_page(read_sweep(tmp_path / "out"), []), "plots")
    assert len(figure.variants[""].charts) == len(masses)


def test_an_axis_drawn_at_random_is_cut_into_parts(tmp_path):
    text = HEAD.replace("seeds = 5", "seeds = 60") + (
        'base = "five_bar"\n[axes]\n"gains.error" = { draw = "uniform", from = -0.1, to = 0.1 }\n'
        '[[plots]]\nx = "gains.error"\ny = "gain_error"\n'
    )
    run(plan_of(tmp_path / "file", text), tmp_path / "out")
    page = sweep_page(read_sweep(tmp_path / "out"), [])
    (figure,) = parts_of(page, "plots")
    (one,) = figure.variants[""].charts[0].spec["panels"][0]["series"]
    assert one["x"] == sorted(one["x"])
    assert 5 <= len(one["x"]) < 60
    assert "drawn for each seed" in checked(page)


def test_a_sweep_that_has_not_ended_is_refused(swept, tmp_path):
    for name in ("sweep.toml", "sweep.json"):
        (tmp_path / name).write_text((swept / name).read_text())
    with pytest.raises(BenchError, match="a sweep that has ended"):
        write_sweep_report(tmp_path, tmp_path / "report.html")
    assert not (tmp_path / "report.html").exists()


def test_a_trial_says_what_was_named_for_what(tried):
    found = read_trial(trial_table(tried))
    page = trial_page(found, ["again"])
    words = checked(page)
    assert page.verdict[0] == "A single hidden effect is named first in 67\u00a0% (2 of 3) of the cases."
    assert "1 of 2 datasets raised an alarm" in page.verdict[1]
    assert len(page.verdict) == 3
    assert "base tilt 1" in words
    assert "lost" in words
    assert "not kept" in words
    (matrix, *_) = parts_of(page, "confusion")
    (cells,) = matrix.variants[""].charts[0].spec["panels"][0]["series"]
    rows = matrix.variants[""].charts[0].spec["panels"][0]["y"]["categories"]
    columns = matrix.variants[""].charts[0].spec["x"]["categories"]
    shown = {
        (rows[y], columns[x]): text for x, y, text in zip(cells["x"], cells["y"], cells["texts"], strict=True)
    }
    assert shown["viscous friction (3)", "viscous friction"] == "2"
    assert shown["viscous friction (3)", "base tilt"] == "1"
    assert shown["nothing (2)", "unexplained"] == "1"


def test_a_trial_tells_how_it_was_run(tried, tmp_path):
    assert "--kinds nothing,one,two,outside --seeds 4" in again_line(read_trial(trial_table(tried)))
    assert "--kinds nothing,one,two,outside --seeds 8" in after_trial(trial_table(tried))
    pq.write_table(pa.Table.from_pylist(trial_rows()), tmp_path / "five_bar.parquet")
    (tmp_path / "five_bar").mkdir()
    (tmp_path / "five_bar" / "one.json").write_text(
        json.dumps({"effects": ["viscous_friction", "base_tilt"]})
    )
    assert "--effects viscous_friction,base_tilt" in again_line(read_trial(trial_table(tmp_path)))


def test_the_page_of_a_trial_names_the_scenario_and_the_duration_that_were_given(tried, tmp_path):
    table = trial_table(tried)
    (tmp_path / table.name).write_bytes(table.read_bytes())
    given = {"robot": "my robots/rig", "scenario": "delta_clean", "duration": 6.0}
    (tmp_path / table.stem).mkdir()
    (tmp_path / table.stem / "nothing.json").write_text(json.dumps({"effects": [], "given": given}))
    line = again_line(read_trial(trial_table(tmp_path)))
    assert line.startswith("bench trial 'my robots/rig' --scenario delta_clean --duration 6 ")


def test_trials_of_two_robots_are_told_apart(tried, tmp_path):
    for name in ("five_bar", "delta"):
        (tmp_path / f"{name}.parquet").write_bytes((tried / "five_bar.parquet").read_bytes())
    with pytest.raises(BenchError, match=re.escape(f"bench report {tmp_path / 'delta.parquet'}")):
        trial_table(tmp_path)
    path = write_trial_report(trial_table(tmp_path / "delta.parquet"), tmp_path / "delta.html")
    assert "<h1>How far a diagnosis of delta can be trusted</h1>" in path.read_text()


def test_the_command_takes_sweeps_and_trials(swept, tried, tmp_path, capsys):
    titles = {
        swept: "Sweep of mass of payload disc and estimator",
        tried: "How far a diagnosis of five_bar can be trusted",
    }
    for source, title in titles.items():
        page = tmp_path / "page.html"
        assert main(["report", str(source), "-o", str(page)]) == 0
        assert f"<h1>{title}</h1>" in page.read_text()
        assert capsys.readouterr().out.splitlines()[-1].startswith("next: bench t")
        assert (
            main(["report", str(source), "--with", "viscous_friction", "-o", str(tmp_path / "no.html")]) == 2
        )
    (tmp_path / "empty").mkdir()
    for source, said in (
        (tmp_path / "empty", "no sweep or trial"),
        (swept / "runs.parquet", "not the table of a trial"),
    ):
        capsys.readouterr()
        assert main(["report", str(source), "-o", str(tmp_path / "no.html")]) == 2
        assert said in capsys.readouterr().err
    assert not (tmp_path / "no.html").exists()


@pytest.mark.parametrize("width", [390, 1366])
def test_both_pages_are_drawn_in_a_browser(swept, tried, tmp_path, chromium, width):
    pages = (
        write_sweep_report(swept, tmp_path / "sweep.html"),
        write_trial_report(tried / "five_bar.parquet", tmp_path / "trial.html"),
    )
    for path in pages:
        heard = []
        page = chromium.new_page(viewport={"width": width, "height": 900})
        page.on("console", lambda message, heard=heard: heard.append(message.text))
        page.on("pageerror", lambda error, heard=heard: heard.append(str(error)))
        page.goto(path.as_uri())
        _read_to_the_end(page)
        assert heard == []
        assert page.evaluate("document.documentElement.scrollWidth") <= width
        for holder in page.locator("[data-figure]").all():
            assert holder.locator(".plot > svg").count() >= 1
        drawn = "[...document.querySelectorAll('svg *')].every((one) => !/NaN|Infinity/.test(one.outerHTML))"
        assert page.evaluate(drawn)
        page.close()


def _read_to_the_end(page):
    from docs.pictures.browser import scrolled

    scrolled(page)
