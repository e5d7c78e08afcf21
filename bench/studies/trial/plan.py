"""The cases of a trial as runs, so that the machinery of the sweeps works them off."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

from bench.studies.sweep.plan import Run, digest
from bench.studies.trial.cases import Case, Kind, datasets_a_seed, draw_case
from bench.studies.trial.setup import Setup

MOVED = ("robot", "design", "recordings", "payloads")


@dataclass(frozen=True)
class TrialPlan:
    """All cases of one kind; with more seeds, those of fewer seeds stay as they are.

    effects: what is drawn from; empty: all that the robot can have. first: number of the first case; sets that begin
    far enough from each other have no case in common.
    """

    setup: Setup
    kind: Kind
    seeds: int
    effects: tuple[str, ...] = ()
    first: int = 0

    @property
    def numbers(self) -> range:
        """Of its cases."""
        return range(self.first, self.first + self.size)

    @property
    def size(self) -> int:
        """How many cases."""
        return self.seeds * datasets_a_seed(self.setup, self.kind, self.effects)

    def case(self, number: int) -> Case:
        """The case of that number, from 0."""
        return draw_case(self.setup, self.kind, number, self.effects)

    def run(self, number: int) -> Run:
        """The case as a run: all have their trajectories and the movement with nothing hidden in common."""
        return Run(
            number=number,
            seed=number,
            axes={},
            base=self.setup.name,
            content=self.setup.content,
            identify={},
            design_content=self.setup.content,
            design=self._design,
            motion=self._motion,
            equations=digest([self._motion, self.kind, number]),
        )

    def tasks(self, is_done: Callable[[int], bool] = lambda _: False) -> Iterator[tuple[Run, ...]]:
        """All cases that are not done, in order."""
        return ((self.run(i),) for i in self.numbers if not is_done(i))

    @cached_property
    def _design(self) -> str:
        return digest({key: self.setup.content.get(key) for key in MOVED})

    @cached_property
    def _motion(self) -> str:
        return digest(self.setup.content)
