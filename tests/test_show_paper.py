"""Figures for papers: their widths, their fonts, and that the numbers beside them are those that are drawn."""

import csv
import re
import struct
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from matplotlib import pyplot as plt

from bench.cli import main
from bench.document.figures.diagnosis import moved
from bench.document.figures.paper import (
    WIDTHS,
    PaperFigure,
    PaperPanel,
    csv_of,
    error_figures,
    file_part,
    paper_figure,
    write_paper_figures,
)
from bench.document.figures.paper_model import diagnosis_figures, gain_figure
from bench.document.layout import PAPER
from tests.compared_kit import made, white
from tests.shown import dataset_of, identification_of
from tests.test_cli_diagnose import dataset, found, nothing  # noqa: F401 - fixtures

pytestmark = pytest.mark.pictures

MM = 72.0 / 25.4  # points


@pytest.fixture(scope="module")
def what():
    return made(
        lambda row, random: 0.1 * np.sign(row["velocity"]) + white(random),
        payloads=(None, "disc"),
        joints=("left", "right"),
    )


@pytest.fixture(scope="module")
def errors(what):
    return {one.name: one for one in error_figures(what)}


def rows_of(numbers, **wanted):
    """The rows of a table in which columns have these values, by column."""
    kept = [
        i
        for i in range(len(next(iter(numbers.values()))))
        if all(numbers[k][i] == v for k, v in wanted.items())
    ]
    return {name: [values[i] for i in kept] for name, values in numbers.items()}


@pytest.mark.parametrize("width", WIDTHS.values())
def test_means_and_points_in_the_table_are_those_drawn(errors, width):
    figure = errors["error_by_velocity"]
    axes = paper_figure(figure, width).axes
    assert [one.get_title(loc="left") for one in axes] == ["left", "right"]
    for place, joint in zip(axes, ("left", "right"), strict=True):
        for direction in ("forwards", "backwards"):
            drawn = next(line for line in place.get_lines() if line.get_label() == direction)
            table = rows_of(figure.numbers[""], motor=joint, direction=direction)
            np.testing.assert_array_equal(drawn.get_xdata(), table["velocity [rad/s]"])
            np.testing.assert_array_equal(drawn.get_ydata(), table["mean error [A]"])
            points = rows_of(figure.numbers["_points"], motor=joint, direction=direction)
            dots = next(
                line
                for line in place.get_lines()
                if line.get_marker() == "." and line.get_color() == drawn.get_color()
            )
            np.testing.assert_array_equal(dots.get_ydata(), points["error [A]"])


def test_currents_in_the_table_are_those_drawn(errors, what):
    name = what.series[0].recording
    figure = errors[f"currents_{name.removesuffix('.csv')}"]
    axes = paper_figure(figure, WIDTHS["two_columns"]).axes
    assert len(axes) == 4  # current and error of two motors
    for k, joint in enumerate(("left", "right")):
        table = rows_of(figure.numbers[""], motor=joint)
        measured, modelled = (line.get_ydata() for line in axes[2 * k].get_lines())
        (error,) = (line.get_ydata() for line in axes[2 * k + 1].get_lines())
        for drawn, column in ((measured, "measured"), (modelled, "modelled"), (error, "error")):
            np.testing.assert_array_equal(drawn[np.isfinite(drawn)], table[f"{column} [A]"])


@pytest.mark.parametrize(
    ("name", "column"),
    [("error_spectrum", "density of the error [A^2/Hz]"), ("error_autocorrelation", "autocorrelation")],
)
def test_lines_in_the_table_are_those_drawn(errors, name, column):
    axes = paper_figure(errors[name], WIDTHS["one_column"]).axes[1]
    drawn = next(line for line in axes.get_lines() if line.get_label() == "error")
    np.testing.assert_array_equal(drawn.get_ydata(), rows_of(errors[name].numbers[""], motor="right")[column])


