"""No answer is worse on held-out recordings than viscous and Coulomb friction and an offset."""

import json

import pytest

from bench.api.diagnose import diagnose
from bench.api.identify import identify
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.reason import Because
from bench.diagnosis.result import Diagnosis
from bench.diagnosis.summary import summary_of
from bench.identification.decision import DecisionRule
from bench.page.verdict import diagnosis_tiles, diagnosis_verdict
from tests.discover_kit import measured

HIDDEN = ({"effect": "coulomb_friction", "Fc": 0.1}, {"effect": "viscous_friction", "Fv": 0.05})
USUAL = ("viscous_friction", "coulomb_friction", "constant_offset")


@pytest.fixture(scope="module")
def dataset():
    return measured(*HIDDEN)


@pytest.fixture(scope="module")
def unproven(dataset) -> Diagnosis:
    """A diagnosis of a rule to which no data prove an effect."""
    return diagnose(dataset, discover=False, rule=DecisionRule(prior=1e6))


def test_an_answer_that_names_nothing_is_no_worse_than_the_usual_friction(dataset, unproven):
    usual = identify(dataset, USUAL).error.validate
    assert unproven.missing == ()
    assert unproven.after.error.validate <= usual
    assert unproven.before.error.validate > 2.0 * usual
    assert set(unproven.usual) <= set(USUAL)
    assert {"viscous_friction", "coulomb_friction"} <= set(unproven.usual)
    assert unproven.ladder[-1].validate == pytest.approx(unproven.after.error.validate)
    assert set(unproven.ladder[-1].effects) == set(unproven.usual)


def test_it_says_so_and_gives_the_values(unproven):
    (said,) = [sentence for sentence in summary_of(unproven).sentences if "in the model, too" in sentence]
    assert "iscous friction" in said
    assert said in diagnosis_verdict(unproven)
    tile = next(tile for tile in diagnosis_tiles(unproven) if tile.label == "Missing effects")
    assert tile.value == "none"
    answer = json.loads(json.dumps(diagnosis_json(unproven), allow_nan=False))
    entry = next(entry for entry in answer["ranking"] if entry["effect"] == "viscous_friction")
    assert entry["verdict"] == "not supported"
    assert entry["reason"]["because"] == Because.USUAL
    assert entry["size"]
    assert answer["after"]["effect_parameters"]["viscous_friction"]["left"]["Fv"]["value"] == pytest.approx(
        0.05, rel=0.1
    )


def test_friction_that_is_proven_is_missing(dataset):
    found = diagnose(dataset, discover=False)
    assert set(found.missing) == {"viscous_friction", "coulomb_friction"}
    assert found.usual == ()
