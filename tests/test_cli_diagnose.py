"""`bench diagnose`: what it prints, writes and draws, and that the model it writes serves on."""

import io
import json
from dataclasses import replace

import numpy as np
import pytest
from matplotlib import pyplot as plt
from rich.cells import cell_len
from rich.console import Console

from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.robot import load_robot
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.pruning import impossible_effects, refused
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.reason_words import reason_sentence
from bench.diagnosis.result import LadderStep
from bench.diagnosis.split import dataset_of as dataset_fitted
from bench.diagnosis.summary import doubts, error_share, motor_torques, reason, summary_sentences
from bench.document.diagnosis import ranking_table, size_words
from bench.document.figures.diagnosis import (
    errors_before_after_figure,
    gains_figure,
    ladder_figure,
    write_diagnosis_figures,
)
from bench.document.terminal.diagnosis import diagnosis_report
from bench.document.terminal.tables import bar
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.model_file import apply_model, load_model
from bench.identification.problem import problem_of
from bench.identification.result import Quantity, relative_error
from bench.page.verdict import diagnosis_verdict
from bench.residuals.motor import compared
from tests.diagnosis_kit import OTHERS, VISCOUS, found_diagnosis
from tests.shown import dataset_of

pytestmark = pytest.mark.pictures


@pytest.fixture(scope="module")
def dataset():
    return dataset_of(load_robot("five_bar"))


@pytest.fixture(scope="module")
def found(dataset):
    """Made by hand: viscous friction is missing at one motor."""
    return found_diagnosis(dataset)


@pytest.fixture(scope="module")
def nothing(found):
    """Made by hand: nothing is missing."""
    return replace(
        found,
        missing=(),
        ladder=(LadderStep((), 0.0099, 0.01),),
        ranking=OTHERS,
        after=found.before,
    )


def printed(diagnosis, width=80, **options):
    console = Console(file=io.StringIO(), width=width, force_terminal=False)
    diagnosis_report(diagnosis, console, **options)
    return console.file.getvalue()


@pytest.mark.parametrize("width", [80, 100, 120])
def test_the_report_fits_and_says_what_counts(found, width):
    text = printed(found, width)
    assert max(cell_len(line) for line in text.splitlines()) <= width
    said = " ".join(text.split())
    assert "Viscous friction at left is missing" in said
    assert (
        "judged on recordings that were not fitted, the error falls from 12 % to 1 % of the current" in said
    )
    assert "the noise floor is 0.98 %" in said
    assert "the drive gain of left is 3.63" in said
    assert "The remaining error (1 %) is at the noise floor of the currents (0.98 %)." in said
    for word in (
        "812.4",
        "indistinguishable",
        "absorbed",
        "+ viscous friction",
        "noise of the currents",
        "0.33 N·m",
    ):
        assert word in said
    assert said.index("is missing") < said.index("Ladder") < said.index("Ranking") < said.index("Drive gains")


def test_what_is_not_supported_is_only_named_unless_asked_for(found):
    short, long = printed(found), printed(found, verbose=True)
    assert "not supported, too: joint spring, torque ripple" in " ".join(short.split())
    assert "Adding joint spring gains nothing" not in short
    assert "not supported, too" not in long
    for one in OTHERS:
        assert reason_sentence(one) in " ".join(long.split())


def test_a_friction_that_drives_is_refused(found):
    friction = replace(CATALOGUE["stribeck_friction"])
    instances = [EffectInstance(friction, joint, "stribeck_friction") for joint in ("left", "right")]

    def model(left, right):
        values = {
            joint: {"Fc": Quantity(2.0, 0.1, "N*m"), "Fs": Quantity(fs, 0.1, "N*m")}
            for joint, fs in (("left", left), ("right", right))
        }
        return replace(found.after, effect_parameters={"stribeck_friction": values})

    (out,) = impossible_effects(model(-1.0, -2.0), instances).items()
    assert out[0] == "stribeck_friction"
    assert out[1] == Reason(Because.IMPOSSIBLE, ("Fs",))
    assert impossible_effects(model(-1.0, 1.0), instances) == {}  # at one joint it may be left out
    assert impossible_effects(model(-0.2, -0.2), instances) == {}  # two deviations are nothing
    verdict = refused(replace(VISCOUS, effect="stribeck_friction"), out[1])
    assert verdict.verdict == "not supported"
    assert "Stribeck friction would need a negative Fs" in reason_sentence(verdict)
    assert refused(VISCOUS, None) is VISCOUS


