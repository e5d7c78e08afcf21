"""The number of the first case: from the changelog, so that a new version is judged on cases that nobody has seen."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError

CHANGELOG = Path(__file__).resolve().parents[3] / "CHANGELOG.md"
APART = 1000
"""Case numbers for each entry of the changelog: more than a cell has cases."""

HEADING = re.compile(r"^## (.+)$", re.MULTILINE)
ENTRY = re.compile(r"^- ", re.MULTILINE)


@dataclass(frozen=True)
class ChangelogNumber:
    """version: the newest heading. entries: of the whole changelog."""

    version: str
    entries: int

    @property
    def first(self) -> int:
        """Number of the first case of every cell."""
        return APART * self.entries


def changelog_number(path: Path = CHANGELOG) -> ChangelogNumber:
    """Read it. Raises BenchError where there is no changelog, or no version in it."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise BenchError(f"{path}: no changelog: run this in a checkout of the project") from error
    heading = HEADING.search(text)
    if heading is None:
        raise BenchError(f"{path}: no line `## VERSION`")
    return ChangelogNumber(heading[1], len(ENTRY.findall(text)))
