"""What a set of effects must bring to be taken, and that what a search ends with was converged."""

from dataclasses import dataclass
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnosis import catalogue_search, noise, rounds, search
from bench.diagnosis.normal_equations import SetFit
from bench.diagnosis.search import NEEDED, Scored, earned, score


@pytest.mark.parametrize(
    ("judged", "fitted", "total", "enough"),
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
    judged: float, fitted: float, total: float, enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A redundant robot's current noise, carried through closures, made errors of the gains look like an effect."""
    squares = {(): 1.0, (3,): 0.8}
    scores = {(): (0.0, 0.0, 0.0), (3,): (judged, fitted, total)}
    monkeypatch.setattr(
        search,
        "solve_set",
        lambda _, key: SimpleNamespace(
            chosen=key, judged=squares[tuple(key)], by_motor=np.full((2, 1), squares[tuple(key)])
        ),
    )
    monkeypatch.setattr(search, "score", lambda _, fit, __: Scored(fit, *scores[tuple(fit.chosen)]))
    fit = search.solve_set(None, (3,))  # type: ignore[arg-type]
    one = search.score(None, fit, None)  # type: ignore[arg-type]
    assert earned(None, one, None) is enough  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("left", "enough"), [((1.0, 0.03), True), ((1.0, 0.3), False)], ids=["little is left", "half of it"]
)
def test_an_effect_that_leaves_little_of_the_error_of_one_motor_matters(
    left: tuple[float, float], enough: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A law at one motor of a hexapod that took its error from 4 to 0.13 % was 2 % of what was weighted in all."""
    squares = {(): 1.0, (3,): 0.98}
    by_motor = {(): np.array([1.0, 1.0]), (3,): np.array(left)}
    monkeypatch.setattr(
        search,
        "solve_set",
        lambda _, key: SimpleNamespace(
            chosen=key, judged=squares[tuple(key)], by_motor=np.stack([by_motor[tuple(key)]] * 2)
        ),
    )
    far = 5.0 * NEEDED
    monkeypatch.setattr(
        search, "score", lambda _, fit, __: Scored(fit, *((far,) * 3 if fit.chosen else (0.0,) * 3))
    )
    fit = search.solve_set(None, (3,))  # type: ignore[arg-type]
    one = search.score(None, fit, None)  # type: ignore[arg-type]
    assert earned(None, one, None) is enough  # type: ignore[arg-type]


@pytest.mark.parametrize("heavy", [1.0, 1e6])
def test_evidence_is_summed_motor_by_motor(heavy: float) -> None:
    """What one motor gains does not saturate because the present model counts another for far more."""
    rows = SimpleNamespace(rows=300, rows_of_motor=np.array([100.0, 200.0]))
    system = SimpleNamespace(
        fitted=rows, judged=rows, memory=2.0, repeats=1.0, prior_of=lambda _: 0.0, start=SimpleNamespace()
    )

    def fit(left: float, columns: int) -> SetFit:
        by_motor = np.array([[left, heavy], [left, heavy]])
        return SetFit((), np.arange(columns), np.zeros(columns), np.ones(2), 0.0, 0.0, by_motor)

    scored = score(system, fit(1e-4, 3), fit(1.0, 3))  # type: ignore[arg-type]
    expected = 0.5 * 100.0 / 2.0 * np.log(1e4)
    assert scored.judged == pytest.approx(expected)
    assert scored.fitted == pytest.approx(expected)
    assert scored.total == pytest.approx(2.0 * expected)


@dataclass(frozen=True)
class FakeRound:
    """A round of a search with a set of one effect; converged: whether its model is of that set."""

    chosen: tuple[int, ...]
    model: float
    converged: bool = False
    cut: bool = False


@pytest.mark.parametrize(("factor", "last"), [(0.9, rounds.ROUNDS - 1), (0.99, 0)])
def test_a_search_ends_with_a_settled_set_that_leaves_clearly_less(
    factor: float, last: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Partners without end: each leaves this share of the error that the one before it has left."""
    names = count(1)

    def again(_: object, here: FakeRound, __: object, ___: object, before: FakeRound | None) -> FakeRound:
        found = FakeRound(here.chosen, factor ** here.chosen[0], converged=True)
        return found if before is None or found.model < 0.97 * before.model else before

    monkeypatch.setattr(rounds, "_again", again)
    monkeypatch.setattr(rounds, "_with_partner", lambda *_: FakeRound((next(names),), 1.0))
    found = rounds.searched(None, FakeRound((0,), 1.0), ())  # type: ignore[arg-type]
    assert found == FakeRound((last,), factor**last, converged=True)


@pytest.mark.parametrize(
    ("left", "expected"), [(1.0, True), (1.015, True), (1.03, False), (0.5, False), (4.0, False)]
)
def test_nothing_is_lacking_where_no_more_than_noise_is_left(
    left: float, expected: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """1000 independent samples: 10 nats are 2 % of the squares. Half the noise means that it is not white."""
    weights, floor = np.array([2.0, 0.5]), np.array([0.3, 0.1])
    moving = np.ones((1000, 2), dtype=bool)
    monkeypatch.setattr(
        noise, "solved_quickly", lambda _: (SimpleNamespace(moving=moving), SimpleNamespace(weights=weights))
    )
    monkeypatch.setattr(noise, "spread", lambda *_: np.sqrt(left) * floor)
    system = SimpleNamespace(fitted=SimpleNamespace(rows=2000), memory=2.0)
    squares = floor**2 * 1000
    assert noise.leaves_only_noise(system, None, squares) is expected  # type: ignore[arg-type]
    assert not noise.leaves_only_noise(system, None, None)  # type: ignore[arg-type]


@pytest.mark.parametrize("possible", [True, False], ids=["only nearly so", "as it is"])
def test_no_effect_goes_because_of_what_is_only_nearly_so(
    possible: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    def where_possible(_: object, model: str, __: object) -> tuple[Any, Any, dict[str, str]]:
        asked.append(model)
        out = {} if possible and model == "exact" else {"found": "of an impossible sign"}
        return SimpleNamespace(effects=()), model, out

    def searched(_: object, first: str, barred: dict[str, str], __: object) -> Any:
        if barred:
            raise StopIteration(first, dict(barred))
        return SimpleNamespace(model="near", cut=False)

    monkeypatch.setattr(catalogue_search, "searched", searched)
    monkeypatch.setattr(catalogue_search, "_where_possible", where_possible)
    monkeypatch.setattr(catalogue_search, "leaving", lambda _, model, after, __: (model, after, ()))
    monkeypatch.setattr(catalogue_search, "fits_of", lambda *_: None)
    monkeypatch.setattr(catalogue_search, "ladder_of", lambda *_: ())
    origin: Any = SimpleNamespace(
        start=SimpleNamespace(effects=()), exactly=lambda _: "exact", in_search=None, with_instances=None
    )
    origin.at_leisure = origin
    case: Any = SimpleNamespace(start=SimpleNamespace(effects=()), before=None)
    if possible:
        assert catalogue_search.search_from(case, origin, None).after == "exact"  # type: ignore[arg-type, comparison-overlap]
    else:
        with pytest.raises(StopIteration) as ended:
            catalogue_search.search_from(case, origin, None)  # type: ignore[arg-type]
        assert ended.value.args[1] == {"found": "of an impossible sign"}
    assert asked == ["near", "exact"]
