"""How far an evaluation is: cases, cost, time remaining."""

from __future__ import annotations

import time

from rich.console import Console

from bench.basics.plural import plural
from bench.benchmarks.trust.budget import Budget
from bench.benchmarks.trust.tally import Tally
from bench.studies.sweep.journal import Journal
from bench.studies.sweep.progress import SAY_EVERY, duration_text


class TrustProgress:
    """A line every half minute."""

    def __init__(self, console: Console, tally: Tally, budget: Budget) -> None:
        self._console, self._tally, self._budget = console, tally, budget
        self._said = time.monotonic()

    def __call__(self, journal: Journal) -> None:
        """Say how far it is, if the last line is old enough."""
        now = time.monotonic()
        if now - self._said < SAY_EVERY:
            return
        self._said = now
        cases = plural(self._tally.finished, "case")
        failed = f", {len(journal.failed)} failed" if journal.failed else ""
        remaining = duration_text(seconds_remaining(self._tally, self._budget))
        self._console.print(f"{cases}{failed}, {remaining} remaining", highlight=False)


def seconds_remaining(tally: Tally, budget: Budget) -> float:
    """Until the budget is spent, or all cases are finished."""
    work = (tally.open_seconds + tally.pending_seconds) / budget.slots()
    return max(min(budget.seconds, work), 0.0)
