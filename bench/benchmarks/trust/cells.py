"""Cells of the evaluation, one for each robot and question, with their cases in order, numbered by the changelog."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from zlib import crc32

import numpy as np

from bench.basics.errors import BenchError
from bench.benchmarks.trust.questions import FROZEN_SHARE, MANY_WITH_NOTHING, QUESTIONS, TrustQuestion
from bench.studies.trial.cases import datasets_a_seed
from bench.studies.trial.setup import Setup

STRIDE = 1000
"""Row numbers reserved for each cell."""

AGAIN_EVERY = 5
"""One in so many cases of a cell is diagnosed again, with more noise and without a log."""

AGAIN = frozenset({"one", "two", "three", "unknown"})
SIZES = 2
"""Cases of each single effect: a small and a large one, see `drawn_case`."""


@dataclass(frozen=True)
class TrustCell:
    """index: among all cells. frozen: whether its cases are the same for every version. numbers: of its cases."""

    index: int
    robot: str
    question: TrustQuestion
    frozen: bool
    numbers: tuple[int, ...]


@dataclass(frozen=True)
class TrustCase:
    """A case at a position in a cell."""

    cell: TrustCell
    position: int

    @property
    def number(self) -> int:
        """Its number among the trial's cases of that robot and kind."""
        return self.cell.numbers[self.position]

    @property
    def row(self) -> int:
        """Its row number."""
        return STRIDE * self.cell.index + self.position

    @property
    def again(self) -> bool:
        """Whether it is diagnosed again, with more noise and without a log."""
        kind = self.cell.question.kind
        return kind in AGAIN and not self.cell.frozen and self.position % AGAIN_EVERY == 0

    @property
    def name(self) -> str:
        """The argument that runs it again, ROBOT/QUESTION/NUMBER."""
        return f"{self.cell.robot}/{self.cell.question.kind}/{self.number}"


@dataclass(frozen=True)
class TrustCells:
    """All cells, in order. setups: by robot; first: number of the first fresh case of every cell."""

    setups: Mapping[str, Setup]
    first: int

    @cached_property
    def all(self) -> tuple[TrustCell, ...]:
        """All cells, by robot, question, and whether their cases are fresh or frozen."""
        cells: list[TrustCell] = []
        for robot, setup in self.setups.items():
            for question in QUESTIONS.values():
                for frozen in (False, True):
                    numbers = _numbers(robot, setup, question, 0 if frozen else self.first)
                    kept = numbers[: max(len(numbers) // FROZEN_SHARE, 1)] if frozen else numbers
                    asked = replace(question, planned=len(kept))
                    cells.append(TrustCell(len(cells), robot, asked, frozen, kept if numbers else ()))
        return tuple(cells)

    def case_of_row(self, row: int) -> TrustCase:
        """The case of a row."""
        index, position = divmod(row, STRIDE)
        return TrustCase(self.all[index], position)

    @property
    def size(self) -> int:
        """One more than the largest row number."""
        return STRIDE * len(self.all)


def _numbers(robot: str, setup: Setup, question: TrustQuestion, first: int) -> tuple[int, ...]:
    """Numbers of a cell's cases; single effects are in random order, each once before any is repeated."""
    if question.kind != "one":
        if not datasets_a_seed(setup, question.kind):
            return ()
        twice = question.kind == "nothing" and robot in MANY_WITH_NOTHING
        return tuple(range(first, first + question.planned * (1 + twice)))
    effects = datasets_a_seed(setup, "one")
    order: Sequence[int] = np.random.default_rng(crc32(robot.encode())).permutation(effects).tolist()
    return tuple(first + size * effects + at for size in range(SIZES) for at in order)


CHANGELOG = Path(__file__).resolve().parents[3] / "CHANGELOG.md"
APART = 1000
"""Case numbers reserved for each entry of the changelog, more than a cell has cases."""

HEADING = re.compile(r"^## (.+)$", re.MULTILINE)
ENTRY = re.compile(r"^- ", re.MULTILINE)


@dataclass(frozen=True)
class ChangelogNumber:
    """version: the newest heading. entries: their number in the whole changelog."""

    version: str
    entries: int

    @property
    def first(self) -> int:
        """Number of the first case of every cell."""
        return APART * self.entries


def changelog_number(path: Path = CHANGELOG) -> ChangelogNumber:
    """Read the changelog. Raises BenchError if there is none, or no version in it."""
    try:
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError as error:
        raise BenchError(f"{path}: no changelog: run this in a checkout of the project") from error
    heading = HEADING.search(text)
    if heading is None:
        raise BenchError(f"{path}: no line `## VERSION`")
    return ChangelogNumber(heading[1], len(ENTRY.findall(text)))