def test_columns_with_nothing_in_them_are_left_out(nothing):
    headers = [column.header for column in ranking_table(nothing, OTHERS[1:7]).columns]
    assert headers == ["effect", "verdict", "evidence", "without", "with it"]


def test_nothing_missing_is_said_first_and_nothing_moves(nothing):
    text = printed(nothing)
    assert "No effect of the catalogue is missing" in text
    assert "before and after" not in text
    assert json.loads(json.dumps(diagnosis_json(nothing), allow_nan=False))["missing"] == []


def test_alternatives_are_said_to_be_beyond_these_recordings(found):
    doubtful = replace(VISCOUS, verdict="indistinguishable", alternatives=("current_delay", "quadratic_drag"))
    said = summary_sentences(replace(found, ranking=(doubtful, *OTHERS)))
    (line,) = [one for one in said if "could also be" in one]
    assert "current delay or quadratic drag" in line
    assert "these recordings cannot distinguish them" in line
    assert "To distinguish them: move fast and slowly; reverse fast; move as fast as allowed." in line
    assert (
        "The motion is designed by `bench discriminate DATASET viscous_friction current_delay -o DIR`."
        in line
    )


def test_an_improbable_alternative_is_said_to_be_less_probable_but_not_excluded(found):
    named = replace(VISCOUS, verdict="indistinguishable", alternatives=("current_delay",), probability=0.997)
    rival = replace(OTHERS[0], probability=0.003)
    both = replace(found, ranking=(named, rival, *OTHERS[1:]))
    assert "current delay in its place is less probable (< 0.01), but" in reason_sentence(named)
    assert reason_sentence(rival) == (
        "Current delay in place of viscous friction is less probable (< 0.01), but these data do not exclude it."
    )
    said = " ".join(summary_sentences(both))
    assert "could also be current delay, which is less probable (< 0.01), but not excluded." in said
    assert "odds of 20,000 to 1; a probability of 0.99 is odds of 100 to 1" in " ".join(printed(both).split())
    assert "current delay, which is less probable (< 0.01)" in " ".join(diagnosis_verdict(both))
    assert "as well as" in reason_sentence(replace(rival, probability=0.3))
    assert "cannot distinguish it from" in reason_sentence(replace(named, probability=0.7))


def test_nominal_gains_hold_the_verdict_back(found):
    nominal = replace(found, after=replace(found.after, gains_fitted=False))
    said = " ".join(summary_sentences(nominal))
    assert said.startswith("Viscous friction at left seems to be missing")
    assert "the named effects may be wrong" in said
    assert "weighed payload" in said
    gain = {"left": found.after.drive_gains["left"]}
    alone = replace(nominal, after=replace(nominal.after, drive_gains=gain))
    assert "the named effects may be wrong" not in " ".join(
        doubts(alone)
    )  # one motor: a gain scales everything alike


def test_recordings_that_do_not_belong_are_said_at_once(found):
    error = replace(found.after.error, identify=0.01, validate=0.2)
    swapped = replace(found, after=replace(found.after, error=error))
    said = summary_sentences(swapped)
    assert "seems to be missing" in said[0]
    assert said[1].startswith(
        "The named effects may be wrong. The error of recordings that were not fitted (20 %)"
    )
    assert "is declared to carry" in said[1]
    none = replace(swapped, missing=(), ladder=found.ladder[:1], ranking=OTHERS)
    assert "is declared to carry" in summary_sentences(none)[1]


def test_an_effect_everywhere_or_of_the_whole_robot_names_no_single_motor(found):
    everywhere = replace(VISCOUS, actuators=("left", "right"))
    assert "friction at all motors is missing" in summary_sentences(replace(found, ranking=(everywhere,)))[0]
    whole = {"viscous_friction": {"robot": found.after.effect_parameters["viscous_friction"]["left"]}}
    of_robot = replace(found, ranking=(everywhere,), after=replace(found.after, effect_parameters=whole))
    assert summary_sentences(of_robot)[0].startswith("Viscous friction is missing")


