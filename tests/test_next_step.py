"""What `identify` and `compare` advise, and what the notes say of signs and of hopeless fits."""

from dataclasses import replace

import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.identification.findings import with_findings
from bench.residuals.words import beyond_noise, remaining_errors
from bench.truth.dataset import write_simulation
from tests.compared_kit import NOISE, made
from tests.shown import dataset_of, identification_of


def test_errors_far_above_the_noise_are_told():
    noisy = made(lambda row, random: NOISE * random.standard_normal(len(row["time"])) / 5.0)
    assert remaining_errors(noisy) == []
    assert not beyond_noise(noisy)
    wrong = made(lambda row, random: 0.2 * row["velocity"])
    (sentence,) = remaining_errors(wrong)
    assert sentence.startswith("motor left: error ")
    assert "times the noise of the current" in sentence
    assert beyond_noise(wrong)


@pytest.fixture
def identified():
    return identification_of(dataset_of(load_robot("five_bar")))


def test_one_negative_gain_is_a_sign_or_a_column(identified):
    gains = dict(identified.drive_gains)
    gains["left"] = replace(gains["left"], value=-gains["left"].value)
    notes = with_findings(replace(identified, drive_gains=gains), ()).notes
    (note,) = [one for one in notes if "negative" in one]
    assert "--scale current.left=-1" in note
    assert not any("far from its nominal" in one for one in notes)


def test_an_error_above_the_current_itself_is_no_fit_at_all(identified):
    hopeless = replace(identified, error=replace(identified.error, identify=1.7))
    assert any("more than without a model" in note for note in with_findings(hopeless, ()).notes)


def test_a_measured_dataset_is_not_replaced_by_a_simulated_one(tmp_path):
    (tmp_path / "dataset.toml").write_text('robot = "five_bar"\n')
    with pytest.raises(BenchError, match="was not simulated"):
        write_simulation(None, tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["dataset.toml"]
