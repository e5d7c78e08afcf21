"""The set of effects and terms that is reached from others by changing one member at a time."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis.discovery import choose
from bench.diagnosis.search import Scored

SPRING, OFFSET, LAW, FRICTION = range(4)
TOTALS = {
    frozenset({SPRING}): 50.0,
    frozenset({LAW}): 40.0,
    frozenset({SPRING, FRICTION}): 6500.0,
    frozenset({SPRING, LAW}): 7190.0,
    frozenset({OFFSET, LAW}): 7200.0,
}


def test_where_a_sign_is_impossible_a_neighbour_takes_the_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """A spring stands for an offset as long as the law is not known; with the law it would have to push."""

    def scored(_: Any, fit: Any, __: Any) -> Scored:
        total = TOTALS.get(frozenset(fit.chosen), 0.0)
        return Scored(fit, total, total, total)

    monkeypatch.setattr(choose, "solve_set", lambda _, chosen: SimpleNamespace(chosen=tuple(chosen)))
    monkeypatch.setattr(
        choose, "solve_sets", lambda _, sets: [SimpleNamespace(chosen=tuple(one)) for one in sets]
    )
    monkeypatch.setattr(choose, "score", scored)
    monkeypatch.setattr(choose, "earned", lambda _, one, __: one.total > 0.0)
    monkeypatch.setattr(choose, "possible", lambda _, fit: not {SPRING, LAW} <= set(fit.chosen))
    monkeypatch.setattr(choose, "simplest", lambda _, one, __: one)
    best = choose.best_set(SimpleNamespace(), [(SPRING, LAW)], range(4))  # type: ignore[arg-type]
    assert set(best.fit.chosen) == {OFFSET, LAW}
