"""The set of effects that is reached from others by changing one member at a time."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis import search
from bench.diagnosis.search import Scored, best_set

SPRING, OFFSET, LAW, FRICTION = range(4)
TOTALS = {
    frozenset({SPRING}): 50.0,
    frozenset({LAW}): 40.0,
    frozenset({SPRING, FRICTION}): 6500.0,
    frozenset({SPRING, LAW}): 7190.0,
    frozenset({OFFSET, LAW}): 7200.0,
}


def fit_of(chosen: Any) -> Any:
    """A set that is solved."""
    return SimpleNamespace(chosen=tuple(sorted(chosen)))


def test_where_a_sign_is_impossible_a_neighbour_takes_the_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """A spring stands for an offset as long as the law is not known; with the law it would have to push."""

    def scored(_: Any, fit: Any) -> Scored:
        total = TOTALS.get(frozenset(fit.chosen), 0.0)
        return Scored(fit, total, total)

    monkeypatch.setattr(search, "solve_set", lambda _, chosen: fit_of(chosen))
    monkeypatch.setattr(search, "solve_sets", lambda _, sets: [fit_of(some) for some in sets])
    monkeypatch.setattr(search, "score", scored)
    monkeypatch.setattr(search, "possible", lambda _, fit: not {SPRING, LAW} <= set(fit.chosen))
    monkeypatch.setattr(search, "simplest", lambda _, some, __: some)
    best = best_set(SimpleNamespace(), [(SPRING, LAW)], range(4))  # type: ignore[arg-type]
    assert set(best.fit.chosen) == {OFFSET, LAW}
