"""Laws that were discovered, as files of user-defined effects."""

from dataclasses import replace
from pathlib import Path

from bench.basics.files.atomic import write_text_atomically
from bench.diagnosis.result import Diagnosis


def write_laws(diagnosis: Diagnosis, folder: Path) -> Diagnosis:
    """Write the file of every law into a folder; the diagnosis with their names."""
    for law, source in {
        discovered_law.law: discovered_law.source for discovered_law in diagnosis.discovered
    }.items():
        write_text_atomically(folder / f"{law}.py", source)
    named = tuple(
        replace(discovered_law, file=f"{discovered_law.law}.py") for discovered_law in diagnosis.discovered
    )
    return replace(diagnosis, discovered=named)
