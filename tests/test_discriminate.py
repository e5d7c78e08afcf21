"""`bench discriminate`: the motion that it designs lets a diagnosis tell what it could not tell before."""

import csv
import json
import tomllib
from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.effects import CATALOGUE
from bench.excitation.discrimination.discriminate import discriminate
from bench.excitation.discrimination.figure import discrimination_figure, write_discrimination_figure
from bench.excitation.discrimination.files import CommandLines, write_discrimination
from bench.excitation.discrimination.sentences import motion_words, next_step, sentences, warnings
from bench.identification.problem import Problem, problem_of
from bench.model.geometry import read_geometry
from bench.model.states import active_ranges
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.scenario.trajectory import FourierTrajectory
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

pytestmark = pytest.mark.pictures

PAIR = ("coulomb_friction", "position_dependent_friction")
RIVALS = {name: CATALOGUE[name] for name in (*PAIR, "viscous_friction", "constant_offset")}
NARROW = {"span": 0.1, "velocity_limit": 0.5, "acceleration_limit": 8.0, "harmonics": 3, "duration": 8.0}
HIDDEN = {"effect": "coulomb_friction", "joint": "shoulder", "Fc": 0.3}


def machine(recordings, hidden=(HIDDEN,)):
    """An arm with dry friction at its shoulder; the recordings carry nothing."""
    design = {"optimise": False, **NARROW}
    changes = {
        "design": design,
        "payloads": {},
        "recordings": recordings,
        "hidden": list(hidden),
        "step": STEP,
    }
    scenario = load_scenario("two_link", changes)
    return simulate(scenario, resolve_trajectories(scenario), threads=1)


def narrow_recordings():
    return [
        {"name": "fitted", "use": "identify", "design": {"seed": 1}},
        {"name": "checked", "use": "validate", "design": {"seed": 2}},
    ]


@pytest.fixture(scope="module")
def given():
    """Recordings of small strokes, in which dry friction is the same everywhere."""
    return machine(narrow_recordings())


@pytest.fixture(scope="module")
def found(given):
    return discriminate(problem_of(as_dataset(given)), PAIR, duration=12.0, widen=2.0)


@pytest.fixture(scope="module")
def written(found, tmp_path_factory):
    folder = tmp_path_factory.mktemp("discriminated") / "telling"
    write_discrimination(folder, found, write_discrimination_figure)
    return folder


def test_the_designed_motion_tells_what_the_given_data_cannot(given, found, written):
    before = diagnose_with_catalogue(Problem(as_dataset(given), RIVALS))
    (verdict,) = [one for one in before.ranking if one.effect == "coulomb_friction"]
    assert (verdict.verdict, verdict.alternatives) == ("indistinguishable", ("position_dependent_friction",))
    assert max(found.given.values()) < 10.0
    assert found.tells
    trajectory = {"trajectory_file": str(written / "trajectory.toml")}
    new = [{"name": f"telling_{use}", "use": use, **trajectory} for use in ("identify", "validate")]
    after = diagnose_with_catalogue(Problem(as_dataset(machine([*narrow_recordings(), *new])), RIVALS))
    assert after.missing == ("coulomb_friction",)
    assert after.ranking[0].verdict == "missing"
    assert after.ranking[0].actuators == ("shoulder",)


def test_what_is_promised_comes_out(given, found):
    """Nats are expected log-likelihood differences: the same in kind as the evidence of a diagnosis."""
    assert set(found.promised) == set(PAIR)
    assert all(found.promised[name] > found.given[name] for name in PAIR)
    assert found.growth > 0.03
    assert found.motion.payload is None


def test_the_motion_keeps_the_limits(given, found):
    time = np.linspace(0.0, found.motion.trajectory.duration, 6000)
    position, velocity, acceleration = found.motion.trajectory.evaluate(time)
    geometry = read_geometry(given.robot)
    low, high = active_ranges(geometry)
    assert np.all((position >= low + geometry.active_offset) & (position <= high + geometry.active_offset))
    for values, name in ((velocity, "speed"), (acceleration, "acceleration")):
        recorded = [getattr(found.recorded[joint], name) for joint in given.robot.joints]
        assert np.all(np.abs(values).max(axis=0) <= 2.001 * np.array(recorded)), name


