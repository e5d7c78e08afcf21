"""The decision rule and the tolerances, as a caller gives them."""

from dataclasses import replace

import pytest

import bench
from bench.basics.errors import BenchError
from bench.diagnosis.as_json import diagnosis_json
from bench.identification.decision import RULE, DecisionRule, deciding_by
from bench.identification.given_rule import given_rule
from bench.identification.model_json import from_json, to_json
from bench.identification.tolerances import TOLERANCES, Tolerances, bounded_by
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate


@pytest.fixture(scope="module")
def dataset():
    hidden = [{"effect": "viscous_friction", "joint": "elbow", "Fv": 0.5}]
    changes = {"design": {"optimise": False, "duration": 6.0}, "hidden": hidden}
    return as_dataset(simulate(load_scenario("two_link", changes)))


def test_a_rule_holds_while_its_context_lasts() -> None:
    assert DecisionRule().prior == RULE.prior
    with deciding_by(DecisionRule(prior=12.0)), bounded_by(None):
        assert RULE.prior == 12.0
        with deciding_by(None):
            assert RULE.prior == 12.0
        assert TOLERANCES.search.rounds == Tolerances().search.rounds
    assert DecisionRule().prior == RULE.prior


def test_an_effect_must_bring_as_much_as_the_caller_asks(dataset) -> None:
    as_usual = bench.diagnose(dataset, discover=False)
    strict = bench.diagnose(dataset, discover=False, rule=DecisionRule(prior=1e6))
    assert as_usual.missing == ("viscous_friction",)
    assert strict.missing == ()
    assert diagnosis_json(as_usual)["decision_rule"]["prior"] == DecisionRule().prior
    assert diagnosis_json(strict)["decision_rule"]["prior"] == 1e6
    assert DecisionRule().prior == RULE.prior


def test_an_answer_keeps_the_rule_and_the_bounds_by_which_it_was_made(dataset) -> None:
    bounds = replace(Tolerances(), report=replace(Tolerances().report, sets=3))
    result = bench.identify(dataset, rule=DecisionRule(shows=4.0), tolerances=bounds)
    again = from_json(to_json(result))
    assert (
        (again.rule, again.tolerances)
        == (result.rule, result.tolerances)
        == (DecisionRule(shows=4.0), bounds)
    )


def test_thresholds_are_given_by_name() -> None:
    rule, tolerances = given_rule(["prior=12", "search.rounds=3"])
    assert rule == DecisionRule(prior=12.0)
    assert tolerances.search.rounds == 3
    assert given_rule([]) == (DecisionRule(), Tolerances())


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ("priors=12", "did you mean 'prior'"),
        ("search.round=3", "did you mean 'search.rounds'"),
        ("prior", "has no value"),
        ("search=3", "no such threshold"),
        ("prior=much", "prior=much: input should be a valid number"),
        ("search.rounds=2.5", "search.rounds=2.5: input should be a valid integer"),
    ],
)
def test_a_threshold_that_is_none_is_refused(given: str, said: str) -> None:
    with pytest.raises(BenchError, match=said):
        given_rule([given])
