"""Progress of all cells, and the choice of the next cases: from the cell farthest from its required interval."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from math import log

from bench.benchmarks.trust.cells import TrustCase, TrustCell, TrustCells
from bench.benchmarks.trust.work import SECONDS
from bench.studies.sweep.journal import Row
from bench.studies.trial.target import Share

UNKNOWN_SECONDS = 10.0  # of a case, before any is finished
BLOCK = 6
"""Cases of one robot that are handed out together, as they share the movements with nothing hidden."""


@dataclass
class CellTally:
    """Cases of a cell. given: positions handed out; finished: their number; of these counted: how many count, events:
    how many have the event, seconds: their total time.
    """

    given: set[int] = field(default_factory=set)
    finished: int = 0
    counted: int = 0
    events: int = 0
    seconds: float = 0.0

    @property
    def pending(self) -> int:
        """Number of cases handed out and not finished."""
        return len(self.given) - self.finished

    @property
    def expected(self) -> Share:
        """The share, if pending cases turn out like the finished ones."""
        if not self.counted:
            return Share(0, self.pending)
        of = self.counted + self.pending
        return Share(round(of * self.events / self.counted), of)


class Tally:
    """The progress of all cells."""

    def __init__(self, cells: TrustCells, rows: Iterable[Row] = ()) -> None:
        self.cells = cells
        self._of = {cell.index: CellTally() for cell in cells.all}
        for row in rows:
            self.give(cells.case_of_row(row["run"]))
            self.note(row)

    def __getitem__(self, cell: TrustCell) -> CellTally:
        return self._of[cell.index]

    def give(self, case: TrustCase) -> None:
        """Record that a case is handed out."""
        self[case.cell].given.add(case.position)

    def note(self, row: Row) -> None:
        """Record that a case is finished."""
        cell = self.cells.case_of_row(row["run"]).cell
        tally = self[cell]
        tally.finished += 1
        tally.seconds += row[SECONDS] + (row.get(f"{SECONDS}.again") or 0.0)
        if cell.question.counts(row):
            tally.counted += 1
            tally.events += cell.question.event(row)

    @property
    def finished(self) -> int:
        """Number of finished cases in all cells."""
        return sum(tally.finished for tally in self._of.values())

    @property
    def seconds(self) -> float:
        """Time of all finished cases, s."""
        return sum(tally.seconds for tally in self._of.values())

    def seconds_of_case(self) -> dict[int, float]:
        """Expected time, s, of a case of each cell, by index: the mean of the cell, else of its robot, else of all."""
        by_robot: dict[str, list[CellTally]] = {}
        for cell in self.cells.all:
            by_robot.setdefault(cell.robot, []).append(self[cell])
        of_all = _mean(self._of.values(), UNKNOWN_SECONDS)
        of_robot = {robot: _mean(group, of_all) for robot, group in by_robot.items()}
        return {cell.index: _mean([self[cell]], of_robot[cell.robot]) for cell in self.cells.all}

    @property
    def pending_seconds(self) -> float:
        """Expected time of the cases handed out and not finished, s."""
        cost = self.seconds_of_case()
        return sum(self[cell].pending * cost[cell.index] for cell in self.cells.all)

    @property
    def open_seconds(self) -> float:
        """Expected time of all cases not handed out, s."""
        cost = self.seconds_of_case()
        return sum((len(cell.numbers) - len(self[cell].given)) * cost[cell.index] for cell in self.cells.all)

    def next_block(self) -> list[TrustCase]:
        """Hand out up to `BLOCK` cases, each the next of the cell with the least progress, all of one robot.

        The robot is that of the cell with the least progress. Empty if no case remains.
        """
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
        """Progress from 0, no case, to 1: the interval is as narrow as with all planned cases right.

        cost: of a case, relative to the mean. An interval may be wider by the fourth root of the cost, so that numbers
        of cases are proportional to the inverse square root of the cost (Neyman's allocation).
        """
        return log(_width(self[cell].expected) / cost**0.25) / log(_width(cell.question.ideal))


def _mean(tallies: Iterable[CellTally], otherwise: float) -> float:
    """Mean time of the finished cases in some cells; `otherwise` if there are none."""
    seconds = finished = 0.0
    for tally in tallies:
        seconds, finished = seconds + tally.seconds, finished + tally.finished
    return seconds / finished if finished and seconds else otherwise


def _width(share: Share) -> float:
    low, high = share.interval
    return high - low
