"""How far each cell is, and which case is next: one of the cell that is farthest from the interval it is to reach."""

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

    def seconds_of_case(self) -> dict[int, float]:
        """What a case of each cell will cost: the mean of the cell, or of its robot, or of all."""
        by_robot: dict[str, list[CellTally]] = {}
        for cell in self.cells.all:
            by_robot.setdefault(cell.robot, []).append(self[cell])
        of_all = _mean(self._of.values(), UNKNOWN_SECONDS)
        of_robot = {robot: _mean(group, of_all) for robot, group in by_robot.items()}
        return {cell.index: _mean([self[cell]], of_robot[cell.robot]) for cell in self.cells.all}

    @property
    def pending_seconds(self) -> float:
        """What the cases that are handed out will cost."""
        cost = self.seconds_of_case()
        return sum(self[cell].pending * cost[cell.index] for cell in self.cells.all)

    @property
    def open_seconds(self) -> float:
        """What all cases will cost that are not handed out."""
        cost = self.seconds_of_case()
        return sum((len(cell.numbers) - len(self[cell].given)) * cost[cell.index] for cell in self.cells.all)

    def next_block(self) -> list[TrustCase]:
        """Cases of the robot with the cell that is least far, the next of its least far cells; empty: none remains."""
        cost = self.seconds_of_case()
        mean = sum(cost.values()) / len(cost)
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
            cell = min(
                open_cells,
                key=lambda cell: (self._progress(cell, cost[cell.index] / mean), cell.frozen, cell.index),
            )
            position = next(i for i in range(len(cell.numbers)) if i not in self[cell].given)
            block.append(TrustCase(cell, position))
            self.give(block[-1])
            robot = cell.robot
        return block

    def _progress(self, cell: TrustCell, cost: float) -> float:
        """From 0, no case, to 1: the interval is as narrow as with all planned cases as they should be.

        cost: of a case, over the mean. An interval may be wider by its fourth root, so that numbers of cases go by the
        inverse square root of their cost (Neyman's allocation).
        """
        return log(_width(self[cell].expected) / cost**0.25) / log(_width(cell.question.ideal))


def _mean(tallies: Iterable[CellTally], otherwise: float) -> float:
    """Mean cost of the cases that are finished in some cells; `otherwise` if none is."""
    seconds = finished = 0.0
    for tally in tallies:
        seconds, finished = seconds + tally.seconds, finished + tally.finished
    return seconds / finished if finished and seconds else otherwise


def _width(share: Share) -> float:
    low, high = share.interval
    return high - low
