"""A recording that carries another load than declared is named; a model that lacks an effect is not suspected."""

from dataclasses import replace

import pytest

from bench.api.diagnose import diagnose
from bench.dataset.dataset import load_dataset
from bench.diagnosis.summary import summary_sentences
from bench.identification.finding import Code
from bench.identification.finding_words import sentence
from bench.identification.identify import identify
from bench.identification.other_loads import other_load
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from tests.workbench_kit import FRICTION, write_dataset

RIPPLE = {"effect": "cogging_torque", "joint": "left", "a": 0.3, "b": 0.1, "period": 0.4}


@pytest.fixture(scope="module")
def lacking(tmp_path_factory):
    """A five-bar with friction and cogging that the model does not have."""
    return load_dataset(write_dataset(tmp_path_factory.mktemp("loads") / "d", hidden=[*FRICTION, RIPPLE]))


def declared(dataset, name, load):
    recordings = [replace(one, payload=load) if one.name == name else one for one in dataset.recordings]
    return replace(dataset, recordings=tuple(recordings))


def suspected(dataset):
    problem = problem_of(dataset)
    return other_load(problem, identify(prepare(problem)))


def test_nothing_is_suspected_of_a_missing_effect(lacking):
    assert identify(prepare(problem_of(lacking))).error.identify > 0.05
    assert suspected(lacking) == []


def test_every_recording_that_is_declared_wrongly_is_named(lacking):
    for one in lacking.recordings:
        (load,) = {other.payload for other in lacking.recordings} - {one.payload}
        wrong = declared(lacking, one.name, load)
        if len({other.payload for other in wrong.recordings if other.use == "identify"}) < 2:
            continue  # without a loaded and an unloaded one that are fitted, gains are nominal
        (found,) = suspected(wrong)
        assert found.code == Code.OTHER_LOAD
        name, _, said, other = found.names
        assert (name, said or None, other or None) == (one.name, load, one.payload)


def test_a_diagnosis_says_so_first_and_looks_for_no_law(lacking):
    loaded = next(one for one in lacking.recordings if one.use == "validate" and one.payload)
    diagnosis = diagnose(declared(lacking, loaded.name, None))
    assert diagnosis.discovered == ()
    said = " ".join(summary_sentences(diagnosis)[:2])
    assert f"{loaded.name} is declared to carry no payload but probably carries" in said
    (found,) = [one for one in diagnosis.after.findings if one.code == Code.OTHER_LOAD]
    assert sentence(found) in said
