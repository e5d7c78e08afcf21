"""Laws that were discovered, as effects and as files of them."""

from collections.abc import Iterable
from pathlib import Path

from bench.diagnosis.result import Discovered
from bench.effects import Effect
from bench.effects.user_file import effects_in


def law_effects(discovered: Iterable[Discovered]) -> dict[str, Effect]:
    """The effects of laws by name, from the text of their files."""
    sources = {law.law: law.source for law in discovered}
    return {law: effects_in(source, Path(f"{law}.py"))[law] for law, source in sources.items()}
