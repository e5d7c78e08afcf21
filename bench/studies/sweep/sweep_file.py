"""A sweep file: a base scenario, its axes, settings of the identification, and recorded metrics."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from pydantic import StrictBool, field_validator

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import UserTable, read_toml
from bench.dataset.catalogue import catalogue_folder
from bench.identification.estimators import DEFAULT_METHOD
from bench.studies.sweep.axes import Axis, GridAxis, read_axes

LARGEST = 1_000_000  # runs: more indicates a mistake in an axis


class IdentifyTable(UserTable):
    """[identify]: settings of the identification of every run, unless an axis changes them."""

    method: str = DEFAULT_METHOD
    effects: tuple[str, ...] = ()
    deviations: Literal["autocorrelated", "independent"] = "autocorrelated"
    essential: StrictBool = False
    fit_gains: StrictBool | None = None
    diagnose: StrictBool = False
    """Whether to diagnose missing effects as well."""


IDENTIFY = frozenset(IdentifyTable.model_fields)
"""Axes and settings of these names concern the identification, all others the scenario."""


class PlotTable(UserTable):
    """[[plots]]: a figure of median and spread over the seeds."""

    x: str
    y: str
    lines: str | None = None


class SweepTable(UserTable):
    """The keys of a sweep file."""

    description: str = ""
    base: str
    """The base scenario of all runs: a built-in name, or a path relative to this file."""
    seeds: int | tuple[int, ...] = 1
    """The number of seeds (1, 2, 3, …), or a list of them."""
    design: Literal["once", "each"] = "once"
    """Exciting trajectories: designed once for the base, or for each value of payloads and limits."""
    record: tuple[Literal["accuracy", "gains", "parameters", "effects"], ...] = ("accuracy",)
    show: tuple[str, ...] = ("gain_error", "gain_within", "validate_error_over_noise_floor")
    """Metrics of the summary."""
    plots: tuple[PlotTable, ...] = ()
    scenario: Mapping[str, Any] = {}
    """Settings that all runs change in the base, by table or dotted path."""
    identify: IdentifyTable = IdentifyTable()
    axes: Mapping[str, Any] = {}

    @field_validator("seeds", mode="before")
    @classmethod
    def _countable(cls, seeds: Any) -> Any:
        listed = list(seeds) if isinstance(seeds, list | tuple) else [seeds]
        whole = all(isinstance(seed, int) and not isinstance(seed, bool) for seed in listed)
        if not whole or not listed or min(listed) < (listed == [seeds]):
            raise ValueError("should be how many, at least 1, or a list of whole numbers from 0")
        if listed == [seeds] and seeds > LARGEST:
            raise ValueError(f"should be at most {LARGEST}")
        if len(set(listed)) < len(listed):
            raise ValueError("a seed is given twice")
        return seeds


@dataclass(frozen=True)
class Sweep:
    """A sweep file after reading."""

    name: str
    """The file's name without its suffix."""
    path: Path
    table: SweepTable
    axes: tuple[Axis, ...]

    @property
    def seeds(self) -> Sequence[int]:
        """Every seed, in order."""
        seeds = self.table.seeds
        return range(1, seeds + 1) if isinstance(seeds, int) else seeds

    @property
    def grid(self) -> tuple[GridAxis, ...]:
        """The axes that are not drawn."""
        return tuple(axis for axis in self.axes if isinstance(axis, GridAxis))


def built_in_sweeps() -> Mapping[str, Path]:
    """Name -> TOML file of every built-in sweep, sorted by name."""
    return {path.stem: path for path in sorted((catalogue_folder("scenarios") / "sweeps").glob("*.toml"))}


def load_sweep(sweep: str | Path, kind: type[SweepTable] = SweepTable) -> Sweep:
    """Read a sweep: a built-in name or a path. Raises BenchError, one line naming file and key.

    kind: the model of the file, if it has more keys than a sweep.
    """
    built_in = built_in_sweeps()
    path = built_in[sweep] if isinstance(sweep, str) and sweep in built_in else Path(sweep).expanduser()
    if not path.is_file():
        raise BenchError(f"sweep {str(sweep)!r}: neither a built-in sweep ({', '.join(built_in)}) nor a file")
    path = path.resolve()
    table = read_toml(path, kind)
    return Sweep(path.stem, path, table, read_axes(table.axes, str(path)))
