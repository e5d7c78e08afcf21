"""Laws that were discovered, as effects and as files of them."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

from bench.diagnosis.result import Discovered, LawTerm, LooksAt
from bench.effects import Effect
from bench.effects.user_file import effects_in
from bench.identification.result import Quantity


def law_effects(discovered: Iterable[Discovered]) -> dict[str, Effect]:
    """The effects of laws by name, from the text of their files."""
    sources = {law.law: law.source for law in discovered}
    return {law: effects_in(source, Path(f"{law}.py"))[law] for law, source in sources.items()}


def discovered_from(content: Mapping[str, Any]) -> Discovered:
    """A law at a motor from its plain form, as `dataclasses.asdict` gives it."""
    terms = tuple(
        LawTerm(**{**term, "looks_at": tuple(LooksAt(**look) for look in term["looks_at"])})
        for term in content["terms"]
    )
    numbers = {
        name: Quantity(
            number["value"], float("inf") if number["std"] is None else number["std"], number["unit"]
        )
        for name, number in content["numbers"].items()
    }
    nearest = (
        None if content["nearest"] is None else (str(content["nearest"][0]), float(content["nearest"][1]))
    )
    return Discovered(**{**content, "terms": terms, "numbers": numbers, "nearest": nearest})
