"""Drive gains of an evaluation against the truth, in standard errors."""

from __future__ import annotations

import json
from collections.abc import Sequence

import numpy as np

from bench.basics.chi_squared import WITHIN_95
from bench.studies.sweep.journal import OK, Row
from bench.studies.trial.target import Share, Target, TargetFigure

MODELLED = ("nothing", "one", "two", "three")
"""Questions whose hidden effects the catalogue has."""

COVERAGE = (0.90, 0.98)


def deviations(rows: Sequence[Row]) -> list[np.ndarray]:
    """For each case |estimate - truth| of its gains over their standard deviations."""
    return [
        np.array([abs(gain["value"] - gain["truth"]) / gain["std"] for gain in json.loads(row["gains"])])
        for row in rows
        if row["status"] == OK
    ]


def coverage(rows: Sequence[Row]) -> Target:
    """Share of the 95 % intervals that contain the truth. A case counts once: errors of its gains go together."""
    within = [float(np.mean(of <= WITHIN_95)) for of in deviations(rows)]
    value = float(np.mean(within)) if within else float("nan")
    share = Share(round(sum(within)), len(within))
    return Target(TargetFigure.GAINS_HELD, value, *COVERAGE, share)