def test_a_reason_carries_its_size_in_torque_and_in_percent(found):
    torque = motor_torques(found.after)["left"]
    fitted = np.concatenate([one.measured[:, 0] for one in found.after.recordings if one.use == "identify"])
    assert torque == pytest.approx(3.63 * np.sqrt(np.mean(fitted**2)))
    text = reason(found, VISCOUS)
    assert text.startswith(reason_sentence(VISCOUS).rstrip("."))
    assert f"0.33 N·m at left ({100 * 0.33 / torque:.2g} % of its torque)" in text
    assert "; viscous friction has an RMS of 0.33" in text  # "it" could be an alternative
    assert text.endswith("removes 99 % of the squared error.")
    assert error_share(VISCOUS) == pytest.approx(0.99)
    assert (
        size_words(found, VISCOUS).replace("\N{NO-BREAK SPACE}", " ")
        == f"0.33 N·m ({100 * 0.33 / torque:.2g} %)"
    )
    gains = dict(found.after.drive_gains)
    gains["right"] = replace(gains["right"], unit="N/A")
    slides = replace(found, after=replace(found.after, drive_gains=gains, recordings=()))
    both = replace(VISCOUS, size={"left": 0.33, "right": 12.0})
    assert (
        size_words(slides, both).replace("\N{NO-BREAK SPACE}", " ") == "12 N, 0.33 N·m"
    )  # never 0.33 to 12 of one of them
    assert reason(found, OTHERS[0]) == reason_sentence(OTHERS[0])


def test_bars_are_as_long_as_their_shares():
    assert bar(1.0, 10) == "█" * 10
    assert bar(0.5, 10) == "█" * 5
    assert bar(0.0, 10) == "▏"
    assert bar(0.55, 10) == "█████▌"


def test_the_answer_has_the_promised_keys(found):
    answer = json.loads(json.dumps(diagnosis_json(found), allow_nan=False))
    assert answer["missing"] == ["viscous_friction"]
    assert answer["ladder"] == [
        {"effects": [], "error": {"identify": 0.11, "validate": 0.12}},
        {"effects": ["viscous_friction"], "error": {"identify": 0.0099, "validate": 0.01}},
    ]
    promised = {
        "effect",
        "error_before",
        "error_after",
        "evidence",
        "verdict",
        "actuators",
        "alternatives",
        "why",
    }
    assert all(promised <= set(one) for one in answer["ranking"])
    assert {one["verdict"] for one in answer["ranking"]} == {
        "missing",
        "not supported",
        "indistinguishable",
        "absorbed",
    }
    assert {"significant", "error", "noise_floor", "depends_on"} <= set(answer["unexplained"])
    assert answer["after"]["drive_gains"]["left"]["value"] == 3.63
    assert answer["before"]["drive_gains"]["left"]["value"] == pytest.approx(3.3)


def test_numbers_that_json_does_not_have_become_null(found):
    endless = replace(VISCOUS, evidence=float("inf"), error_before=0.0)
    (first, *_) = diagnosis_json(replace(found, ranking=(endless, *OTHERS)))["ranking"]
    assert first["evidence"] is None
    assert first["error_share"] is None


def test_the_ladder_is_drawn_as_it_is(found):
    (axes,) = ladder_figure(found).axes
    drawn = {bars.get_label(): [bar.get_width() for bar in bars] for bars in axes.containers}
    np.testing.assert_allclose(drawn["fitted"], [11.0, 0.99])
    np.testing.assert_allclose(drawn["not fitted"], [12.0, 1.0])
    (floor,) = axes.get_lines()
    assert floor.get_label() == "noise of the currents, 0.980 %"
    np.testing.assert_allclose(floor.get_xdata(), 0.98)
    assert axes.get_xlim()[0] == 0.0


def test_errors_before_and_after_are_those_of_recordings_not_fitted(found):
    axes = errors_before_after_figure(found).axes
    assert len(axes) == 2  # two motors, one recording
    (unseen,) = [one for one in found.before.recordings if one.use == "validate"]
    assert unseen.name in axes[0].get_title(loc="left")
    before, after = (line.get_ydata() for line in axes[0].get_lines())
    np.testing.assert_allclose(before[3:], unseen.error[3:, 0])
    np.testing.assert_allclose(after[3:], unseen.error[3:, 0])


