"""Answers that are not to be believed say so first, and one rule decides headline, rows and JSON."""

from dataclasses import replace

import pytest

from bench.dataset.dataset import HeavyPayload
from bench.dataset.robot import load_robot
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.result import LadderStep, Remainder
from bench.diagnosis.summary import doubts, summary_sentences
from bench.identification.finding import Code, Finding
from bench.identification.findings import runaway, with_findings
from bench.identification.result import ErrorSummary
from tests.diagnosis_kit import OTHERS, VISCOUS, found_diagnosis
from tests.shown import dataset_of

FAMILIAR = "Check columns, signs and payloads"


@pytest.fixture(scope="module")
def found():
    return found_diagnosis(dataset_of(load_robot("five_bar")))


def with_gain(diagnosis, ratio):
    gains = dict(diagnosis.after.drive_gains)
    gains["left"] = replace(gains["left"], value=ratio * gains["left"].nominal)
    return replace(diagnosis, after=replace(diagnosis.after, drive_gains=gains))


@pytest.mark.parametrize("ratio", [2.1, 0.45, 138.0, -1.0])
def test_a_gain_far_from_nominal_is_doubted_whatever_the_error(found, ratio):
    far = with_gain(found, ratio)
    said = summary_sentences(far)
    assert "seems to be missing" in said[0]
    assert said[1].startswith("The named effects may be wrong. The estimated drive gain of left is")
    none = summary_sentences(replace(far, missing=(), ladder=found.ladder[:1], ranking=OTHERS))
    assert none[1].startswith("The estimated drive gain of left is")
    assert (
        with_findings(far.after, ())
        .notes[0]
        .startswith("Do not use this answer. The estimated drive gain of left")
    )


@pytest.mark.parametrize(
    ("ratio", "asked"), [(1e3, "is the payload's mass in grams?"), (1e-3, "are the currents in mA?")]
)
def test_gains_that_are_all_a_thousand_times_off_are_asked_about_in_every_answer_alike(found, ratio, asked):
    gains = {
        name: replace(gain, value=ratio * gain.nominal) for name, gain in found.after.drive_gains.items()
    }
    off = replace(found, after=replace(found.after, drive_gains=gains))
    assert summary_sentences(off)[1].startswith(
        "The named effects may be wrong. The estimated drive gains are about"
    )
    assert asked in summary_sentences(off)[1]
    notes = with_findings(off.after, ()).notes
    assert [asked in text for text in notes] == [True, *[False] * (len(notes) - 1)]
    assert not any("no drive differs that much" in text for text in notes)


def test_a_payload_in_grams_makes_names_doubtful_by_the_import_s_question(found):
    heavy = Finding(Code.PAYLOAD_HEAVY, ("disc",), numbers={"mass": 500.0, "own": 4.21})
    asked = replace(found, after=replace(found.after, findings=(heavy, *found.after.findings)))
    said = summary_sentences(asked)[1]
    question = HeavyPayload("disc", 500.0, 4.21).words
    assert said.startswith(f"The named effects may be wrong. T{question[1:]} Correct it")


@pytest.mark.parametrize("ratio", [0.6, 1.0, 1.21, 1.9])
def test_a_gain_as_makers_give_it_is_not(found, ratio):
    assert runaway(with_gain(found, ratio).after) is None
    assert runaway(replace(with_gain(found, 5.0).after, gains_fitted=False)) is None


def test_parameters_without_a_deviation_are_doubted(found):
    first, *others = found.after.parameters
    bad = replace(
        found, after=replace(found.after, parameters=(replace(first, value=-1.5e8, std=0.0), *others))
    )
    assert "without a known standard error" in " ".join(doubts(bad))
    decided = replace(found, after=replace(found.after, scaled_condition=2.7e8))
    assert "rounding errors determine" in " ".join(doubts(decided))


def test_what_only_resembles_says_so_in_headline_row_and_json(found):
    like = replace(found, ranking=(replace(VISCOUS, verdict="resembles"), *OTHERS))
    assert summary_sentences(like)[0].startswith(
        "Something that resembles viscous friction at left is missing"
    )
    friction = replace(VISCOUS, effect="coulomb_friction")
    both = replace(like, missing=("viscous_friction", "coulomb_friction"), ranking=(*like.ranking, friction))
    assert summary_sentences(both)[0].startswith(
        "Coulomb friction at left, and something that resembles viscous friction at left are missing"
    )
    answer = diagnosis_json(like)
    assert answer["ranking"][0]["verdict"] == "resembles"
    assert answer["ranking"][0]["alternatives"] == []


def test_a_good_model_of_a_real_machine_is_not_told_to_check_its_columns(found):
    def left(error):
        unexplained = replace(found.unexplained, what=Remainder.PATTERN, error=error, noise_floor=0.0003)
        return " ".join(doubts(replace(found, unexplained=unexplained)))

    assert FAMILIAR not in left(0.0296)
    assert FAMILIAR in left(0.24)


def test_where_most_of_the_current_is_left_no_model_explains_it(found):
    left = replace(found.unexplained, what=Remainder.PATTERN, error=0.9)
    ladder = (LadderStep((), 1.4, 1.3), LadderStep(("viscous_friction",), 0.8, 0.9))
    said = summary_sentences(replace(found, unexplained=left, ladder=ladder))[0]
    assert said.startswith("No model of this program explains these currents: ")
    assert "the best one has an error of 90 % of the current" in said
    assert "It adds viscous friction at left" in said
    nothing = replace(found, unexplained=left, ladder=ladder[:1], missing=(), ranking=OTHERS)
    said = summary_sentences(nothing)[0]
    assert said.startswith("No model of this program explains these currents: ")
    assert "the error is 130 % of the current" in said
    noise = replace(nothing, unexplained=replace(left, what=Remainder.NOISE, noise_floor=0.9))
    assert summary_sentences(noise)[0].startswith("No effect of the catalogue is missing")


@pytest.mark.parametrize(("validate", "reported"), [(0.9, 0.9), (0.0, 0.0), (None, 0.8)])
def test_the_error_of_fitted_recordings_is_reported_where_there_are_no_others(
    validate: float | None, reported: float
) -> None:
    assert LadderStep((), 0.8, validate).reported == reported
    assert ErrorSummary(0.8, validate, {}, {}, {}).reported == reported
