"""A motor that stands still has no row that counts: the answer says what is not known of it, and comes to its end."""

import io
import json
import math
from dataclasses import replace

import pytest
from rich.console import Console

from bench.api.diagnose import diagnose
from bench.api.identify import identify
from bench.diagnosis.as_json import diagnosis_json
from bench.document.terminal.diagnosis import diagnosis_report
from bench.identification.finding import Code, Finding
from bench.identification.findings import periods_not_whole
from bench.truth.dataset import as_dataset
from tests.hidden_kit import run

DESIGN = {"optimise": False, "duration": 6.0, "ramp": 0.5}


@pytest.fixture(scope="module")
def dataset():
    hidden = {"effect": "viscous_friction", "joint": "shoulder", "Fv": 1.5}
    made = as_dataset(run("two_link", hidden, design=DESIGN))
    check = replace(made.recordings[0], name="check.csv", use="validate")
    return replace(made, recordings=(*made.recordings, check))


def held(dataset, joint, uses):
    """The dataset with a motor that stays where it was in all recordings of these uses."""

    def still(recording):
        position = recording.position.copy()
        position[:, joint] = position[0, joint]
        return replace(recording, position=position)

    made = [still(each) if each.use in uses else each for each in dataset.recordings]
    return replace(dataset, recordings=tuple(made))


@pytest.mark.parametrize("method", ["current", "robust", "iv", "wls", "ls"])
def test_its_gain_stays_nominal_and_is_not_fitted(dataset, method):
    result = identify(held(dataset, 1, ("identify", "validate")), method=method)
    gain = result.drive_gains["elbow"]
    assert (gain.value, gain.fitted) == (gain.nominal, False)
    assert Finding(Code.STANDS_STILL, ("elbow",)) in result.findings
    assert result.drive_gains["shoulder"].fitted
    assert not periods_not_whole(result)


def test_an_effect_that_is_asked_for_there_has_no_values(dataset):
    effects = ["cogging_torque:elbow", "viscous_friction"]
    result = identify(held(dataset, 1, ("identify", "validate")), effects)
    assert all(
        math.isinf(each.std)
        for each in result.effect_parameters["cogging_torque"]["elbow"].values()
        if each.unit != "1/rad"
    )
    assert math.isfinite(result.effect_parameters["viscous_friction"]["shoulder"]["Fv"].std)


@pytest.mark.parametrize("uses", [("identify", "validate"), ("validate",)])
def test_a_diagnosis_comes_to_its_end(dataset, uses):
    found = diagnose(held(dataset, 1, uses), discover=False)
    answer = json.loads(json.dumps(diagnosis_json(found), allow_nan=False))
    assert answer["after"]["drive_gains"]["elbow"]["fitted"] == ("identify" not in uses)
    assert all("elbow" not in verdict.actuators for verdict in found.ranking) or "identify" not in uses
    diagnosis_report(found, Console(file=io.StringIO(), width=80))