def test_where_nothing_is_missing_one_curve_says_so(nothing):
    for axes in errors_before_after_figure(nothing).axes:
        (line,) = axes.get_lines()
        assert line.get_label() == "the model as it is: nothing is missing"


def test_gains_are_drawn_against_what_they_are_after(found):
    (axes,) = gains_figure(found).axes
    names = [label.get_text() for label in axes.get_yticklabels()]
    assert names == [
        "gain left [N·m/A]",
        "gain right [N·m/A]",
        "mx(left_crank) [kg·m]",
        "m(left_rod) [kg·m²]",
    ]
    before = axes.containers[0].lines[0].get_xdata()
    assert before[0] == pytest.approx(100.0 * (3.3 / 3.63 - 1.0))
    assert before[1] == pytest.approx(0.0)


def errors_left(diagnosis, dataset):
    after = diagnosis.after
    logged = dataset_fitted(dataset, after.recordings).recordings
    return compared(dataset.robot, logged, after.recordings, after.settings)


def test_pictures_are_whole_files_and_no_window_is_prepared(found, nothing, dataset, tmp_path):
    paths = write_diagnosis_figures(tmp_path / "found", found, errors_left(found, dataset))
    assert [path.name for path in paths] == [
        "ladder.png",
        "errors.png",
        "gains.png",
        "errors_left.png",
        "errors_right.png",
    ]
    assert all(path.read_bytes().startswith(b"\x89PNG") for path in paths)
    assert plt.get_fignums() == []


def test_where_nothing_is_missing_there_are_pictures_of_errors_alone(nothing, dataset, tmp_path, monkeypatch):
    written = []
    monkeypatch.setattr(
        "matplotlib.figure.Figure.savefig", lambda _, path, **__: written.append(path.touch())
    )
    paths = write_diagnosis_figures(tmp_path / "none", nothing, errors_left(nothing, dataset))
    assert [path.name for path in paths] == ["errors.png", "errors_left.png", "errors_right.png"]
    assert len(written) == len(paths)


def test_the_command_finds_what_was_hidden(diagnosed_arm):
    answer = json.loads((diagnosed_arm / "answer.json").read_text())
    assert answer["missing"] == ["viscous_friction"]
    assert answer["ranking"][0]["actuators"] == ["shoulder"]
    ladder = [step["error"]["validate"] for step in answer["ladder"]]
    assert ladder[-1] < 0.2 * ladder[0]
    assert answer["after"]["effect_parameters"]["viscous_friction"]["shoulder"]["Fv"][
        "value"
    ] == pytest.approx(1.5, rel=0.02)
    assert {path.name for path in (diagnosed_arm / "found").iterdir()} >= {
        "ladder.png",
        "errors.png",
        "gains.png",
    }


def test_the_applied_model_has_the_effect_and_the_error_of_the_ladder(diagnosed_arm):
    saved = load_model(diagnosed_arm / "model.json")
    assert saved.model.effects == ("viscous_friction:shoulder",)
    comparison = apply_model(problem_of(load_dataset(diagnosed_arm / "data")), saved)
    answer = json.loads((diagnosed_arm / "answer.json").read_text())
    assert relative_error(comparison.recordings) < 1.2 * answer["ladder"][-1]["error"]["validate"]


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["no_such_folder"], "no_such_folder"),
        (["{data}", "--with", "nonsense"], "nonsense"),
        (["{data}", "--with", "viscous_friction:knee"], "knee"),
        (["{data}", "--effect-file", "absent.py"], "absent.py"),
        (["{data}", "--border", "x"], "--border"),
        (["{data}", "--json", "no_such_folder/answer.json"], "there is no folder no_such_folder"),
        (["{data}", "--with", "coulomb_frction"], "did you mean 'coulomb_friction'?"),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(diagnosed_arm, capsys, arguments, culprit):
    filled = [one.format(data=diagnosed_arm / "data") for one in arguments]
    assert main(["diagnose", *filled]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert culprit in err