def test_the_files_serve_a_controller_a_scenario_and_people(found, written):
    assert sorted(path.name for path in written.iterdir()) == [
        "README.md",
        "answer.json",
        "motion.png",
        "trajectory.csv",
        "trajectory.toml",
    ]
    with (written / "trajectory.csv").open() as file:
        header, *rows = csv.reader(file)
    assert header == [
        "time",
        *(
            f"{kind}.{joint}"
            for kind in ("position", "velocity", "acceleration")
            for joint in ("shoulder", "elbow")
        ),
    ]
    table = np.array(rows, dtype=float)
    np.testing.assert_allclose(np.diff(table[:, 0]), 1e-3, rtol=1e-6)
    np.testing.assert_allclose(np.gradient(table[:, 1], table[:, 0])[5:-5], table[5:-5, 3], atol=1e-5)
    again = FourierTrajectory.from_dict(tomllib.loads((written / "trajectory.toml").read_text()))
    np.testing.assert_array_equal(again.a, found.motion.trajectory.a)
    answer = json.loads((written / "answer.json").read_text())
    assert answer["tells"] is True
    assert answer["promised"] == found.promised
    text = (written / "README.md").read_text()
    assert all(one in text for one in sentences(found))
    assert (written / "motion.png").read_bytes().startswith(b"\x89PNG")


def test_the_words_say_what_is_different(found):
    (words,) = motion_words(found)
    assert "shoulder" in words
    slow = {joint: replace(facts, speed=0.01, turning=0.001) for joint, facts in found.planned.items()}
    (words,) = motion_words(replace(found, planned=slow))
    assert "motor shoulder moves slowly, at most 0.01 rad/s" in words
    assert "it reverses slowly at shoulder" in words
    loaded = replace(found, motion=replace(found.motion, payload="disc"))
    assert "rad/s (recorded: " in words
    slides = replace(found, planned=slow, joints=dict.fromkeys(found.joints, "N/A"))
    assert "motor shoulder moves slowly, at most 0.01 m/s" in motion_words(slides)[0]
    assert "it carries the payload disc" in motion_words(loaded)[0]
    still = {**found.planned, "elbow": replace(found.planned["elbow"], low=0.1, high=0.1)}
    assert "motor shoulder moves alone" in motion_words(replace(found, planned=still))[0]


def test_nats_and_units_are_explained(found, written):
    text = " ".join(sentences(found))
    assert text.count("odds of e") == 1
    assert "| shoulder [rad, s] | recorded |" in (written / "README.md").read_text()


def test_a_model_that_fits_is_no_cause_for_doubt(found):
    assert 0.8 < found.error_over_noise < 1.3
    assert not found.model_is_wrong
    assert warnings(found) == []
    assert next_step(found, "bench diagnose data", "out").startswith("next: record out/trajectory.csv")
    loud = replace(found, error_over_noise=8.0)
    (doubt,) = warnings(loud)
    assert sentences(loud)[0] == doubt
    assert "8 times the noise" in doubt


def test_a_model_that_is_known_to_be_wrong_is_told(given, tmp_path, capsys):
    """Dry friction is hidden, and two effects are asked for that have nothing to do with it."""
    write_simulation(given, tmp_path / "data")
    arguments = ["current_delay", "current_loop_lag", "--duration", "5", "-o", str(tmp_path / "out")]
    assert main(["discriminate", str(tmp_path / "data"), *arguments]) == 0
    out = " ".join(capsys.readouterr().out.split())
    answer = json.loads((tmp_path / "out" / "answer.json").read_text())
    assert answer["error_over_noise"] > 5.0
    assert "the model lacks another effect. Run bench diagnose first" in out
    assert f"next: bench diagnose {tmp_path / 'data'}" in out
    readme = (tmp_path / "out" / "README.md").read_text()
    asked = f"current_delay current_loop_lag --duration 5.0 -o {tmp_path / 'out'}"
    assert f"`bench discriminate {tmp_path / 'data'} {asked}`" in readme


