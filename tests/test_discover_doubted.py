"""Names of the catalogue beside laws: which of them are sure."""

from types import SimpleNamespace
from typing import Any

import pytest

from bench.diagnosis.discovery.reported import _without, doubted
from bench.diagnosis.reason import Because, Doubt, Reason
from bench.diagnosis.reason_words import reason_sentence
from bench.diagnosis.result import EffectVerdict, Remainder, Unexplained


def _fitted(error: float) -> Any:
    return SimpleNamespace(error=SimpleNamespace(identify=error, validate=error))


@pytest.mark.parametrize(
    ("places", "without", "floor", "verdict"),
    [
        (("left",), 0.0015, 0.001, "resembles"),  # a twentieth of what the law explains
        (("left",), 0.0200, 0.001, "missing"),
        (("left",), 0.0200, 0.0006, "resembles"),  # more is left than noise: the law is another
        (("right",), 0.0015, 0.0006, "missing"),  # where no law is, none can be inexact
        (("left", "right"), 0.0015, 0.001, "missing"),
    ],
)
def test_what_may_make_up_for_an_inexact_law_is_not_sure(
    places: tuple[str, ...], without: float, floor: float, verdict: str
) -> None:
    errors = {frozenset({"ripple"}): 0.030, frozenset({"law"}): without}
    finding: Any = SimpleNamespace(
        names=("law", "ripple"),
        after=_fitted(0.001),
        fits=lambda names: SimpleNamespace(step=_fitted(errors[names]).error),
    )
    law: Any = SimpleNamespace(name="law", places=(SimpleNamespace(name="left"),))
    named = EffectVerdict("ripple", "missing", without, 0.001, 50.0, places, (), {}, Reason(Because.EXPLAINS))
    other = EffectVerdict(
        "lag", "not supported", 0.001, 0.001, 0.0, (), (), {}, Reason(Because.GAINS_NOTHING)
    )
    left = Unexplained(Remainder.PATTERN, 0.001, floor, ())
    told = doubted(finding, (law,), (named, other), left)
    assert [one.verdict for one in told] == [verdict, "not supported"]
    assert told[1] is other
    assert (Doubt.BESIDE_A_LAW in told[0].why.doubts) == (verdict == "resembles")


@pytest.mark.parametrize(
    ("because", "alternatives", "verdict", "said"),
    [
        (Because.AS_GOOD, ("law", "lag"), "indistinguishable", Reason(Because.AS_GOOD)),
        (Because.AS_GOOD, ("law",), "resembles", Reason(Because.AS_GOOD_AS_A_LAW, ("left",))),
        (Because.EXPLAINS, ("dropped",), "missing", Reason(Because.EXPLAINS)),
    ],
)
def test_indistinguishable_is_what_has_an_alternative_of_the_catalogue(
    because: Because, alternatives: tuple[str, ...], verdict: str, said: Reason
) -> None:
    before = EffectVerdict("drag", "indistinguishable", 0.1, 0.1, 0.0, (), alternatives, {}, Reason(because))
    told = _without(before, {"law": ("left",), "dropped": ()})
    assert (told.verdict, told.why) == (verdict, said)
    assert told.alternatives == tuple(name for name in alternatives if name == "lag")
    assert reason_sentence(told)
