"""Every code of a check, a comparison, a plan and a replay is rendered with all values that its type admits."""

import json
from types import SimpleNamespace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.excitation.discrimination.sentences import next_step
from bench.excitation.discrimination.sentences import sentences as discriminated
from bench.excitation.experiment.proof_words import limit_in_words
from bench.excitation.experiment.sentences import sentences as planned
from bench.export.replay.causes import causes_as_data
from bench.export.replay.track import Lost
from bench.export.replay.words import lost_in_words, replay_sentences
from bench.residuals.as_json import where_json
from bench.residuals.words import overlapping, where_sentences, whole_alike, whole_sentences
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of, name_of, nearest_singularity
from tests.any_studies import (
    causes,
    checks_of,
    discriminations,
    failures,
    few,
    forecasts,
    plans_of,
    singularities,
    unproven,
)
from tests.any_values import EXAMPLE, often, rarely


@pytest.mark.parametrize("code", list(CheckCode))
@rarely
@given(data=st.data())
def test_checks_of_a_robot(code, data):
    check = data.draw(checks_of(code))
    assert name_of(check)
    assert isinstance(detail_of(check), str)


@often
@given(singularities)
def test_singularities(singularity):
    assert nearest_singularity(singularity)


@often
@given(failures)
def test_where_a_model_fails(where):
    assert len(where_sentences(where)) >= len(where.motors)
    assert isinstance(overlapping(where), str)
    json.dumps(where_json(where), allow_nan=False)
    for motor in where.motors:
        assert all(line.endswith(".") for line in (*whole_sentences(motor), *whole_alike(motor)))


@often
@given(st.data())
def test_plans(data):
    told = data.draw(forecasts)
    assert planned(data.draw(plans_of(told)), told)


@often
@given(unproven)
def test_what_is_not_proven(limit):
    assert limit_in_words(limit)


@often
@given(discriminations())
def test_two_effects_told_apart(found):
    assert discriminated(found)
    next_step(found, "bench diagnose DATASET", "folder")


@often
@given(few, st.lists(causes, max_size=3), st.booleans())
def test_replays(left_out, of_error, with_recordings):
    side = SimpleNamespace(recordings=EXAMPLE.recordings if with_recordings else ())
    result = SimpleNamespace(twin=side, model=side, left_out=left_out, causes=of_error)
    assert all(replay_sentences(result))
    assert lost_in_words(Lost("left", 1.0), of_error)
    assert len(causes_as_data(of_error)) == len(of_error)
