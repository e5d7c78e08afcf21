"""Discovered laws, as effects and as their files."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

from bench.basics.files.atomic import write_text_atomically
from bench.diagnosis.result import Diagnosis, Discovered
from bench.effects import Effect
from bench.effects.user_file import effects_in


def write_laws(diagnosis: Diagnosis, folder: Path) -> Diagnosis:
    """Write the file of every law into a folder; the diagnosis with file names."""
    for law, source in {
        discovered_law.law: discovered_law.source for discovered_law in diagnosis.discovered
    }.items():
        write_text_atomically(folder / f"{law}.py", source)
    named = tuple(
        replace(discovered_law, file=f"{discovered_law.law}.py") for discovered_law in diagnosis.discovered
    )
    return replace(diagnosis, discovered=named)


def law_effects(discovered: Iterable[Discovered]) -> dict[str, Effect]:
    """The effects of laws by name, from the text of their files."""
    sources = {law.law: law.source for law in discovered}
    return {law: effects_in(source, Path(f"{law}.py"))[law] for law, source in sources.items()}