def test_ladder_and_gains_in_the_table_are_those_drawn(found):  # noqa: F811 - the fixture
    figures = {one.name: one for one in diagnosis_figures(found)}
    assert set(figures) == {
        "ladder",
        "ranking",
        "gains_before_after",
        "parameters_before_after",
        "errors_before_after_check",
    }
    (axes,) = paper_figure(figures["ladder"], 88.0).axes
    drawn = {bars.get_label(): [bar.get_width() for bar in bars] for bars in axes.containers}
    table = figures["ladder"].numbers[""]
    assert drawn["fitted"] == table["error, fitted [%]"] == [100.0 * step.identify for step in found.ladder]
    assert drawn["not fitted"] == table["error, not fitted [%]"]
    (axes,) = paper_figure(figures["gains_before_after"], 88.0).axes
    table = figures["gains_before_after"].numbers[""]
    shares = 100.0 * (np.array(table["before"]) / np.array(table["after"]) - 1.0)
    np.testing.assert_allclose(np.asarray(axes.containers[0].lines[0].get_xdata(), float), shares, atol=1e-9)
    assert table["nominal"] == [one.nominal for one in moved(found, parameters=False)]
    panels = paper_figure(figures["errors_before_after_check"], 180.0).axes
    table = figures["errors_before_after_check"].numbers[""]
    before, after = (line.get_ydata() for line in panels[1].get_lines())
    np.testing.assert_array_equal(before, table["error of right before [A]"])
    np.testing.assert_array_equal(after, table["error of right after [A]"])


def test_an_axis_that_is_not_even_says_so(found):  # noqa: F811 - the fixture
    first, *others = found.ranking
    for evidence, scale in ((4700.0, "symlog"), (4.0, "linear")):
        ranking = (replace(first, evidence=evidence), *(replace(one, evidence=-1.3) for one in others))
        (figure,) = [
            one for one in diagnosis_figures(replace(found, ranking=ranking)) if one.name == "ranking"
        ]
        (axes,) = paper_figure(figure, min(WIDTHS.values())).axes
        assert axes.get_xscale() == scale
        assert ("logarithmic beyond ±10 nats" in axes.get_xlabel()) == (scale == "symlog")
        places = axes.transData.transform([(value, 0.0) for value in (-1.3, 0.0, evidence)])[:, 0]
        if scale == "symlog":
            assert (places[1] - places[0]) < 0.1 * (places[2] - places[1])  # near nothing, and looks so


def test_a_nominal_gain_stands_clear_of_the_intervals(found):  # noqa: F811 - the fixture
    (figure,) = [one for one in diagnosis_figures(found) if one.name == "gains_before_after"]
    drawn = paper_figure(figure, min(WIDTHS.values()))
    drawn.draw_without_rendering()
    (axes,) = drawn.axes
    (diamonds,) = [line for line in axes.get_lines() if line.get_label() == "nominal"]
    rows = axes.transData.transform([(0.0, y) for y in (*diamonds.get_ydata(), 0.28, -0.28)])[:, 1]
    point = drawn.dpi / 72.0
    room = abs(rows[0] - rows[-1]) - (diamonds.get_markersize() / 2.0 + 2.5 * PAPER.scale) * point
    assert room > 0.5 * point


def test_where_nothing_is_missing_there_is_a_ranking_alone(nothing):  # noqa: F811 - the fixture
    assert [one.name for one in diagnosis_figures(nothing)] == ["ranking"]


def test_gains_are_drawn_against_their_nominal_values(found):  # noqa: F811 - the fixture
    figure = gain_figure(found.after)
    (axes,) = paper_figure(figure, 88.0).axes
    drawn = np.asarray(axes.containers[0].lines[0].get_xdata(), float)
    np.testing.assert_allclose(drawn, figure.numbers[""]["change [%]"])


def test_pages_are_one_or_two_columns_wide_and_fonts_embedded(errors, tmp_path):
    paths = write_paper_figures(tmp_path / "out", [errors["error_spectrum"]])
    assert sorted(path.name for path in paths) == sorted(path.name for path in (tmp_path / "out").iterdir())
    assert {path.suffix for path in paths} == {".pdf", ".png", ".csv"}
    for path in paths:
        content = path.read_bytes()
        if path.suffix == ".csv":
            continue
        width = WIDTHS[path.stem.removeprefix("error_spectrum_")]
        if path.suffix == ".pdf":
            (box,) = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", content)
            assert float(box[0]) == pytest.approx(width * MM, abs=0.1)
            assert b"/FontFile2" in content
            assert b"/Type3" not in content
        else:
            pixels = struct.unpack(">II", content[16:24])[0]
            assert pixels == pytest.approx(width / 25.4 * PAPER.dpi, abs=1)
    assert plt.get_fignums() == []


def test_parts_of_recordings_have_files_of_their_own():
    names = ["run.csv", "run.csv (end)", "run 2.parquet", "v1.2 a.csv"]
    assert [file_part(one) for one in names] == ["run", "run_end", "run_2", "v1_2_a"]


