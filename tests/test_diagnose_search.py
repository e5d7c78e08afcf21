"""What a set of effects must bring to be taken, and that what a search ends with was settled."""

from dataclasses import dataclass
from itertools import count
from types import SimpleNamespace

import pytest

from bench.diagnosis import rounds, search
from bench.diagnosis.search import NEEDED, Scored, earned


@pytest.mark.parametrize(
    ("checked", "fitted", "total", "enough"),
    [
        (5.0 * NEEDED, 5.0 * NEEDED, 9.0 * NEEDED, True),
        (5.0 * NEEDED, 0.2 * NEEDED, 3.0 * NEEDED, False),
        (0.5 * NEEDED, 5.0 * NEEDED, 3.0 * NEEDED, False),
        (2.0 * NEEDED, 2.0 * NEEDED, 0.5 * NEEDED, False),
    ],
    ids=[
        "on both",
        "only where it was not fitted",
        "only where it was fitted",
        "less than its unknowns cost",
    ],
)
def test_an_effect_earns_its_place_on_fitted_recordings_and_on_others(
    checked: float, fitted: float, total: float, enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A redundant robot's current noise, carried through closures, made errors of the gains look like an effect."""
    squares = {(): 1.0, (3,): 0.8}
    scores = {(): (0.0, 0.0, 0.0), (3,): (checked, fitted, total)}
    monkeypatch.setattr(
        search, "solve_set", lambda _, key: SimpleNamespace(chosen=key, checked=squares[tuple(key)])
    )
    monkeypatch.setattr(search, "score", lambda _, fit, __: Scored(fit, *scores[tuple(fit.chosen)]))
    fit = search.solve_set(None, (3,))  # type: ignore[arg-type]
    one = search.score(None, fit, None)  # type: ignore[arg-type]
    assert earned(None, one, None) is enough  # type: ignore[arg-type]


@dataclass(frozen=True)
class FakeRound:
    """A round of a search with a set of one effect; settled: whether its model is of that set."""

    chosen: tuple[int, ...]
    model: float
    settled: bool = False


@pytest.mark.parametrize(("factor", "last"), [(0.9, rounds.ROUNDS - 1), (0.99, 0)])
def test_a_search_ends_with_a_settled_set_that_leaves_clearly_less(
    factor: float, last: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Partners without end: each leaves this share of the error that the one before it has left."""
    names = count(1)

    def again(_: object, here: FakeRound, *__: object) -> FakeRound:
        return FakeRound(here.chosen, factor ** here.chosen[0], settled=True)

    monkeypatch.setattr(rounds, "_again", again)
    monkeypatch.setattr(rounds, "_with_partner", lambda *_: FakeRound((next(names),), 1.0))
    monkeypatch.setattr(rounds, "error_of", lambda model: model)
    found = rounds.searched(None, FakeRound((0,), 1.0), ())  # type: ignore[arg-type]
    assert found == FakeRound((last,), factor**last, settled=True)
