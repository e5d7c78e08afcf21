"""How many certain verdicts stay when the same machine is diagnosed again."""

from __future__ import annotations

from collections.abc import Sequence

from bench.studies.sweep.journal import Row
from bench.studies.trial.name_list import names_in
from bench.studies.trial.target import Share, Target, TargetFigure

NOISE, WITHOUT_LOG = "sure.noise", "sure.without_log"
LEAST = {NOISE: 0.95, WITHOUT_LOG: 0.90}
FIGURES = {NOISE: TargetFigure.STABLE_NOISE, WITHOUT_LOG: TargetFigure.STABLE_LOG}


def stability(rows: Sequence[Row], change: str) -> Target:
    """Of the verdicts that are certain before or after a change, those that are certain before and after."""
    stay = of = 0
    for row in diagnosed_again(rows, change):
        before, after = set(names_in(row["sure"])), set(names_in(row[change]))
        stay += len(before & after)
        of += len(before | after)
    share = Share(stay, of)
    return Target(FIGURES[change], share.value, LEAST[change], None, share)


def diagnosed_again(rows: Sequence[Row], change: str) -> list[Row]:
    """Cases that were diagnosed again under this change."""
    return [row for row in rows if row.get(change) is not None]


def changed(row: Row, change: str) -> bool:
    """Whether a certain verdict of this case goes or comes."""
    return row.get(change) is not None and set(names_in(row["sure"])) != set(names_in(row[change]))
