"""Effects that have a value for each recording, said as EFFECT[:PLACE]@recording."""

from dataclasses import replace

import numpy as np
import pytest
from click.testing import CliRunner

from bench.basics.errors import BenchError
from bench.cli.identify import identify as identify_command
from bench.dataset.dataset import Dataset, load_dataset
from bench.diagnosis.split import with_held_out_parts
from bench.document.terminal.identification import effects_table
from bench.effects import CATALOGUE, select_effects
from bench.effects.places import Places
from bench.identification.identify import identify
from bench.identification.model_file import apply_model, load_model, save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.page.workbench.page_data import page_data
from tests.hidden_kit import STEP
from tests.workbench_kit import diagnosis_of, write_dataset
from tests.workbench_sets import Carried

GAIN = 3.3  # N*m/A, of the left motor
OFFSETS = (0.4, -0.3, 0.05)  # N*m at the left motor: fitted, fitted with payload, not fitted
RECORDINGS = (("free", "identify", 1, False), ("held", "identify", 2, True), ("check", "validate", 3, False))
REQUEST = "constant_offset:left@recording"
PLACES = Places(actuator=("left", "right@2"), passive=("elbow",), body=("rod",), payload=("disc",))


@pytest.fixture(scope="module")
def dataset(tmp_path_factory) -> Dataset:
    folder = write_dataset(
        tmp_path_factory.mktemp("runs") / "data", hidden=(), recordings=RECORDINGS, step=STEP / 2
    )
    return with_offsets(load_dataset(folder))


def with_offsets(dataset: Dataset) -> Dataset:
    shifted = [
        replace(one, current=one.current + np.array([offset / GAIN, 0.0]))
        for one, offset in zip(dataset.recordings, OFFSETS, strict=True)
    ]
    return replace(dataset, recordings=tuple(shifted))


@pytest.fixture(scope="module")
def result(dataset: Dataset) -> Identification:
    return identify(prepare(problem_of(dataset, [REQUEST])))


def test_every_recording_has_its_own_value(result: Identification) -> None:
    found = result.effect_parameters["constant_offset"]
    assert list(found) == ["left@free.csv", "left@held.csv"]
    for values, offset in zip(found.values(), OFFSETS, strict=False):
        assert abs(values["c"].value - offset) < 4.0 * values["c"].std < 0.05
    assert result.effects == (REQUEST,)
    assert result.rank == result.unknowns
    assert "left@held.csv" in str(list(effects_table(result).columns[1].cells))


def test_one_value_for_all_leaves_the_difference(dataset: Dataset, result: Identification) -> None:
    common = identify(prepare(problem_of(dataset, ["constant_offset:left"])))
    assert list(common.effect_parameters["constant_offset"]) == ["left"]
    assert result.error.identify < 0.3 * common.error.identify


def test_a_recording_that_was_not_fitted_has_the_value_that_suits_it(result: Identification) -> None:
    check = next(one for one in result.recordings if one.name == "check.csv")
    torque = check.by_effect["constant_offset"][check.moving[:, 0], 0]
    assert torque == pytest.approx(OFFSETS[2], abs=0.02)
    assert check.error[check.moving[:, 0], 0].mean() == pytest.approx(0.0, abs=1e-9)
    (note,) = [note for note in result.notes if "constant offset" in note]
    assert note.startswith("check.csv has no estimated constant offset")
    assert "its best-fitting value among theirs is used" in note


def test_parts_of_a_recording_share_its_value(dataset: Dataset) -> None:
    fitted = replace(dataset, recordings=dataset.recordings[:2])
    parts, _ = with_held_out_parts(fitted)
    result = identify(prepare(problem_of(parts, [REQUEST])))
    assert list(result.effect_parameters["constant_offset"]) == ["left@free.csv", "left@held.csv"]
    assert result.error.validate < 1.3 * result.error.identify
    assert not [note for note in result.notes if "of its own" in note]


def test_a_saved_model_gives_its_own_recordings_their_values(
    dataset: Dataset, result: Identification, tmp_path
) -> None:
    path = tmp_path / "model.json"
    save_model(result, path, dataset.folder)
    again = apply_model(problem_of(dataset), load_model(path))
    for before, after in zip(result.recordings, again.recordings, strict=True):
        assert after.modelled == pytest.approx(before.modelled, abs=1e-9)
    assert [note for note in again.notes if note.startswith("check.csv has no")]

    # Logs of another day may have the same names: of the same currents the same value is found.
    other = apply_model(problem_of(replace(dataset, folder=tmp_path)), load_model(path))
    assert other.recordings[0].error.mean() == pytest.approx(again.recordings[0].error.mean(), abs=1e-3)
    assert other.notes[0].startswith("free.csv, held.csv, check.csv have no estimated constant offset")


def test_effects_that_depend_on_their_own_value_differ_too(dataset: Dataset) -> None:
    result = identify(prepare(problem_of(dataset, ["load_dependent_friction:left@recording", REQUEST])))
    found = result.effect_parameters["load_dependent_friction"]
    assert list(found) == ["left@free.csv", "left@held.csv"]
    for values in found.values():
        assert abs(values["mu"].value) < max(5.0 * values["mu"].std, 0.02)


@pytest.mark.parametrize(
    ("request_", "said"),
    [
        (
            "constant_offset@run",
            "'@run' has no meaning; @recording estimates values for each fitted recording",
        ),
        ("constant_offset:left@free.csv", "'@free.csv' has no meaning; @recording estimates"),
        ("constant_offset:middle@recording", "no joint 'middle' where it can sit; there are: left, right@2"),
        ("cogging_torque@recording", "cannot have a value for each recording; those that can: asymmetric"),
        ("payload_mass_error@recording", "payload_mass_error cannot have a value for each recording"),
        ("nothing@recording", "unknown effect 'nothing'"),
    ],
)
def test_what_cannot_be_is_refused(request_: str, said: str) -> None:
    with pytest.raises(BenchError) as refused:
        select_effects([request_], PLACES, CATALOGUE, ["free.csv"])
    assert said in str(refused.value)


def test_a_place_may_have_the_sign_in_its_name() -> None:
    (one,) = select_effects(["constant_offset:right@2"], PLACES)
    assert (one.joint, one.recording) == ("right@2", "")
    (one,) = select_effects(["constant_offset:right@2@recording"], PLACES, CATALOGUE, ["free.csv"])
    assert (one.joint, one.place) == ("right@2", "right@2@free.csv")
    with pytest.raises(BenchError, match="given twice for 'left'"):
        select_effects(["constant_offset:left", REQUEST], PLACES, CATALOGUE, ["free.csv"])


def test_the_page_keeps_them_as_they_are(dataset: Dataset) -> None:
    diagnosis = diagnosis_of(dataset, found=(REQUEST, "viscous_friction:left"))
    data = page_data(problem_of(dataset), diagnosis)
    names = [one["name"] for one in data["parameters"]]
    assert names[-2:] == ["c of constant offset at left@free.csv", "c of constant offset at left@held.csv"]
    assert len(names) == data["own"]
    assert data["found"] == [["viscous_friction", "left"]]
    fitted = Carried(data).fit({"viscous_friction:left"})
    expected = identify(prepare(problem_of(dataset, [REQUEST, "viscous_friction:left"])))
    assert fitted.fitted == pytest.approx(expected.error.identify, rel=1e-3)
    assert fitted.held_out == pytest.approx(expected.error.validate, rel=1e-3)


def test_the_command_names_it() -> None:
    shown = CliRunner().invoke(identify_command, ["--help"]).output
    assert "--with EFFECT[:PLACE][@recording]" in " ".join(shown.split())
