"""What limits an answer: codes with their numbers, in words only at the end."""

import json
from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.identification.finding import UNBELIEVABLE, Code, Finding, Unknown
from bench.identification.finding_words import WORDS, note, sentence
from bench.identification.findings import runaway, unlike, with_findings, with_other_values
from bench.identification.model_file import load_model, save_model
from bench.identification.result import Quantity
from tests.shown import dataset_of, identification_of


@pytest.fixture
def result():
    return identification_of(dataset_of(load_robot("five_bar")), effects=True)


def test_every_code_has_its_words():
    assert set(WORDS) == set(Code)


def test_a_finding_names_what_it_is_of_with_its_numbers(result):
    gain = result.drive_gains["left"]
    far = replace(result, drive_gains={**result.drive_gains, "left": replace(gain, value=3.0 * gain.nominal)})
    found = {one.code: one for one in with_findings(far, ("strange.csv",)).findings}
    assert next(iter(found)) == Code.GAIN_RUNAWAY  # what is not to be believed is said first
    assert found[Code.GAIN_RUNAWAY].numbers == {"value": 3.0 * gain.nominal, "nominal": gain.nominal}
    assert Code.GAIN_FAR not in found  # the same gain is said once
    assert found[Code.PAYLOAD_NOT_DECLARED].names == ("strange.csv",)
    assert found[Code.POORLY_DETERMINED].numbers["count"] == 1
    assert runaway(far) == found[Code.GAIN_RUNAWAY]
    assert note(found[Code.GAIN_RUNAWAY]) == f"Do not use this answer. {sentence(found[Code.GAIN_RUNAWAY])}"
    assert all(note(one) == sentence(one) for code, one in found.items() if code not in UNBELIEVABLE)


def test_the_worst_recording_that_was_not_fitted_is_named_with_its_payload(result):
    error = replace(result.error, identify=0.01, validate=0.5)
    found = unlike(replace(result, error=error))
    assert found.code == Code.CHECKED_UNLIKE_FITTED
    assert found.numbers == {"fitted": 0.01, "checked": 0.5}
    assert found.names[0] == max(error.by_recording, key=error.by_recording.get)
    far = replace(result, error=error, findings=(found,))
    own = unlike(with_other_values(far, ["constant_offset:left"]))
    assert (own.code, own.names) == (
        Code.CHECKED_HAS_OTHER_VALUES,
        (found.names[0], "constant_offset:left"),
    )
    assert sentence(own).endswith(
        "`--with constant_offset:left@recording` estimates one value per recording."
    )


@pytest.mark.parametrize(
    ("periods", "std", "unit", "told"),
    [
        (20.94, 0.01, "1/turn", True),
        (0.5, 0.01, "1/turn", True),
        (20.97, 0.01, "1/turn", False),  # three standard errors from 21
        (20.985, 0.001, "1/turn", False),  # as near as encoders and lengths are right
        (20.94, float("inf"), "1/turn", False),  # not from these data
        (20.94, 0.01, "1/m", False),  # of a slide: a metre is no turn
    ],
)
def test_periods_that_are_certainly_no_whole_number_are_told(result, periods, std, unit, told):
    values = {"a": Quantity(0.1, 0.01, "N*m"), "periods": Quantity(periods, std, unit)}
    rippled = replace(result, effect_parameters={"cogging_torque": {"left": values}})
    found = [each for each in with_findings(rippled, ()).findings if each.code == Code.PERIODS_NOT_WHOLE]
    assert [each.names for each in found] == [("cogging_torque", "left")] * told
    if told:
        assert found[0].numbers == {"periods": periods, "std": std}
        said = f"Cogging torque at left repeats {periods:.3f} ± 0.010 times per turn."
        assert sentence(found[0]).startswith(said)


def test_the_condition_number_is_named_only_where_no_parameter_is_loose(result):
    alike = replace(result, scaled_condition=1e6)
    known = replace(alike, parameters=tuple(replace(each, std=0.0) for each in alike.parameters))
    loose = replace(alike, parameters=tuple(replace(each, std=np.inf) for each in alike.parameters))
    of = {
        name: {each.code for each in with_findings(one, ()).findings}
        for name, one in (("k", known), ("l", loose))
    }
    both = {Code.ILL_CONDITIONED, Code.POORLY_DETERMINED}
    assert {name: codes & both for name, codes in of.items()} == {
        "k": {Code.ILL_CONDITIONED},
        "l": {Code.POORLY_DETERMINED},
    }


def test_findings_are_saved_with_the_model(result, tmp_path):
    told = (
        Finding(Code.COLUMNS_SWAPPED, ("left", "right"), numbers={"error": 0.012}),
        Finding(Code.TAKEN_UP, of=(Unknown("effect", "Ia", "left", "rotor_inertia"),)),
        Finding(Code.ILL_CONDITIONED, numbers={"condition": float("inf")}),
    )
    path = tmp_path / "model.json"
    save_model(replace(result, findings=told), path)
    assert load_model(path).model.findings == told
    content = json.loads(path.read_text())
    assert content["notes"] == [note(one) for one in told]
    del content["findings"]  # as an earlier version wrote it
    path.write_text(json.dumps(content))
    assert list(load_model(path).model.notes) == content["notes"]
