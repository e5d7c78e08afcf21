"""Reference scenarios, their accepted results, and the comparison of new results with these."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from bench.basics.chi_squared import CONFIDENCE
from bench.basics.errors import BenchError
from bench.basics.files.atomic import write_text_atomically
from bench.dataset.catalogue import catalogue_folder
from bench.studies.sweep.metrics import is_share
from bench.studies.sweep.plan import Plan, digest, make_plan
from bench.studies.sweep.sweep_file import Sweep, SweepTable, load_sweep
from bench.studies.sweep.table import column_names, read_table

DIGITS = 9  # significant digits of stored values
Tolerance = Annotated[float, Field(ge=0, allow_inf_nan=False)]
ALARMS = ("worse", "over its limit")
RELATIVE_SPREAD = 0.01  # least spread, as a share of the value, for example with a single seed
LEAST_SPREAD = 1e-12
LIMITS = {"identify_error": "error.identify", "validate_error": "error.validate"}
"""Tolerance of a scenario -> its metric, if the name differs."""


class ReferenceTable(SweepTable):
    """A sweep that is compared with the reference. The scenario's [tolerances] apply to every run."""

    quick: Annotated[int, Field(ge=0)] = 0
    """Number of seeds in the quick set; with 0 it omits the sweep."""
    tolerances: Mapping[str, Tolerance] = {}
    """Largest change of a metric that does not count, in units of its spread between seeds."""


@dataclass(frozen=True)
class ReferenceLine:
    """Values by metric of the runs that differ only in their seed, in the order of `seeds`."""

    seeds: tuple[int, ...]
    values: Mapping[str, tuple[float | None, ...]]


@dataclass(frozen=True)
class SweepReference:
    """Accepted results of a sweep: a line for each combination of its axes, the reason, and the program's version."""

    content: str
    """Digest of the sweep and its scenarios, which shows whether they have changed."""
    reason: str
    program: Mapping[str, str]
    lines: Mapping[str, ReferenceLine]


def reference_sweeps(folder: Path | None = None) -> dict[str, Sweep]:
    """Name -> sweep, sorted, from `folder` or the project's catalogue. Raises BenchError if there is none."""
    paths = sorted((folder or catalogue_folder("scenarios") / "reference").glob("*.toml"))
    if not paths:
        raise BenchError(f"{folder}: holds no reference scenarios (*.toml)")
    return {path.stem: load_sweep(path, ReferenceTable) for path in paths}


def reference_folder() -> Path:
    """The project's folder of references; BenchError if only the package is installed."""
    folder = Path(__file__).resolve().parents[3] / "results" / "reference"
    if not folder.is_dir():
        raise BenchError("no results/reference next to the package: give the folder with --reference")
    return folder


def tolerances_of(sweep: Sweep) -> Mapping[str, float]:
    """The tolerances of a reference sweep."""
    table = sweep.table
    assert isinstance(table, ReferenceTable)
    return table.tolerances


def chosen_plan(sweep: Sweep, *, full: bool) -> Plan | None:
    """The runs to compare, with all seeds or those of the quick set; None if that omits the sweep."""
    table = sweep.table
    assert isinstance(table, ReferenceTable)
    if full:
        return make_plan(sweep)
    if not table.quick:
        return None
    seeds = tuple(sweep.seeds[: table.quick])
    return make_plan(replace(sweep, table=table.model_copy(update={"seeds": seeds})))


def content_of(sweep: Sweep) -> str:
    """Digest of everything that the runs depend on, except for the seeds."""
    table = sweep.table.model_copy(update={"seeds": (1,)})
    plan = make_plan(replace(sweep, table=table))
    return digest([[run.content, run.identify, run.axes] for run in map(plan.run, range(plan.size))])


def measured_lines(plan: Plan, table: Path, metrics: Sequence[str]) -> dict[str, ReferenceLine]:
    """Results of a finished sweep by the label of its axes' values; a value is None for a failed run."""
    axes = list(plan.axis_names)
    known = set(column_names(table))
    columns = read_table(table, ["seed", *axes, *(metric for metric in metrics if metric in known)])
    rows: dict[str, list[int]] = {}
    for i in range(len(columns["seed"])):
        rows.setdefault(", ".join(f"{axis} = {columns[axis][i]}" for axis in axes), []).append(i)
    nothing = [None] * len(columns["seed"])
    return {
        label: ReferenceLine(
            tuple(columns["seed"][i] for i in indices),
            {metric: tuple(columns.get(metric, nothing)[i] for i in indices) for metric in metrics},
        )
        for label, indices in rows.items()
    }


