"""What differs from run to run is found and told, and nothing where it does not."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.differs import differing
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.summary import summary_sentences
from bench.diagnosis.with_catalogue import diagnose_with_catalogue
from bench.effects import CATALOGUE
from bench.identification.finding import Code
from bench.identification.finding_words import sentence
from bench.identification.identify import identify
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.resense import sense_again
from bench.truth.simulate import simulate
from tests.bounds_kit import with_bounds
from tests.discover_kit import FRICTIONS, among
from tests.workbench_kit import RECORDINGS, write_dataset

FRICTION = ("viscous_friction", "coulomb_friction", "constant_offset")
RUBS = {"effect": "coulomb_friction", "joint": "left", "Fc": 0.2}
STEP = 0.1  # A, by which the left current of one recording is shifted, and that of the other against it


@pytest.fixture(scope="module")
def alike(tmp_path_factory) -> Dataset:
    folder = tmp_path_factory.mktemp("runs") / "data"
    return load_dataset(write_dataset(folder, hidden=(), recordings=RECORDINGS[:3]))


@pytest.fixture(scope="module")
def rubbing(tmp_path_factory) -> Dataset:
    folder = tmp_path_factory.mktemp("rubbing") / "data"
    return load_dataset(write_dataset(folder, hidden=(RUBS,), recordings=RECORDINGS))


def shifted(dataset: Dataset, steps: tuple[float, ...]) -> Dataset:
    """With an offset of its own in the left current of every recording."""
    recordings = [
        replace(recording, current=recording.current + np.array([step, 0.0]))
        for recording, step in zip(dataset.recordings, steps, strict=True)
    ]
    return replace(dataset, recordings=tuple(recordings))


@pytest.fixture(scope="module")
def unlike(alike: Dataset) -> Dataset:
    return shifted(alike, (STEP, -STEP, 0.0))


@pytest.fixture(scope="module")
def told(unlike: Dataset) -> Diagnosis:
    return diagnose_with_catalogue(problem_of(unlike))


def found_in(dataset: Dataset, effects: tuple[str, ...] = ()) -> list[str]:
    prepared = prepare(problem_of(dataset, effects))
    found, _ = differing(converged(prepared), CATALOGUE)
    return [one.request for one in found]


@pytest.mark.parametrize("effects", [(), FRICTION, ("stribeck_friction", "constant_offset:right")])
def test_recordings_that_are_alike_raise_no_alarm(alike: Dataset, effects: tuple[str, ...]) -> None:
    assert found_in(alike, effects) == []


def test_noise_of_ten_seeds_raises_no_alarm() -> None:
    recordings = [
        {"name": "free", "use": "identify", "design": {"seed": 1}},
        {"name": "held", "use": "identify", "payload": "disc", "design": {"seed": 2}},
    ]
    changes = {"design": {"optimise": False, "duration": 6.0, "ramp": 0.5}, "recordings": recordings}
    simulation = simulate(load_scenario("five_bar", changes), threads=1)
    for seed in range(10):
        scenario = load_scenario("five_bar", {**changes, "seed": seed})
        assert found_in(as_dataset(sense_again(simulation, scenario)), FRICTION) == [], seed


@pytest.mark.parametrize("effects", [(), FRICTION])
def test_an_offset_that_differs_is_found(unlike: Dataset, effects: tuple[str, ...]) -> None:
    assert found_in(unlike, effects) == ["constant_offset:left@recording"]


def test_nothing_is_told_of_one_recording_or_of_what_the_model_has(unlike: Dataset) -> None:
    alone = replace(unlike, recordings=(unlike.recordings[0], unlike.recordings[2]))
    assert found_in(alone) == []
    assert found_in(unlike, ("constant_offset:left@recording",)) == []


def test_a_friction_that_differs_is_found(tmp_path) -> None:
    parts = []
    for name, share in (("cold", 0.3), ("warm", 0.15)):
        hidden = ({"effect": "coulomb_friction", "joint": "right", "Fc": share},)
        parts.append(load_dataset(write_dataset(tmp_path / name, hidden=hidden, recordings=RECORDINGS[:2])))
    mixed = replace(parts[0], recordings=(parts[0].recordings[0], parts[1].recordings[1]))
    assert found_in(mixed, FRICTION) == ["coulomb_friction:right@recording"]


def test_the_diagnosis_tells_it(told: Diagnosis) -> None:
    (one,) = told.differs
    values = [value.value for value in one.values.values()]
    assert list(one.values) == ["free.csv", "held.csv"]
    assert values[0] - values[1] == pytest.approx(2 * STEP * 3.3, rel=0.03)
    assert told.missing == ()
    sentences = summary_sentences(told)
    assert sentences[0].startswith("No effect of the catalogue with one value for all recordings is missing")
    (said,) = [sentence for sentence in sentences if "run to run" in sentence]
    assert said.startswith("The constant offset at left differs from run to run: -0.3")
    assert "`--with constant_offset:left@recording` estimates these values" in said


def test_the_answer_has_the_values_and_the_gains_that_go_with_them(told: Diagnosis) -> None:
    request = "constant_offset:left@recording"
    assert told.by_recording == told.added == (request,)
    assert told.after.effects == (request,)
    assert [step.effects for step in told.ladder] == [(), (request,)]
    assert [step.identify for step in told.ladder] == [told.before.error.identify, told.after.error.identify]
    before, after = told.before.drive_gains["left"], told.after.drive_gains["left"]
    assert abs(after.value - 3.3) < 3.0 * after.std < 0.03
    assert abs(before.value - 3.3) > 0.3
    (moved,) = [sentence for sentence in summary_sentences(told) if "drive gain" in sentence]
    assert moved.startswith("With one value per recording the drive gain of left is 3.3")


def test_a_gain_holds_what_values_for_each_recording_make_of_it(unlike: Dataset, monkeypatch) -> None:
    monkeypatch.setattr("bench.diagnosis.catalogue_search.TOLERANCES", with_bounds("search", by_recording=0))
    told = diagnose_with_catalogue(problem_of(unlike))
    gain = told.after.drive_gains["left"]
    assert told.by_recording == ()
    assert told.after.std_from == "models"
    assert 0.3 < abs(gain.value - 3.3) < 1.02 * gain.std
    (said,) = [sentence for sentence in summary_sentences(told) if "run to run" in sentence]
    assert said.endswith("not fitted; `--with constant_offset:left@recording` estimates these values.")


def test_both_are_found_where_coulomb_friction_is_missing_too(rubbing: Dataset) -> None:
    """One offset for both recordings makes the gain of the left motor 1.7, where 3.3 is right."""
    dataset = replace(rubbing, recordings=rubbing.recordings[:2])
    told = diagnose_with_catalogue(among(FRICTIONS, shifted(dataset, (STEP, -STEP)), ("constant_offset",)))
    assert told.superfluous == ()
    assert told.missing == ("coulomb_friction",)
    assert told.by_recording == ("constant_offset:left@recording",)
    assert told.ranking[0].actuators == ("left",)
    gain = told.after.drive_gains["left"]
    assert abs(gain.value - 3.3) < 3.0 * gain.std < 0.05
    request = "constant_offset:left@recording"
    assert [step.effects for step in told.ladder] == [(), (request,), (request, "coulomb_friction")]
    assert summary_sentences(told)[0].startswith("Coulomb friction at left")


def test_it_stands_in_the_json(told: Diagnosis) -> None:
    (one,) = json.loads(json.dumps(diagnosis_json(told)))["differs_by_recording"]
    assert one["request"] == "constant_offset:left@recording"
    assert set(one["values"]) == {"free.csv", "held.csv"}
    assert set(one["values"]["free.csv"]) == {"value", "std", "unit"}
    assert one["error_after"] < 0.2 * one["error_before"]


def test_recordings_that_were_not_fitted_may_have_other_values_still(rubbing: Dataset) -> None:
    """As large ones as that hide the friction from a search that gives them those of the fitted recordings."""
    told = diagnose_with_catalogue(among(FRICTIONS, shifted(rubbing, (STEP, -STEP, 4 * STEP, -4 * STEP))))
    assert told.missing == ("coulomb_friction",)
    assert told.by_recording == ("constant_offset:left@recording",)
    assert abs(told.after.drive_gains["left"].value - 3.3) < 0.03
    assert told.after.error.validate < 1.2 * told.unexplained.noise_floor
    none_of_its_own = {"free_check.csv", "held_check.csv"}
    (said,) = [each for each in told.after.findings if each.code == Code.NO_VALUE_OF_ITS_OWN]
    assert set(said.names) == none_of_its_own


def test_where_only_they_have_other_values_that_is_said_and_what_helps(rubbing: Dataset) -> None:
    dataset = shifted(rubbing, (0.0, 0.0, 4 * STEP, -4 * STEP))
    told = diagnose_with_catalogue(among(FRICTIONS, dataset))
    (said,) = [each for each in told.after.findings if each.code == Code.CHECKED_HAS_OTHER_VALUES]
    assert said.names[1:] == ("constant_offset:left",)
    assert any(sentence(said) in each for each in summary_sentences(told))
    helped = diagnose_with_catalogue(among(FRICTIONS, dataset, ("constant_offset:left@recording",)))
    assert helped.missing == ("coulomb_friction",)


def test_a_model_is_judged_with_the_value_that_suits_a_recording(unlike: Dataset) -> None:
    """Whatever constant is in the current there: it is taken up, and nothing else."""
    request = ("constant_offset:left@recording",)
    here, other = (
        identify(prepare(problem_of(shifted(unlike, (0.0, 0.0, step)), request))) for step in (0.0, 0.7)
    )
    assert other.error.identify == here.error.identify
    (seen,) = [series for series in here.recordings if series.use == "validate"]
    (moved,) = [series for series in other.recordings if series.use == "validate"]
    assert np.where(seen.moving, moved.error - seen.error, 0.0) == pytest.approx(0.0, abs=1e-9)
    torque = moved.by_effect["constant_offset"] - seen.by_effect["constant_offset"]
    current = (moved.measured - seen.measured)[:, 0]
    there = seen.moving[:, 0]
    assert torque[there, 0] == pytest.approx(here.drive_gains["left"].value * current[there], rel=1e-9)
