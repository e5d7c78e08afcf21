"""Where a model fails, as a person sees it: tables that fit, pictures that hold what was computed, the command."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot as plt
from matplotlib.figure import Figure
from rich.cells import cell_len
from rich.console import Console

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.document.charts.chart import Binned
from bench.document.charts.motor import against_chart
from bench.document.figures.comparison import currents_figure, errors_figure, write_comparison_figures
from bench.document.figures.draw import draw, worth_drawing
from bench.document.layout import SCREEN
from bench.document.terminal.identification import where_report
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.residuals.error_breakdown import error_breakdown
from bench.residuals.motor import compared
from bench.residuals.profile import profile, values_of
from bench.residuals.residuals import errors_by_motor
from bench.truth.dataset import write_simulation
from tests.compared_kit import ROWS, SETTINGS, made, one_recording, robot, white
from tests.hidden_kit import scenario, simulate

pytestmark = pytest.mark.pictures


@pytest.fixture(scope="module")
def what():
    """Two motors with Coulomb friction that the model lacks, and a payload."""
    return made(
        lambda row, random: 0.1 * np.sign(row["velocity"]) + white(random),
        payloads=(None, "disc"),
        joints=("left", "right"),
    )


@pytest.mark.parametrize("width", [80, 100, 120])
def test_the_report_fits_and_names_every_motor(what, width):
    console = Console(file=io.StringIO(), width=width)
    where_report(errors_by_motor(what), console)
    text = console.file.getvalue()
    assert max(cell_len(line) for line in text.splitlines()) <= width
    said = " ".join(text.split())
    for joint in what.joints:
        assert f"motor {joint}: error " in said
        assert f"motor {joint}: 96 % of the squared error follows the direction of motion" in said
    assert ("with payload disc" in text) == (width >= 100)


def test_the_means_drawn_are_those_of_all_rows(what):
    series = what.of("left")
    axes = errors_figure(what, "left").axes
    assert len(axes) == 12
    by_label = {line.get_label(): line for line in axes[2].get_lines()}
    velocity = np.concatenate([values_of(one, "velocity") for one in series])
    errors = np.concatenate([one.error for one in series])
    forwards = velocity > 0
    expected = profile(velocity[forwards], errors[forwards], SCREEN.bins)
    np.testing.assert_allclose(by_label["forwards"].get_ydata(), expected.mean)
    np.testing.assert_allclose(by_label["forwards"].get_xdata(), expected.center)
    assert [axis.get_xlabel() for axis in axes[:5]] == [
        "time from the start of the recording [s]",
        "position [rad]",
        "velocity [rad/s]",
        "acceleration [rad/s²]",
        "modelled current [A]",
    ]


def test_no_outlier_is_left_out_or_out_of_sight():
    rows = np.random.default_rng(3).normal(size=40000)
    x = np.linspace(0.0, 1.0, len(rows))
    rows[[11, 12345, 30001]] = (9.0, -30.0, 8.0)
    bins = profile(x, rows, SCREEN.bins)
    means = (bins.edges, bins.center, bins.mean, bins.spread, bins.mean, bins.mean, bins.count)
    drawn = worth_drawing(Binned("", "forwards", x, rows, *means), 2000)
    assert {11, 12345, 30001} <= set(drawn.tolist())
    assert len(drawn) < 2500
    far = np.abs(rows) > 3.2
    assert set(np.flatnonzero(far).tolist()) <= set(drawn.tolist())


def test_errors_beyond_the_axes_are_marked_at_their_border(what):
    joint = what.joints[0]
    series = [
        replace(one, modelled=one.modelled - 50.0 * (np.arange(len(one.time)) == 7)) for one in what.of(joint)
    ]
    axes = Figure().subplots()
    draw(axes, against_chart(replace(error_breakdown(what, joint), series=tuple(series)), "position"))
    top = axes.get_ylim()[1]
    assert top < 1.0
    marks = [line for line in axes.get_lines() if line.get_marker() == 6]
    assert sum(len(line.get_xdata()) for line in marks) == len(series)
    for line in marks:
        assert (line.get_ydata() < top).all()


def test_currents_have_gaps_where_a_joint_stands_still():
    moving = np.ones((ROWS, 1), dtype=bool)
    moving[100:120] = False
    recording, series = one_recording(lambda row, random: white(random), moving=moving)
    still = compared(robot(), [recording], [series], SETTINGS)
    upper, lower = currents_figure(still).axes
    measured = upper.get_lines()[0].get_ydata()
    assert np.isnan(measured).sum() == 1
    np.testing.assert_array_equal(measured[~np.isnan(measured)], series.measured[moving[:, 0], 0])
    np.testing.assert_array_equal(np.isnan(lower.get_lines()[0].get_ydata()), np.isnan(measured))


def test_pictures_are_whole_files_and_no_window_is_prepared(what, tmp_path):
    paths = write_comparison_figures(tmp_path / "deep", what)
    assert [path.name for path in paths] == ["currents.png", "errors_left.png", "errors_right.png"]
    assert sorted(path.name for path in (tmp_path / "deep").iterdir()) == sorted(path.name for path in paths)
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert plt.get_fignums() == []


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    """A two-link arm with friction at its shoulder that no model is told of."""
    folder = tmp_path_factory.mktemp("friction") / "data"
    hidden = {"effect": "coulomb_friction", "joint": "shoulder", "Fc": 3.0}
    longer = {"optimise": False, "duration": 8.0, "ramp": 0.5}
    write_simulation(simulate(scenario("two_link", [hidden], design=longer), threads=1), folder)
    return folder


def test_the_command_identifies_tells_and_draws(dataset, tmp_path, capsys):
    answer = tmp_path / "answer.json"
    assert main(["compare", str(dataset), "--json", str(answer), "-o", str(tmp_path / "figures")]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "motor shoulder: " in said
    assert "follows the direction of motion" in said
    content = json.loads(answer.read_text())
    assert {"robot", "model", "error", "recordings", "where", "noise_floor", "sentences"} <= set(content)
    assert set(content["where"]) == {"shoulder", "elbow"}
    assert content["where"]["shoulder"]["follows"][0]["variable"] == "direction"
    assert len(list((tmp_path / "figures").glob("*.png"))) == 3


def test_with_the_effect_named_the_error_is_gone_from_there(dataset, tmp_path):
    errors = {}
    for name, options in {"without": [], "with": ["--with", "coulomb_friction:shoulder"]}.items():
        answer = tmp_path / f"{name}.json"
        assert main(["compare", str(dataset), *options, "--json", str(answer)]) == 0
        errors[name] = json.loads(answer.read_text())["where"]["shoulder"]["error"]
    assert errors["with"] < 0.1 * errors["without"]


def test_a_saved_model_is_compared_as_it_is(dataset, tmp_path):
    model, answer = tmp_path / "model.json", tmp_path / "answer.json"
    assert main(["identify", str(dataset), "--json", str(model)]) == 0
    assert main(["compare", str(dataset), "--model", str(model), "--json", str(answer)]) == 0
    content = json.loads(answer.read_text())
    assert content["model"] == str(model)
    data = load_dataset(dataset)
    result = identify(prepare(problem_of(data)))
    whole = errors_by_motor(compared(data.robot, data.recordings, result.recordings, result.settings))
    assert content["where"]["shoulder"]["error"] == pytest.approx(whole.motors[0].error, rel=1e-6)


@pytest.mark.parametrize("more", [["--with", "viscous_friction"], ["--decimation", "10"]])
def test_a_saved_model_brings_its_own_effects_and_filters(dataset, tmp_path, capsys, more):
    assert main(["compare", str(dataset), "--model", str(tmp_path / "m.json"), *more]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert "--model" in err
