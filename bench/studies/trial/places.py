"""Whether an effect was named where it is."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence

from bench.effects import CATALOGUE
from bench.studies.sweep.journal import Row
from bench.studies.trial.name_list import names_in
from bench.studies.trial.target import Share


def placed(rows: Sequence[Row]) -> Share:
    """Of the effects at motors that were hidden and named, how many were named at the very motors that have them.

    rows: cases with effects of the catalogue. A motor too many or too few counts as wrong. Effects of joints without a
    motor, of bodies, payloads and the whole robot are not counted: what they are named at is where they show.
    """
    right = [named == hidden for row in rows for hidden, named in _at_motors(row)]
    return Share(sum(right), len(right))


def _at_motors(row: Row) -> Iterator[tuple[set[str], set[str]]]:
    """The motors that have a hidden effect, and those at which it was named."""
    named = {verdict["effect"]: set(verdict["actuators"]) for verdict in json.loads(row["verdicts"])}
    missing = names_in(row["missing"])
    for effect, joints in zip(names_in(row["hidden"]), names_in(row["joints"]), strict=True):
        if effect in missing and CATALOGUE[effect].place == "actuator":
            yield set(joints.split(",")), named[effect]
