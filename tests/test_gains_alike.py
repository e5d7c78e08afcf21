"""A wrong declared mass moves all drive gains alike, and every answer says so before it offers its gains."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.cli.last_lines import after_diagnosis
from bench.dataset.payload import Payload
from bench.dataset.robot import load_robot
from bench.diagnosis.summary import summary_sentences
from bench.identification.finding import Code
from bench.identification.findings import with_findings
from tests.diagnosis_kit import found_diagnosis
from tests.shown import dataset_of

DISC = {"disc": Payload("disc", 2.1)}
ALIKE = {"left": 1.65, "right": 1.87}


@pytest.fixture(scope="module")
def found():
    return found_diagnosis(dataset_of(load_robot("five_bar")))


def with_gains(result, ratios, error=0.01):
    gains = {
        joint: replace(gain, value=ratios[joint] * gain.nominal, std=0.01 * gain.nominal)
        for joint, gain in result.drive_gains.items()
    }
    carried = tuple(
        replace(series, payload="disc" if i == 0 else None) for i, series in enumerate(result.recordings)
    )
    errors = replace(result.error, identify=error, validate=error)
    changed = replace(result, drive_gains=gains, recordings=carried, error=errors, gains_fitted=True)
    return with_findings(replace(changed, findings=()), (), payloads=DISC)


def test_gains_off_by_like_factors_point_to_the_declared_mass(found):
    result = with_gains(found.after, ALIKE)
    assert result.findings[0].code is Code.GAINS_ALIKE
    likely = 2.1 / np.sqrt(1.65 * 1.87)
    said = f"The declared mass of disc, 2.1 kg, is probably wrong: with {likely:.2g} kg"
    assert said in result.notes[0]
    assert Code.GAIN_FAR not in {finding.code for finding in result.findings}
    diagnosis = replace(found, after=result)
    assert said in summary_sentences(diagnosis)[1]
    step = after_diagnosis(diagnosis, Path("data"), "bench diagnose data", None)
    assert "--apply" not in step
    assert "after correcting" in step


@pytest.mark.parametrize(
    ("ratios", "error"),
    [
        ({"left": 1.08, "right": 1.0}, 0.01),  # as makers state them
        ({"left": 1.65, "right": 1.0}, 0.01),  # one gain
        (ALIKE, 0.3),  # a missing effect may move gains as well
    ],
)
def test_the_mass_is_not_blamed_otherwise(found, ratios, error):
    result = with_gains(found.after, ratios, error)
    assert Code.GAINS_ALIKE not in {finding.code for finding in result.findings}


def test_one_gain_far_from_nominal_is_doubted_in_the_summary(found):
    diagnosis = replace(found, after=with_gains(found.after, {"left": 1.65, "right": 1.0}))
    assert summary_sentences(diagnosis)[1].startswith("The estimated drive gain of left is")
