"""One law for several frictions is tried where nothing is left, and where something is, beside the laws found there."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis.discovery import find, with_laws
from bench.diagnosis.reason import Because, Reason
from bench.effects import CATALOGUE, EffectInstance

ONE = SimpleNamespace(laws=("law",), diagnosis="one law", finding=None)


@pytest.mark.parametrize(
    ("left", "laws", "discover", "told"),
    [
        (True, None, None, "one law"),
        (False, None, None, "one law"),
        (True, ("model", "terms"), None, "one law"),
        (True, None, True, "one law"),
        (True, None, False, "frictions"),
    ],
    ids=["no law does better", "nothing is left", "a law does better", "asked for", "not asked for"],
)
def test_one_law_is_tried_for_several_frictions(
    left: bool,
    laws: tuple[str, str] | None,
    discover: bool | None,
    told: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    gain = SimpleNamespace(value=1.0, nominal=1.0)
    plain: Any = SimpleNamespace(after=SimpleNamespace(drive_gains={"motor": gain}), unexplained=None)
    finding: Any = SimpleNamespace(base_model=None, last=None, unfinished=(), barred={})
    monkeypatch.setattr(find, "search_catalogue", lambda *_: finding)
    monkeypatch.setattr(find, "answered", lambda *_: plain)
    monkeypatch.setattr(with_laws, "something_remains", lambda _: left)
    monkeypatch.setattr(with_laws, "search_laws", lambda *_: laws)
    monkeypatch.setattr(
        with_laws, "_with_laws", lambda *_: SimpleNamespace(laws=("term",), diagnosis="laws", finding=None)
    )
    monkeypatch.setattr(with_laws, "_with_one_for_several", lambda *_: ONE)
    monkeypatch.setattr(with_laws, "_with_tables", lambda _, answer, __: answer)
    monkeypatch.setattr(find, "_no_worse_than_usual", lambda _, __, best, ___: best)
    monkeypatch.setattr(find, "completed", lambda _, diagnosis: diagnosis)
    case: Any = None
    found = find._diagnosis(case, discover, True, find.SILENT)
    assert ("frictions" if found is plain else found) == told


def test_an_effect_that_was_not_needed_may_be_found_beside_a_law(monkeypatch: pytest.MonkeyPatch) -> None:
    """A spring that others did as well where most was missing came as the cube of the position."""
    barred = {
        "joint_spring": Reason(Because.NOT_NEEDED),
        "stribeck_friction": Reason(Because.IMPOSSIBLE, ("Fs",)),
    }
    finding: Any = SimpleNamespace(base_model=None, last=None, unfinished=(), barred=barred)
    plain: Any = SimpleNamespace(after=SimpleNamespace(drive_gains={}), unexplained=None)
    asked: list[Any] = []
    monkeypatch.setattr(find, "search_catalogue", lambda *_: finding)
    monkeypatch.setattr(find, "answered", lambda *_: plain)
    monkeypatch.setattr(with_laws, "something_remains", lambda _: True)
    monkeypatch.setattr(with_laws, "search_laws", lambda _, __, never, ___: asked.append(never))
    monkeypatch.setattr(with_laws, "_with_one_for_several", lambda *_: ONE)
    monkeypatch.setattr(with_laws, "_with_tables", lambda _, answer, __: answer)
    monkeypatch.setattr(find, "_no_worse_than_usual", lambda _, __, best, ___: best)
    monkeypatch.setattr(find, "completed", lambda _, diagnosis: diagnosis)
    case: Any = None
    find._diagnosis(case, None, True, find.SILENT)
    assert [list(never) for never in asked] == [["stribeck_friction"]]


@pytest.mark.parametrize(
    ("why", "beside", "barred"),
    [
        (Reason(Because.IMPOSSIBLE, ("Fc", "left")), "stribeck_friction", False),
        (Reason(Because.IMPOSSIBLE, ("Fc", "left")), "viscous_friction", True),
        (Reason(Because.IMPOSSIBLE, ("Fc",)), "stribeck_friction", True),
        (Reason(Because.NOT_NEEDED), "viscous_friction", False),
    ],
    ids=["a special case, at a motor", "no special case", "at all motors", "not needed"],
)
def test_a_special_case_that_drove_at_one_motor_may_be_found_beside_a_law(
    why: Reason, beside: str, barred: bool
) -> None:
    """Friction by a power of the load beside Coulomb friction at another motor was called Stribeck friction."""
    finding: Any = SimpleNamespace(barred={"coulomb_friction": why})
    named = [EffectInstance(CATALOGUE[beside], "left", beside)]
    assert ("coulomb_friction" in with_laws._never_with_laws(finding, named)) is barred
