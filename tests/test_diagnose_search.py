"""What a set of effects must bring to be taken, and that what a search ends with was converged."""

from dataclasses import dataclass
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.diagnosis import noise, rounds
from bench.diagnosis import search_from as from_rounds
from bench.diagnosis.evidence import Samples
from bench.diagnosis.search import score
from bench.diagnosis.system import SetFit
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES


def system_of(rows: list[float], judged: list[float] | None = None) -> SimpleNamespace:
    """Whose motors have so many independent samples, fitted and judged; as many judged where not said."""
    samples = Samples(np.array(rows), np.array(rows if judged is None else judged))
    counts = SimpleNamespace(rows_of_motor=np.array(rows))
    return SimpleNamespace(
        samples=samples,
        held_out=counts,
        autocorrelation_time=1.0,
        prior_of=lambda chosen: RULE.prior * len(chosen),
    )


def fit_of(chosen: tuple[int, ...], columns: int, by_motor: list[list[float]]) -> SetFit:
    """A set that leaves these squares, fitted and judged, of every motor."""
    return SetFit(
        chosen, np.arange(columns), np.zeros(columns), np.ones(2), 0.0, 0.0, np.array(by_motor, dtype=float)
    )


@pytest.mark.parametrize("samples", [1e3, 1e9])
@pytest.mark.parametrize(("error", "more"), [(0.93, True), (0.97, False)])
def test_an_effect_must_take_a_share_of_the_error_away_however_long_the_log(
    samples: float, error: float, more: bool
) -> None:
    system = system_of([samples, samples])
    without = score(system, fit_of((), 3, [[1.0, 1.0]] * 2))  # type: ignore[arg-type]
    with_it = score(system, fit_of((0,), 4, [[error**2, 1.0]] * 2))  # type: ignore[arg-type]
    assert (with_it.total > without.total) is more


def test_where_samples_are_few_they_count_in_full() -> None:
    """Half of an error says little of an effect with five samples, and enough with a hundred."""
    for samples, more in ((5.0, False), (100.0, True)):
        system = system_of([samples, samples])
        without = score(system, fit_of((), 3, [[1.0, 1.0]] * 2))  # type: ignore[arg-type]
        with_it = score(system, fit_of((0,), 4, [[0.25, 1.0]] * 2))  # type: ignore[arg-type]
        assert (with_it.total > without.total) is more


@pytest.mark.parametrize("heavy", [1.0, 1e6])
def test_evidence_is_summed_motor_by_motor(heavy: float) -> None:
    """What one motor gains does not saturate because the present model counts another for far more."""
    system = system_of([100.0, 200.0])
    with_it, without = (
        score(system, fit_of((), 3, [[left, heavy]] * 2))  # type: ignore[arg-type]
        for left in (1e-4, 1.0)
    )
    assert with_it.held_out - without.held_out == pytest.approx(0.5 * 100.0 * np.log(1e4))
    share = RULE.coarsening / (RULE.coarsening + 200.0)
    assert with_it.total - without.total == pytest.approx(share * 100.0 * np.log(1e4))


@dataclass(frozen=True)
class FakeRound:
    """A round of a search with a set of one effect; converged: whether its model is of that set."""

    chosen: tuple[int, ...]
    model: float
    converged: bool = False
    cut: bool = False


@pytest.mark.parametrize(("factor", "last"), [(0.9, TOLERANCES.search.rounds - 1), (0.99, 0)])
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
    monkeypatch.setattr(rounds, "_with_rival", lambda *_: None)
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
    system = SimpleNamespace(fitted=SimpleNamespace(rows=2000), autocorrelation_time=2.0)
    squares = floor**2 * 1000
    assert noise.leaves_only_noise(system, None, squares) is expected  # type: ignore[arg-type]
    assert not noise.leaves_only_noise(system, None, None)  # type: ignore[arg-type]


@pytest.mark.parametrize("possible", [True, False], ids=["only nearly so", "as it is"])
def test_no_effect_goes_because_of_what_is_only_nearly_so(
    possible: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[str] = []

    def where_possible(_: object, model: str, __: object, ___: object) -> tuple[Any, Any, dict[str, str]]:
        asked.append(model)
        out = {} if possible and model == "exact" else {"found": "of an impossible sign"}
        after = SimpleNamespace(model=model, error=SimpleNamespace(validate=0.1))
        return SimpleNamespace(effects=()), after, out

    def searched(_: object, first: str, barred: dict[str, str], __: object) -> Any:
        if barred:
            raise StopIteration(first, dict(barred))
        return SimpleNamespace(
            model="near", cut=False, system=SimpleNamespace(samples=Samples(np.ones(2), np.ones(2)))
        )

    monkeypatch.setattr(from_rounds, "searched", searched)
    monkeypatch.setattr(from_rounds, "where_possible", where_possible)
    monkeypatch.setattr(from_rounds, "leaving", lambda _, model, after, __, ___: (model, after, ()))
    sets = SimpleNamespace(new=(), names=(), fits=None, ladder=lambda *_, **__: ())
    monkeypatch.setattr(from_rounds, "fits_of", lambda *_: sets)
    monkeypatch.setattr(from_rounds, "superfluous_effect", lambda *_: {})
    base_model: Any = SimpleNamespace(
        start=SimpleNamespace(effects=()),
        floor=SimpleNamespace(excess=lambda _: 0.0),
        exactly=lambda _: "exact",
        in_search=None,
        with_instances=None,
    )
    base_model.at_leisure = base_model
    problem = SimpleNamespace(dataset=SimpleNamespace(recordings=()))
    case: Any = SimpleNamespace(start=SimpleNamespace(effects=()), before=None, problem=problem)
    if possible:
        after: Any = from_rounds.search_from(case, base_model, None).after  # type: ignore[arg-type]
        assert after.model == "exact"
    else:
        with pytest.raises(StopIteration) as ended:
            from_rounds.search_from(case, base_model, None)  # type: ignore[arg-type]
        assert ended.value.args[1] == {"found": "of an impossible sign"}
    assert asked == ["near", "exact"]
