"""Laws that were discovered, as files of user-defined effects."""

from dataclasses import replace
from pathlib import Path

from bench.basics.files.atomic import write_text_atomically
from bench.diagnosis.result import Diagnosis


def write_laws(diagnosis: Diagnosis, folder: Path) -> Diagnosis:
    """Write the file of every law into a folder; the diagnosis with their names."""
    for law, source in {found_law.law: found_law.source for found_law in diagnosis.discovered}.items():
        write_text_atomically(folder / f"{law}.py", source)
    named = tuple(replace(found_law, file=f"{found_law.law}.py") for found_law in diagnosis.discovered)
    return replace(diagnosis, discovered=named)
