"""Variants of a law: those that do well as they are known nearby are converged as they are, and only those."""

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis.discovery import refine
from bench.diagnosis.discovery.refine import NEARBY, THERE, Refined, refined
from bench.diagnosis.search import MATERIAL

LESS = 1.0 - MATERIAL  # times the error of the found model: where a variant is clearly better


def model(error: float, *, near: bool, values: str = "") -> Any:
    """With an error of its own where nothing was fitted; values: of what was found for it."""
    return SimpleNamespace(error=error, nearby=object() if near else None, effects=(), present=values)


def tried(monkeypatch: pytest.MonkeyPatch, near: float, there: float, exact: float) -> tuple[Refined, bool]:
    """What is best of a model with an error of 1, and one that has these: nearby, with the values found nearby as it
    is, and converged as it is; and whether it was converged as it is.
    """
    found: list[Any] = []
    start = model(0.0, near=False)
    nearby_too = model(1.01, near=True)  # as it is known nearby, it leaves a little more
    origin: Any = SimpleNamespace(start=start, again_nearby=lambda _: nearby_too)

    def exactly() -> Any:
        found.append(model(exact, near=False, values="converged"))
        return found[-1]

    variant = refine._Variant(Refined(model(1.01 * near, near=True), {}, 1.01 * near), exactly)
    monkeypatch.setattr(refine, "_tried", lambda *_: iter([variant]))
    monkeypatch.setattr(refine, "_slower", lambda *_: False)
    monkeypatch.setattr(refine, "error_of", lambda of: of.error)
    monkeypatch.setattr(refine, "with_effects", lambda *_: model(there, near=False))
    terms: Mapping[str, Any] = {}
    return refined(origin, model(1.0, near=False), terms, ()), bool(found)


@pytest.mark.parametrize(
    ("near", "there"), [(LESS * (1.0 + 2.0 * NEARBY), 0.5), (0.5, LESS * (1.0 + 2.0 * THERE))]
)
def test_a_variant_that_does_no_better_nearby_is_not_converged(
    near: float, there: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    best, converged = tried(monkeypatch, near, there, 0.5)
    assert not converged
    assert best.error == 1.0


@pytest.mark.parametrize(("exact", "taken"), [(0.99 * LESS, True), (1.01 * LESS, False)])
def test_one_that_is_nearly_better_is_judged_once_it_is_converged(
    exact: float, taken: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    best, converged = tried(monkeypatch, LESS * (1.0 + 0.5 * NEARBY), LESS * (1.0 + 0.5 * THERE), exact)
    assert converged
    assert (best.model.present == "converged") is taken
    assert best.error == (exact if taken else 1.0)