def save_reference(path: Path, reference: SweepReference) -> None:
    """Write a reference as JSON with one metric per line, so that a diff shows each change."""
    lines = {
        label: {"seeds": line.seeds, **{metric: _rounded(values) for metric, values in line.values.items()}}
        for label, line in reference.lines.items()
    }
    head = {"reason": reference.reason, "content": reference.content, "program": dict(reference.program)}
    text = json.dumps({**head, "lines": lines}, indent=1, ensure_ascii=False)
    text = re.sub(r"\[\n[^\]]*\]", lambda values: json.dumps(json.loads(values[0])), text)
    write_text_atomically(path, text.replace("\n   ", "\n    ") + "\n")


def load_reference(path: Path) -> SweepReference | None:
    """Read a reference; None if there is no file. Raises BenchError if the file is not a reference."""
    if not path.is_file():
        return None
    try:
        content: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
        lines = {
            label: ReferenceLine(tuple(line["seeds"]), {m: tuple(v) for m, v in line.items() if m != "seeds"})
            for label, line in content["lines"].items()
        }
        return SweepReference(content["content"], content["reason"], content["program"], lines)
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise BenchError(f"{path}: is not a reference ({type(error).__name__}: {error})") from error


def _rounded(values: Sequence[float | None]) -> list[float | None]:
    return [None if value is None else float(f"{value:.{DIGITS}g}") for value in values]


Verdict = Literal["same", "better", "worse", "over its limit", "new"]


@dataclass(frozen=True)
class ReferenceComparison:
    """One metric of one reference scenario.

    reference, now: means over the same seeds; for a share of intervals that contain the truth, the coverage. change:
    positive for the worse, in units of the spread between seeds; None without a reference. limit: for every single
    run, or None.
    """

    sweep: str
    line: str
    metric: str
    reference: float | None
    now: float | None
    change: float | None
    tolerance: float
    limit: float | None
    verdict: Verdict


def compare_line(
    sweep: str,
    label: str,
    reference: ReferenceLine | None,
    now: ReferenceLine,
    tolerances: Mapping[str, float],
    limits: Mapping[str, float],
) -> list[ReferenceComparison]:
    """Compare every metric that has a tolerance, seed by seed. limits: for every single run."""
    comparisons = []
    for metric, tolerance in tolerances.items():
        values = _by_seed(now, metric)
        limit = limits.get(metric)
        before = {} if reference is None else _by_seed(reference, metric)
        seeds = [seed for seed in now.seeds if seed in before]
        if not seeds:
            mean, change, old = _mean(list(values.values())), None, None
            verdict: Verdict = "new"
        else:
            old_values, new_values = [before[seed] for seed in seeds], [values[seed] for seed in seeds]
            old, mean = _mean(old_values), _mean(new_values)
            change = _change(metric, old_values, new_values, list(before.values()))
            verdict = "worse" if change > tolerance else "better" if change < -tolerance else "same"
        if limit is not None and any(value is not None and value > limit for value in values.values()):
            verdict = "over its limit"
        comparisons.append(
            ReferenceComparison(sweep, label, metric, old, mean, change, tolerance, limit, verdict)
        )
    return comparisons


def limits_of(tolerances: Mapping[str, float]) -> dict[str, float]:
    """A scenario's tolerances by metric."""
    return {LIMITS.get(name, name): value for name, value in tolerances.items()}


def _by_seed(line: ReferenceLine, metric: str) -> dict[int, float | None]:
    values = line.values.get(metric)
    return {} if values is None else dict(zip(line.seeds, values, strict=True))


def _change(
    metric: str, old: Sequence[float | None], new: Sequence[float | None], everything: Sequence[float | None]
) -> float:
    """Change for the worse in units of the spread; infinite if a run fails that did not fail before."""
    if any(a is not None and b is None for a, b in zip(old, new, strict=True)):
        return float("inf")
    pairs = [(a, b) for a, b in zip(old, new, strict=True) if a is not None and b is not None]
    if not pairs:
        return float("-inf") if any(value is not None for value in new) else 0.0
    before, after = np.array(pairs).T
    if is_share(metric):
        unit = float(np.sqrt(CONFIDENCE * (1 - CONFIDENCE) / len(pairs)))
        return float(abs(after.mean() - CONFIDENCE) - abs(before.mean() - CONFIDENCE)) / unit
    known = np.array([value for value in everything if value is not None])
    spread = float(np.std(known, ddof=1)) if len(known) > 1 else 0.0
    unit = max(spread, RELATIVE_SPREAD * float(np.abs(known).mean()), LEAST_SPREAD)
    return float((after - before).mean()) / unit


def _mean(values: Sequence[float | None]) -> float | None:
    known = [value for value in values if value is not None]
    return float(np.mean(known)) if known else None
