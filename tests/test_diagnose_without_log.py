"""Which names of an answer hang on one log."""

from dataclasses import replace

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.dataset.dataset import Dataset
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.result import Diagnosis, WithoutLog
from bench.diagnosis.summary import summary_of
from bench.document.diagnosis import without_logs_table
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

SPRING = {"effect": "joint_spring", "joint": "elbow", "k": 2.0, "q0": 0.0}
VISCOUS = {"effect": "viscous_friction", "joint": "elbow", "Fv": 0.5}


def dataset_of(*hidden: dict[str, object]) -> Dataset:
    """Of a serial arm of two links."""
    changes = {"design": {"optimise": False, "duration": 6.0}, "hidden": list(hidden), "step": STEP}
    return as_dataset(simulate(load_scenario("two_link", changes)))


@pytest.fixture(scope="module")
def everywhere() -> Dataset:
    return dataset_of(VISCOUS)


@pytest.fixture(scope="module")
def answer(everywhere: Dataset) -> Diagnosis:
    return diagnose(everywhere, discover=False)


def test_a_friction_that_is_always_there_hangs_on_no_log(everywhere: Dataset, answer: Diagnosis) -> None:
    fitted = [recording for recording in everywhere.recordings if recording.use == "identify"]
    assert [row.log for row in answer.without_logs] == [recording.name for recording in fitted]
    assert all(row.gone == () for row in answer.without_logs)
    assert all(row.gains == {} for row in answer.without_logs), "one load is always there, or never"
    assert diagnosis_json(answer)["without_logs"][0]["gone"] == []
    assert summary_of(answer).by_log == "Whichever log is omitted, viscous friction stays."


def test_the_summary_says_which_names_stay_and_which_depend_on_a_log(answer: Diagnosis) -> None:
    rows = (WithoutLog("a.csv", ("cogging_torque",), {}), WithoutLog("b.csv", (), {}))
    both = replace(answer, missing=("viscous_friction", "cogging_torque"), without_logs=rows)
    assert summary_of(both).by_log == (
        "Whichever log is omitted, viscous friction stays; cogging torque depends on a.csv: without such a log, "
        "the others do not show it."
    )
    each = replace(
        both, without_logs=(rows[0], WithoutLog("b.csv", ("viscous_friction", "cogging_torque"), {}))
    )
    assert summary_of(each).by_log == (
        "Viscous friction depends on b.csv, cogging torque on a.csv and b.csv: without such a log, the others do not "
        "show it."
    )
    assert summary_of(replace(answer, without_logs=())).by_log == ""


def test_gains_are_given_where_the_other_logs_fix_their_scale(everywhere: Dataset) -> None:
    """The unloaded log in two parts: with either omitted, the loaded one and the other part remain."""
    unloaded, *others = everywhere.recordings
    assert unloaded.use == "identify"
    assert unloaded.payload is None
    half = len(unloaded.time) // 2
    parts = tuple(
        replace(unloaded.part(rows), name=name, part_of="")
        for name, rows in (("first.csv", slice(0, half)), ("second.csv", slice(half, None)))
    )
    answer = diagnose(replace(everywhere, recordings=(*parts, *others)), discover=False)
    gains = {row.log: row.gains for row in answer.without_logs}
    for part in parts:
        for joint, gain in answer.after.drive_gains.items():
            assert gains[part.log][joint] == pytest.approx(gain.value, rel=0.05)
    assert "\N{EN DASH}" in without_logs_table(answer).columns[2].texts


def test_what_happened_in_one_log_hangs_on_it() -> None:
    """A spring that the first log, and the logs that judge, have; a second one, which is short, has none."""
    everywhere, plain = dataset_of(SPRING), dataset_of()
    first = next(recording.name for recording in everywhere.recordings if recording.use == "identify")
    with_it = {recording.name: recording for recording in everywhere.recordings}
    recordings = tuple(
        with_it[recording.name]
        if recording.name == first or recording.use == "validate"
        else recording.part(slice(0, len(recording.time) // 5))
        for recording in plain.recordings
    )
    answer = diagnose(replace(plain, recordings=recordings), discover=False)
    assert "joint_spring" in answer.missing
    gone = {row.log: row.gone for row in answer.without_logs}
    assert np.any(["joint_spring" in names for log, names in gone.items() if log == first])
