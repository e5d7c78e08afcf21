"""Probabilities of effects: over the sets that a search has solved."""

from dataclasses import replace

import numpy as np

from bench.api.diagnose import diagnose
from bench.diagnosis import posterior
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.posterior import shares_of, with_probability
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import EffectVerdict, ProbableSet
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate

SHORT = {"optimise": False, "duration": 6.0}


def diagnosed(*hidden):
    changes = {"design": SHORT, "hidden": list(hidden)}
    return diagnose(as_dataset(simulate(load_scenario("two_link", changes))), discover=False)


def test_what_is_there_is_probable_and_nothing_else() -> None:
    answer = diagnosed({"effect": "viscous_friction", "joint": "elbow", "Fv": 0.5})
    assert answer.missing == ("viscous_friction",)
    probability = {verdict.effect: verdict.probability for verdict in answer.ranking}
    assert probability["viscous_friction"] > 0.95
    others = [p for name, p in probability.items() if name != "viscous_friction" and p is not None]
    assert len(others) > 10
    assert max(others) < 0.05
    assert answer.sets[0].effects == ("viscous_friction",)
    assert diagnosis_json(answer)["sets"][0]["probability"] == answer.sets[0].probability


def test_where_nothing_is_hidden_nothing_is_probable() -> None:
    answer = diagnosed()
    assert answer.sets[0].effects == ()
    assert all((verdict.probability or 0.0) < 0.005 for verdict in answer.ranking)


def test_sets_that_do_as_well_share_the_probability() -> None:
    np.testing.assert_allclose(shares_of([1e4, 1e4, 1e4 - 50.0]), [0.5, 0.5, 0.0], atol=1e-12)


def test_an_effect_less_probable_than_not_is_undecided() -> None:
    told = EffectVerdict("lag", "missing", 0.2, 0.1, 50.0, ("left",), (), {}, Reason(Because.EXPLAINS))
    sets = (ProbableSet(("delay", "spring"), 0.7, 0.1), ProbableSet(("lag", "spring"), 0.3, 0.1))
    verdict = with_probability(told, 0.3, sets, ("lag", "spring"))
    assert (verdict.verdict, verdict.alternatives, verdict.probability) == (
        "indistinguishable",
        ("delay",),
        0.3,
    )
    assert with_probability(told, 0.7, sets, ("lag", "spring")) == replace(told, probability=0.7)
    assert posterior.EVEN == 0.5