def test_the_readme_repeats_what_was_asked_and_of_which_data(found, tmp_path):
    told = CommandLines(
        "bench discriminate data a b --with c", "bench diagnose data --with c", "data", "robots/arm"
    )
    write_discrimination(tmp_path / "out", found, write_discrimination_figure, commands=told)
    readme = (tmp_path / "out" / "README.md").read_text()
    for line in (
        "bench import first.csv --robot robots/arm -o data --name telling.csv",
        "bench import second.csv --robot robots/arm -o data --name telling_check.csv --use validate",
        "bench diagnose data --with c",
        "`bench discriminate data a b --with c`",
    ):
        assert line in readme


def test_where_neither_effect_shows_there_is_nothing_to_tell_apart(tmp_path):
    clean = as_dataset(machine(narrow_recordings(), hidden=[]))
    found = discriminate(problem_of(clean), ("current_delay", "current_loop_lag"), duration=5.0)
    assert found.nothing
    assert max(found.shown.values()) < 1.0
    assert not found.model_is_wrong
    assert "there is nothing to distinguish" in " ".join(sentences(found))
    paths = write_discrimination(tmp_path / "out", found, write_discrimination_figure)
    assert [path.name for path in paths] == ["README.md", "answer.json"]


def test_what_shows_in_the_given_data_is_told_from_noise(found):
    assert min(found.shown.values()) > 1000.0
    assert "Neither effect shows" not in " ".join(sentences(found))
    small = replace(found, shown=dict.fromkeys(found.shown, 3.0))
    assert "Neither effect is certain" in " ".join(sentences(small))


def test_given_data_that_are_enough_need_no_motion(found):
    assert not found.given_tells
    asked = tuple(replace(one, given=100.0 * one.given) for one in found.questions)
    enough = replace(found, questions=asked)
    assert enough.given_tells
    assert "That is enough: bench diagnose can distinguish them" in " ".join(sentences(enough))
    assert next_step(enough, "bench diagnose data", "out") == "next: bench diagnose data"


def test_a_picture_shows_each_motor_and_both_models(found):
    axes = discrimination_figure(found).axes
    assert len(axes) == 6
    assert len(axes[2].get_lines()) == 2


def test_what_the_model_takes_up_cannot_be_told_by_any_motion(given, tmp_path, capsys):
    write_simulation(given, tmp_path / "data")
    arguments = ["discriminate", str(tmp_path / "data"), "rotor_inertia:shoulder", "viscous_friction"]
    assert main([*arguments, "-o", str(tmp_path / "out")]) == 0
    out = " ".join(capsys.readouterr().out.split())
    assert "No motion of this robot can distinguish rotor inertia at shoulder and viscous friction" in out
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["README.md", "answer.json"]
    assert main([*arguments, "-o", str(tmp_path / "data")]) == 2
    assert "holds something else" in capsys.readouterr().err


def test_a_special_case_can_only_be_spoken_against(given):
    found = discriminate(
        problem_of(as_dataset(given)), ("viscous_friction", "asymmetric_viscous_friction"), duration=5.0
    )
    assert found.imitated == ("viscous_friction",)
    assert "as a special case" in " ".join(sentences(found))
    assert list(found.given) == ["asymmetric_viscous_friction"]


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        (["nonsense", "viscous_friction"], "nonsense"),
        (["viscous_friction", "viscous_friction"], "twice"),
        (["viscous_friction:knee", "coulomb_friction"], "knee"),
        (["viscous_friction", "coulomb_friction", "--duration", "-1"], "duration"),
        (["viscous_friction", "coulomb_friction", "--widen", "0"], "widen"),
        (["viscous_friction", "coulomb_friction", "--rate", "0"], "rate"),
    ],
)
def test_bad_input_is_one_line_and_nothing_is_written(given, tmp_path, capsys, arguments, culprit):
    write_simulation(given, tmp_path / "data")
    assert main(["discriminate", str(tmp_path / "data"), *arguments, "-o", str(tmp_path / "out")]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert culprit in err
    assert not (tmp_path / "out").exists()


def test_every_effect_has_a_motion_that_shows_it():
    assert [name for name, one in CATALOGUE.items() if "shown_by" not in vars(type(one))] == []


def test_an_effect_that_is_in_the_model_already_is_refused(given):
    with pytest.raises(BenchError, match="twice"):
        discriminate(problem_of(as_dataset(given), ["coulomb_friction"]), PAIR)
