"""`bench excite --after`: the next best motion, and what it adds to the recordings that are there."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.robot import load_robot
from bench.excitation.experiment.after import plan_after
from bench.excitation.experiment.forecast import forecast
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.excitation.experiment.sentences import sentences
from bench.identification.finding_words import sentence
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario, resolve_trajectories
from bench.truth.dataset import as_dataset, write_simulation
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

SHORT = {"duration": 6.0, "harmonics": 4}


@pytest.fixture(scope="module")
def recorded():
    design = {"optimise": False, **SHORT, "span": 0.5, "velocity_limit": 3.0, "acceleration_limit": 30.0}
    recordings = [
        {"name": "unloaded", "use": "identify", "design": {"seed": 1}},
        {"name": "loaded", "use": "identify", "payload": "ball", "design": {"seed": 2}},
    ]
    scenario = load_scenario("two_link", {"design": design, "recordings": recordings, "step": STEP})
    return simulate(scenario, resolve_trajectories(scenario), threads=1)


@pytest.fixture(scope="module")
def following(recorded):
    return plan_after(problem_of(as_dataset(recorded)), ExperimentTable.model_validate(SHORT), Aim(steps=8))


def test_it_adds_to_what_is_there(following):
    assert following.value < following.before
    assert following.value <= following.random["best"]
    assert len(following.motions) == 1


def test_it_keeps_the_recorded_speeds(following, recorded):
    velocity = following.motions[0].trajectory.evaluate(following.search.shape.times)[1]
    assert (abs(velocity).max(axis=0) <= 1.1 * 3.0).all()


def test_the_command_writes_it(recorded, tmp_path, capsys):
    write_simulation(recorded, tmp_path / "data")
    words = ["excite", "two_link", "--after", str(tmp_path / "data"), "-o", str(tmp_path / "next")]
    assert main([*words, "--duration", "6", "--steps", "5"]) == 0
    assert "The existing recordings give" in capsys.readouterr().out
    answer = json.loads((tmp_path / "next" / "answer.json").read_text())
    assert list(answer["recordings"]) == ["next", "next_check"]
    assert answer["value"] < answer["before"]


def scaled(recorded, factor):
    """The dataset with the current of its first motor multiplied."""
    data = as_dataset(recorded)
    recordings = [
        replace(recording, current=recording.current * np.array([factor, 1.0]))
        for recording in data.recordings
    ]
    return replace(data, recordings=tuple(recordings))


def test_a_negative_gain_is_refused(recorded):
    with pytest.raises(BenchError, match="drive gain of shoulder is negative"):
        plan_after(problem_of(scaled(recorded, -1.0)), ExperimentTable.model_validate(SHORT), Aim(steps=0))


def test_a_model_that_identify_rejects_is_no_ground_for_a_plan(recorded, following):
    plan = plan_after(problem_of(scaled(recorded, 0.3)), ExperimentTable.model_validate(SHORT), Aim(steps=0))
    said = sentences(plan, forecast(plan, None))[0]
    assert said.startswith("Do not use this plan: `bench identify` rejects the model")
    assert sentence(plan.nominal.doubts[0]) in said
    assert "--with" in said
    assert following.nominal.doubts == ()


@pytest.mark.parametrize(
    ("robot", "words", "said"),
    [
        ("five_bar", [], "the dataset's robot is 'two_link'"),
        ("two_link", ["--payload-mass", "1"], "carries what the dataset declares"),
        ("two_link", ["--gain-accuracy", "1%"], "omit it with --after"),
    ],
)
def test_what_does_not_go_together_is_refused(recorded, tmp_path, capsys, robot, words, said):
    write_simulation(recorded, tmp_path / "data")
    folder = tmp_path / "next"
    assert main(["excite", robot, "--after", str(tmp_path / "data"), "-o", str(folder), "-q", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert error.count("\n") == 1
    assert not folder.exists()


def test_a_first_plan_knows_nothing_before():
    table = ExperimentTable.model_validate({**SHORT, "velocity": 3.0, "acceleration": 30.0})
    assert plan_experiment(load_robot("two_link"), table, Aim(steps=0)).before is None
