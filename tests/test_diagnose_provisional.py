"""A model that a search goes by need not be converged to the end; an answer is."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnosis.base_model import base_model_of
from bench.diagnosis.discovery import with_laws
from bench.effects import CATALOGUE, EffectInstance
from bench.identification.nonlinear import converged, converged_from
from bench.identification.prepare import prepare, with_effects
from bench.identification.problem import problem_of
from bench.identification.solve_only import solved_quickly
from bench.truth.dataset import as_dataset
from tests.discover_kit import simulated

HIDDEN = {"effect": "geometric_error", "joint": "left", "error": 0.004}


def test_a_provisional_model_is_converged_before_it_is_told():
    start = prepare(problem_of(as_dataset(simulated(HIDDEN))))
    base_model = base_model_of(start)
    asked = [
        EffectInstance(CATALOGUE["geometric_error"], body, f"geometric_error:{body}")
        for body in ("left_crank", "right_crank")
    ]
    begun = with_effects(start, asked, fitted_only=True)
    once, whole = converged_from(start, begun, most=1), converged(begun)
    assert (once.converged, once.provisional) == (True, True)
    assert (whole.converged, whole.provisional) == (True, False)
    for model in (once, whole):
        assert all(observation.effects.shape[2] == 2 for observation in model.observations)
    exact = base_model.exactly(once)
    assert not exact.provisional
    assert base_model.exactly(exact) is exact
    gains = [solved_quickly(model)[1].gains for model in (exact, whole)]
    np.testing.assert_allclose(*gains, rtol=1e-4)


def test_a_table_that_is_not_in_the_best_set_is_searched_no_further(monkeypatch: pytest.MonkeyPatch):
    table: Any = SimpleNamespace(name="measured_left", instances=())
    base_model: Any = SimpleNamespace(start=SimpleNamespace(effects=()), with_instances=lambda _: "model")
    last = SimpleNamespace(proposals=[])
    finding: Any = SimpleNamespace(
        base_model=base_model, last=last, model=SimpleNamespace(effects=()), names=(), barred={}
    )
    left = SimpleNamespace(significant=True, much=True)
    plain = with_laws.AnswerWithLaws(finding, (), SimpleNamespace(unexplained=left))
    case: Any = SimpleNamespace(problem=SimpleNamespace(catalogue={}))
    monkeypatch.setattr(with_laws, "tabled_laws", lambda *_: [table])
    monkeypatch.setattr(with_laws, "_proposed", lambda *_: [])
    monkeypatch.setattr(with_laws, "round_from", lambda *_: SimpleNamespace(names={"coulomb_friction"}))
    monkeypatch.setattr(with_laws, "search_from", lambda *_: pytest.fail("nothing is to be searched"))
    assert with_laws._with_tables(case, plain, SimpleNamespace(phase=lambda _: None)) is plain
