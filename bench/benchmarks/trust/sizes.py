"""Two sizes of a single effect: one in the lower half of what a trial may hide, one in the upper half."""

from __future__ import annotations

from dataclasses import replace
from math import sqrt

from bench.benchmarks.trust.changelog_number import APART
from bench.studies.trial.cases import SHARES, SHARES_OF, Case, Kind, datasets_a_seed, draw_case
from bench.studies.trial.setup import Setup


def drawn_case(setup: Setup, kind: Kind, number: int) -> Case:
    """The case of that number. The size of a single effect moves into its half, on a logarithmic scale, where the case
    is fresh; cases of the frozen set are those of a trial.
    """
    case = draw_case(setup, kind, number)
    if kind != "one" or number < APART:
        return case
    (hide,) = case.hides
    ends = SHARES_OF.get(hide.effect, SHARES)
    share = sqrt(hide.share * ends[number // datasets_a_seed(setup, kind) % 2])
    return replace(case, hides=(replace(hide, share=float(f"{share:.4g}")),))