def test_the_csv_reads_back_to_the_last_digit(tmp_path):
    numbers = {"a [m]": [0.1 + 0.2, float("nan"), -1e-300], "name, odd": ["x,y", None, "z"]}
    write_paper_figures(tmp_path, [PaperFigure("one", (PaperPanel(lambda axes: None, 30.0),), {"": numbers})])
    with (tmp_path / "one.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header == ["a [m]", "name, odd"]
    assert rows[1] == ["", ""]
    assert [float(row[0]) for row in (rows[0], rows[2])] == [0.1 + 0.2, -1e-300]
    assert rows[0][1] == "x,y"
    with pytest.raises(ValueError, match="argument 2"):
        csv_of({"a": [1.0, 2.0], "b": [1.0]})


def test_no_label_is_cut(errors, found):  # noqa: F811 - the fixture
    for figure in (*errors.values(), *diagnosis_figures(found), gain_figure(found.after)):
        for width in WIDTHS.values():
            drawn = paper_figure(figure, width)
            drawn.draw_without_rendering()
            page = drawn.bbox
            for axes in drawn.axes:
                texts = [axes.xaxis.label, axes.yaxis.label, *axes.get_yticklabels()]
                for text in [
                    one for one in texts if one.get_text() and one.get_visible() and axes.get_visible()
                ]:
                    box = text.get_window_extent()
                    assert page.x0 - 1 <= box.x0 <= box.x1 <= page.x1 + 1, (
                        figure.name,
                        width,
                        text.get_text(),
                    )


def test_ticks_of_wide_intervals_stand_apart(found):  # noqa: F811 - the fixture
    poor = [replace(one, std=20.0 * abs(one.value)) for one in found.before.parameters]
    wide = replace(found, before=replace(found.before, parameters=tuple(poor)))
    (figure,) = [one for one in diagnosis_figures(wide) if one.name == "parameters_before_after"]
    drawn = paper_figure(figure, min(WIDTHS.values()))
    drawn.draw_without_rendering()
    (axes,) = drawn.axes
    low, high = axes.get_xlim()
    labels = [
        text
        for at, text in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
        if low <= at <= high and text.get_text()
    ]
    boxes = sorted((text.get_window_extent() for text in labels), key=lambda box: box.x0)
    assert len(boxes) >= 3
    assert all(one.x1 < other.x0 for one, other in pairwise(boxes))


@pytest.fixture(scope="module")
def arm(arm):
    """Measurements of a two-link arm."""
    return arm / "data"


def test_the_command_draws_what_is_asked_for(arm, tmp_path, capsys):
    assert main(["figures", str(arm)]) == 0
    *listed, step = capsys.readouterr().out.splitlines()
    assert {"error_by_velocity", "error_spectrum", "drive_gains"} < set(listed)
    assert step.startswith(f"next: bench figures {arm} {listed[-1]} -o {arm}.figures    ")
    assert main(["figures", str(arm), "error_by_v", "--only", "drive", "-o", str(tmp_path)]) == 0
    names = {path.name for path in tmp_path.iterdir()}
    assert "error_by_velocity_two_columns.pdf" in names
    assert "drive_gains.csv" in names
    assert len(names) == 11
    told = capsys.readouterr().out
    assert told.count("(numbers)") == 3
    assert told.splitlines()[-1].startswith(f"next: bench diagnose {arm}    ")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["{arm}", "--only", "nonsense"], "nonsense: no such figure; there are currents_"),
        (["{arm}", "error_by_v", "nonsense"], "nonsense: no such figure"),
        (["{arm}"], "figures: give the names of those to draw, or --all; available: currents_"),
        (["{arm}", "--all", "ladder"], "--all does not accept names"),
        (["{tmp}"], "neither a dataset (dataset.toml) nor a result (report.json)"),
        (["{tmp}/model.json"], "neither a dataset"),
    ],
)
def test_a_mistake_is_one_line(arm, tmp_path, capsys, arguments, said):
    given = [one.format(arm=arm, tmp=tmp_path) for one in arguments]
    assert main(["figures", *given, "-o", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert out == ""
    assert err.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_an_identification_by_hand_has_all_its_figures(tmp_path):
    from bench.dataset.robot import load_robot
    from bench.residuals.motor import compared

    made_by_hand = dataset_of(load_robot("delta"))
    result = identification_of(made_by_hand)
    what = compared(made_by_hand.robot, made_by_hand.recordings, result.recordings, result.settings)
    figures = error_figures(what)
    write_paper_figures(tmp_path, figures[:1])
    assert [one.name for one in figures][:3] == ["currents_unloaded", "currents_loaded", "currents_check"]
