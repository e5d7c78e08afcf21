"""Probabilities of effects: over the sets that a search has solved."""

from dataclasses import replace

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.diagnosis.as_json import diagnosis_json
from bench.diagnosis.evidence import Samples
from bench.diagnosis.posterior import Posterior, shares_of, something_else, with_probability
from bench.diagnosis.reason import Because, Reason
from bench.diagnosis.result import EffectVerdict, ProbableSet, Remainder, Unexplained
from bench.identification.decision import RULE
from bench.scenario.scenario import load_scenario
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

SHORT = {"optimise": False, "duration": 6.0}


def diagnosed(*hidden):
    changes = {"design": SHORT, "hidden": list(hidden), "step": STEP}
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
    written = diagnosis_json(answer)
    assert written["sets"][0]["probability"] == answer.sets[0].probability
    (friction,) = (entry for entry in written["ranking"] if entry["effect"] == "viscous_friction")
    assert friction["places"]["elbow"] > 0.95
    assert friction["places"]["shoulder"] < 0.5
    assert written["something_else"] == answer.something_else < 0.01


def test_what_no_model_has_is_something_else() -> None:
    """Crosstalk between the drives' currents is in no catalogue."""
    answer = diagnosed({"effect": "current_crosstalk", "c": 0.2})
    assert answer.unexplained.much
    assert answer.something_else > 0.99


def test_the_more_is_left_the_fewer_samples_count() -> None:
    """An error that is the model's returns with the motion: its samples do not say the same thing independently."""
    many = Samples(np.full(2, 5000.0), np.full(2, 3000.0))
    gained = []
    for excess in (0.0, 0.3, 1.0):
        samples = many.beyond(excess)
        with_effect, without = np.full((2, 2), 0.9), np.ones((2, 2))
        gained.append(
            samples.log_posterior(with_effect, 1, RULE.prior) - samples.log_posterior(without, 0, 0.0)
        )
    assert gained[0] > 10.0
    assert gained[2] < 0.0
    assert gained[0] > gained[1] > gained[2]


@pytest.mark.parametrize(("excess", "low", "high"), [(0.0, 0.0, 1e-6), (0.5, 0.99, 1.0), (np.inf, 1.0, 1.0)])
def test_something_else_is_as_probable_as_what_is_left(excess: float, low: float, high: float) -> None:
    left = Unexplained(Remainder.PATTERN, 0.01 * np.exp(excess), 0.0 if np.isinf(excess) else 0.01, ())
    many = Samples(np.full(2, 500.0), np.full(2, 300.0))
    assert low <= something_else(Posterior(np.zeros(0), (), 0.9), many, left) <= high


def test_where_nothing_is_hidden_nothing_is_probable() -> None:
    answer = diagnosed()
    assert answer.sets[0].effects == ()
    assert all((verdict.probability or 0.0) < 0.005 for verdict in answer.ranking)


def test_sets_that_do_as_well_share_the_probability() -> None:
    np.testing.assert_allclose(shares_of([1e4, 1e4, 1e4 - 50.0]), [0.5, 0.5, 0.0], atol=1e-12)


def test_an_effect_that_is_not_sure_is_undecided() -> None:
    told = EffectVerdict("lag", "missing", 0.2, 0.1, 50.0, ("left",), (), {}, Reason(Because.EXPLAINS))
    sets = (ProbableSet(("delay", "spring"), 0.7, 0.1), ProbableSet(("lag", "spring"), 0.3, 0.1))
    for probability in (0.3, 0.7):
        verdict = with_probability(told, probability, sets, ("lag", "spring"))
        assert (verdict.verdict, verdict.alternatives) == ("indistinguishable", ("delay",))
        assert verdict.probability == probability
    assert with_probability(told, 0.97, sets, ("lag", "spring")) == replace(told, probability=0.97)
    alone = (ProbableSet(("spring",), 0.6, 0.1), ProbableSet(("lag", "spring"), 0.4, 0.1))
    assert with_probability(told, 0.4, alone, ("lag", "spring")).verdict == "resembles"
    assert with_probability(told, 0.6, alone, ("lag", "spring")).verdict == "missing"


def test_where_sets_with_neither_an_effect_nor_its_alternatives_are_probable_it_only_resembles() -> None:
    told = EffectVerdict(
        "length", "indistinguishable", 0.2, 0.19, 50.0, ("",), ("zero",), {}, Reason(Because.EXPLAINS)
    )
    nothing = (ProbableSet((), 0.99, 0.2), ProbableSet(("length",), 0.01, 0.19))
    verdict = with_probability(told, 0.01, nothing, ("length",))
    assert (verdict.verdict, verdict.alternatives) == ("resembles", ())
    either = (ProbableSet(("zero",), 0.99, 0.2), ProbableSet(("length",), 0.01, 0.19))
    assert with_probability(told, 0.01, either, ("length",)).alternatives == ("zero",)


def test_another_effect_that_is_not_improbable_is_undecided() -> None:
    why = Reason(Because.GAINS_LITTLE)
    told = EffectVerdict("delay", "not supported", 0.1, 0.1, 5.0, (), (), {}, why)
    sets = (ProbableSet(("lag", "spring"), 0.7, 0.1), ProbableSet(("delay", "spring"), 0.3, 0.1))
    verdict = with_probability(told, 0.3, sets, ("lag", "spring"))
    assert (verdict.verdict, verdict.alternatives) == ("indistinguishable", ("lag",))
    assert verdict.why.because is Because.AS_GOOD
    assert with_probability(told, 0.01, sets, ("lag", "spring")).verdict == "not supported"
