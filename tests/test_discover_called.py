"""Laws that have a name where they were found."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis.discovery import reported
from bench.diagnosis.search import Scored

NAMES = ("viscous", "law_left", "law_right", "offset", "spring")


@pytest.mark.parametrize(
    ("with_offset", "barred", "found"),
    [(110.0, (), {"law_left": 3}), (90.0, (), {}), (110.0, ("offset",), {})],
)
def test_what_an_effect_does_as_well_is_called_by_its_name(
    with_offset: float, barred: tuple[str, ...], found: dict[str, int], monkeypatch: pytest.MonkeyPatch
) -> None:
    totals = {frozenset({0, 2, 3}): with_offset, frozenset({0, 2, 4}): 105.0}

    def score_set(_: Any, chosen: Any) -> Scored:
        total = totals.get(frozenset(chosen), 0.0)
        return Scored(SimpleNamespace(chosen=chosen), total, total)  # type: ignore[arg-type]

    monkeypatch.setattr(reported, "score_set", score_set)
    monkeypatch.setattr(reported, "possible", lambda _, fit: 4 not in fit.chosen)
    best = SimpleNamespace(fit=SimpleNamespace(chosen=(0, 1, 2)), total=100.0)
    here: Any = SimpleNamespace(
        system=None,
        proposals=[SimpleNamespace(name=name) for name in NAMES],
        selection=SimpleNamespace(selected=best, singles=dict.fromkeys(range(5))),
    )
    assert reported.stood_for(here, ("law_left", "law_right"), barred) == found
