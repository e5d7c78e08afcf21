"""An identification problem as a value: recordings, starting model, known effects, filters and gains."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.dataset.dataset import Dataset
from bench.effects import Effect, catalogue_for, places_in
from bench.effects.places import Places
from bench.model.geometry import read_geometry
from bench.signals.settings import FilterSettings

Filters = FilterSettings | Mapping[str, Any] | None
"""All settings, some by name, or none; the rest is chosen from the spectra."""


@dataclass(frozen=True, eq=False)
class Problem:
    """A dataset and what to identify from it. `problem_of` makes it, `bench.identification.prepare` its equations.

    effects: of the model, as EFFECT[:PLACE][@recording]. catalogue: every effect that is known, by name. fit_gains:
    whether drive gains are unknowns; None: those that the declared payloads fix.
    """

    dataset: Dataset
    catalogue: Mapping[str, Effect]
    effects: tuple[str, ...] = ()
    filters: Filters = None
    fit_gains: bool | None = None


def problem_of(
    dataset: Dataset,
    effects: Sequence[str] = (),
    filters: Filters = None,
    *,
    effect_files: Iterable[str | Path] = (),
    fit_gains: bool | None = None,
) -> Problem:
    """With the built-in effects, the dataset's, and those of further Python files.

    Raises BenchError that names a file and its fault, or two effects of the same name.
    """
    catalogue = catalogue_for(dataset.effect_files, map(Path, effect_files))
    return Problem(dataset, catalogue, tuple(effects), filters, fit_gains)


def places_of(problem: Problem) -> Places:
    """Possible places of effects in a problem's robot and payloads."""
    return places_in(read_geometry(problem.dataset.robot), problem.dataset.weighed)
