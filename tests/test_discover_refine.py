"""Variants of a law: those that do well as they are known nearby are converged as they are, and only those."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from bench.basics.deadline import NEVER
from bench.diagnosis import rounds
from bench.diagnosis.discovery import refine
from bench.diagnosis.discovery.refine import Refined, refined
from bench.diagnosis.round import Round
from bench.diagnosis.search import Selection
from bench.identification.decision import RULE
from bench.identification.tolerances import TOLERANCES

NEARBY = TOLERANCES.laws.nearby * RULE.prior  # nats


def model(weight: float, *, near: bool, values: str = "") -> Any:
    """With a weight in nats; values: of what was found for it."""
    return SimpleNamespace(weight=weight, nearby=object() if near else None, effects=(), present=values)


class Judge:
    """Who weighs a model by what it says."""

    def refined(self, of: Any, terms: Mapping[str, Any]) -> Refined:
        """The model with its weight."""
        return Refined(of, terms, of.weight)


JUDGE: Any = Judge()


def tried(monkeypatch: pytest.MonkeyPatch, near: float, there: float, exact: float) -> tuple[Refined, bool]:
    """What is best of a model of weight 0, and one that has these: nearby, with the values found nearby as it is, and
    converged as it is; and whether it was converged as it is.
    """
    found: list[Any] = []
    start = model(0.0, near=False)
    nearby_too = model(-1.0, near=True)  # as it is known nearby, it leaves a little more
    base_model: Any = SimpleNamespace(start=start, again_nearby=lambda _: nearby_too)

    def exactly() -> Any:
        found.append(model(exact, near=False, values="converged"))
        return found[-1]

    variant = refine._Variant(JUDGE.refined(model(near - 1.0, near=True), {}), exactly)
    monkeypatch.setattr(refine, "_tried", lambda *_: iter([variant]))
    monkeypatch.setattr(refine, "_slower", lambda *_: False)
    monkeypatch.setattr(refine, "with_effects", lambda *_: model(there, near=False))
    return refined(base_model, model(0.0, near=False), {}, (), JUDGE), bool(found)


@pytest.mark.parametrize(("near", "there"), [(-2.0 * NEARBY, 50.0), (50.0, -2.0 * NEARBY)])
def test_a_variant_that_does_no_better_nearby_is_not_converged(
    near: float, there: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    best, converged = tried(monkeypatch, near, there, 50.0)
    assert not converged
    assert best.weight == 0.0


@pytest.mark.parametrize(("exact", "taken"), [(1.0, True), (-1.0, False)])
def test_one_that_is_nearly_better_is_judged_once_it_is_converged(
    exact: float, taken: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    best, converged = tried(monkeypatch, -0.5 * NEARBY, -0.5 * NEARBY, exact)
    assert converged
    assert (best.model.present == "converged") is taken
    assert best.weight == (exact if taken else 0.0)


def test_an_effect_that_is_not_needed_goes_before_a_number_is_set_free(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A law beside a length that it makes superfluous came out with an exponent that nothing asked for."""
    law, length = (SimpleNamespace(name=name) for name in ("law", "length"))
    whole = SimpleNamespace(weight=0.0, nearby=None, effects=(law, length), present="")
    fewer = SimpleNamespace(weight=9.0, nearby=None, effects=(law,), present="")
    base_model: Any = SimpleNamespace(
        start=SimpleNamespace(effects=()), again_nearby=lambda of: of, exactly=lambda of: of
    )
    asked: list[set[str]] = []

    def without(_: Any, __: Any, kept: set[str], *___: Any) -> Any:
        asked.append(kept)
        return fewer

    monkeypatch.setattr(refine, "_without", without)
    monkeypatch.setattr(refine, "_tried", lambda *_: iter(()))
    monkeypatch.setattr(refine, "_slower", lambda *_: False)
    term: Any = "term"
    best = refined(base_model, whole, {"law": term}, (), JUDGE)  # type: ignore[arg-type]
    assert best.model is fewer  # type: ignore[comparison-overlap]
    assert asked == [{"law"}], "the law itself is not what goes"
    assert best.terms == {"law": term}


def test_the_set_of_a_converged_model_is_one_that_a_search_begins_with(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of laws at one motor each none shows alone, and a search that grew from single effects missed them."""
    proposals: Any = [SimpleNamespace(name=name) for name in ("a", "b", "c")]
    model: Any = SimpleNamespace(effects=[SimpleNamespace(name=n) for n in "bc"])
    base_model: Any = SimpleNamespace(start=SimpleNamespace(effects=()), deadline=NEVER)
    found = Selection(SimpleNamespace(total=10.0, fit=SimpleNamespace(chosen=(0,))), {})  # type: ignore[arg-type]
    monkeypatch.setattr(rounds, "round_about", lambda *_: Round(model, proposals, None, found))  # type: ignore[arg-type]
    monkeypatch.setattr(rounds, "usable", lambda *_: [0, 1, 2])
    for total, chosen in ((20.0, (1, 2)), (5.0, (0,))):
        best = SimpleNamespace(total=total, fit=SimpleNamespace(chosen=(1, 2)))
        begun: list[Any] = []
        monkeypatch.setattr(rounds, "best_set", lambda _, begin, *__, b=best, s=begun: s.extend(begin) or b)
        here = rounds.round_from(base_model, model, proposals, ())
        assert here.chosen == chosen
        assert [1, 2] in begun
