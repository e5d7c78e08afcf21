"""How far each cell is, and which case is next: one of the cell that is farthest from the interval it is to reach."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import log

from bench.benchmarks.trust.cells import TrustCase, TrustCell, TrustCells
from bench.benchmarks.trust.work import SECONDS
from bench.studies.sweep.journal import Row
from bench.studies.trial.target import Share

UNKNOWN_SECONDS = 10.0  # of a case before any is finished
BLOCK = 6
"""Cases of one robot that are handed out together: they share the movements with nothing hidden."""


@dataclass
class CellTally:
    """Cases of a cell: handed out, finished; of these how many count, how many have the event, and what they cost."""

    given: set[int] = field(default_factory=set)
    finished: int = 0
    counted: int = 0
    events: int = 0
    seconds: float = 0.0

    @property
    def pending(self) -> int:
        """Handed out and not finished."""
        return len(self.given) - self.finished

    @property
    def expected(self) -> Share:
        """The share, as if pending cases came out like those that are finished."""
        if not self.counted:
            return Share(0, self.pending)
        of = self.counted + self.pending
        return Share(round(of * self.events / self.counted), of)


class Tally:
    """All cells with what is finished of them."""

    def __init__(self, cells: TrustCells, rows: Iterable[Row] = ()) -> None:
        self.cells = cells
        self._of = {cell.index: CellTally() for cell in cells.all}
        for row in rows:
            self.give(cells.case_of_row(row["run"]))
            self.note(row)

    def __getitem__(self, cell: TrustCell) -> CellTally:
        return self._of[cell.index]

    def give(self, case: TrustCase) -> None:
        """A case is handed out."""
        self[case.cell].given.add(case.position)

    def note(self, row: Row) -> None:
        """A case is finished."""
        cell = self.cells.case_of_row(row["run"]).cell
        tally = self[cell]
        tally.finished += 1
        tally.seconds += row[SECONDS] + (row.get(f"{SECONDS}.again") or 0.0)
        if cell.question.counts(row):
            tally.counted += 1
            tally.events += cell.question.event(row)

    @property
    def finished(self) -> int:
        """Of all cells."""
        return sum(tally.finished for tally in self._of.values())

    @property
    def seconds(self) -> float:
        """What all finished cases cost."""
        return sum(tally.seconds for tally in self._of.values())

    def seconds_of_case(self, cell: TrustCell) -> float:
        """What a case of a cell will cost: the mean of the cell, or of its robot, or of all."""
        robots = [self[other] for other in self.cells.all if other.robot == cell.robot]
        for group in ([self[cell]], robots, list(self._of.values())):
            finished = sum(tally.finished for tally in group)
            if finished:
                return sum(tally.seconds for tally in group) / finished
        return UNKNOWN_SECONDS

    @property
    def pending_seconds(self) -> float:
        """What the cases that are handed out will cost."""
        return sum(
            self[cell].pending * self.seconds_of_case(cell) for cell in self.cells.all if self[cell].pending
        )

    @property
    def open_seconds(self) -> float:
        """What all cases will cost that are not handed out."""
        return sum(
            (len(cell.numbers) - len(self[cell].given)) * self.seconds_of_case(cell)
            for cell in self.cells.all
        )

    def next_block(self) -> list[TrustCase]:
        """Cases of the robot with the cell that is least far, the next of its least far cells; empty: none remains."""
        robot: str | None = None
        block: list[TrustCase] = []
        while len(block) < BLOCK:
            open_cells = [
                cell
                for cell in self.cells.all
                if len(self[cell].given) < len(cell.numbers) and robot in (None, cell.robot)
            ]
            if not open_cells:
                break
            cell = min(open_cells, key=lambda cell: (self._progress(cell), cell.frozen, cell.index))
            position = next(i for i in range(len(cell.numbers)) if i not in self[cell].given)
            block.append(TrustCase(cell, position))
            self.give(block[-1])
            robot = cell.robot
        return block

    def _progress(self, cell: TrustCell) -> float:
        """From 0, no case, to 1: the interval is as narrow as with all planned cases as they should be."""
        return log(_width(self[cell].expected)) / log(_width(cell.question.ideal))


def _width(share: Share) -> float:
    low, high = share.interval
    return high - low
