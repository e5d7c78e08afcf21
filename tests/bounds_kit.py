"""Tolerances with a few other values, for tests."""

from dataclasses import replace
from typing import Any

from bench.identification.tolerances import Tolerances


def with_bounds(part: str, **values: Any) -> Tolerances:
    """All tolerances, with other values in one of their parts."""
    return replace(Tolerances(), **{part: replace(getattr(Tolerances(), part), **values)})
