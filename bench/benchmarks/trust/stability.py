"""How many certain verdicts remain when the same machine is diagnosed again."""

import json
from collections.abc import Mapping, Sequence

from bench.studies.sweep.journal import Row, names_in
from bench.studies.trial.target import Share, Target, TargetFigure

SURE, NOISE, WITHOUT_LOG = "sure", "sure.noise", "sure.without_log"
"""Columns of the effects with a certain verdict: in the first diagnosis, with more noise, without the last log."""

CERTAIN = "missing"
"""The verdict that counts as certain."""

LEAST = {NOISE: 0.95, WITHOUT_LOG: 0.90}
FIGURES = {NOISE: TargetFigure.STABLE_NOISE, WITHOUT_LOG: TargetFigure.STABLE_LOG}


def stability(rows: Sequence[Row], change: str) -> Target:
    """Of the verdicts that are certain before or after a change, the share that is certain both times."""
    stay = of = 0
    for row in rows:
        if row.get(change) is None:
            continue
        before, after = set(names_in(row[SURE])), set(names_in(row[change]))
        stay += len(before & after)
        of += len(before | after)
    share = Share(stay, of)
    return Target(FIGURES[change], share.value, LEAST[change], None, share)


def changed(row: Row, change: str) -> bool:
    """Whether a certain verdict of this case appears or disappears with the change."""
    return row.get(change) is not None and set(names_in(row[SURE])) != set(names_in(row[change]))


def verdicts_of(row: Row) -> Mapping[str, str]:
    """The verdicts on the effects that a row names, by effect."""
    verdicts = {verdict["effect"]: verdict["verdict"] for verdict in json.loads(row["verdicts"])}
    return {name: verdicts.get(name, "") for name in names_in(row["missing"])}


def certain_in(verdicts: Mapping[str, str]) -> list[str]:
    """The effects with a certain verdict, sorted. verdicts: by effect."""
    return sorted(name for name, verdict in verdicts.items() if verdict == CERTAIN)
