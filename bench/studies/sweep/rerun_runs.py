"""Simulate runs of a sweep again: its folder keeps the file, the trajectories and the table, but no recordings."""

import math
from dataclasses import dataclass
from pathlib import Path

from bench.basics.errors import BenchError
from bench.scenario.scenario import scenario_from_dict
from bench.studies.sweep.hidden_share import with_sized_effect
from bench.studies.sweep.journal import OK
from bench.studies.sweep.plan import Plan, Run, make_plan
from bench.studies.sweep.results import table_in
from bench.studies.sweep.run_plan import kept_design
from bench.studies.sweep.run_sweep import DESIGNS, FILE
from bench.studies.sweep.sweep_file import load_sweep
from bench.studies.sweep.table import column_names, read_table
from bench.studies.sweep.work import designed
from bench.truth.simulate import Simulation, simulate

SHOWN = 3


@dataclass(frozen=True, eq=False)
class Again:
    """A run and its simulation."""

    run: Run
    simulation: Simulation

    @property
    def title(self) -> str:
        """The run in a few words: its number, its values on the axes, its seed."""
        axes = [f"{name} {value}" for name, value in self.run.axes.items()]
        return ", ".join([f"run {self.run.number}", *axes, f"seed {self.run.seed}"])


def is_sweep_folder(folder: Path) -> bool:
    """Whether a folder holds the results of a sweep."""
    return (folder / FILE).is_file()


def plan_of(folder: Path) -> Plan:
    """The plan of a folder's results. Raises BenchError if its file cannot be read any more."""
    return make_plan(load_sweep(folder / FILE))


def telling_runs(folder: Path, plan: Plan) -> list[int]:
    """Numbers of `SHOWN` runs, evenly spaced from the smallest to the largest value of the sweep's first metric.

    Raises BenchError for a sweep that has not ended or without a successful run.
    """
    table = table_in(folder)
    known = column_names(table)
    metric = next((name for name in plan.sweep.table.show if name in known), None)
    columns = read_table(table, ["run", "status", *([metric] if metric else [])])
    values = columns[metric] if metric else columns["run"]
    done = [
        (float(value), int(run))
        for run, status, value in zip(columns["run"], columns["status"], values, strict=True)
        if status == OK and isinstance(value, int | float) and math.isfinite(value)
    ]
    if not done:
        raise BenchError(f"{folder}: no run of this sweep gave a result")
    ordered = [run for _, run in sorted(done)]
    places = [round(k * (len(ordered) - 1) / (SHOWN - 1)) for k in range(SHOWN)]
    return [ordered[k] for k in dict.fromkeys(places)]


def run_again(folder: Path, plan: Plan, number: int) -> Again:
    """Simulate a run again, with identical results to the last bit.

    Raises BenchError for a number that the sweep does not have, and the errors of the simulation.
    """
    if not 0 <= number < plan.size:
        raise BenchError(f"{folder}: no run {number}; there are 0 to {plan.size - 1}")
    run = plan.run(number)
    trajectories = kept_design(folder / DESIGNS, run.design) or designed(run)
    content = with_sized_effect(run.content, run.base, trajectories)
    return Again(run, simulate(scenario_from_dict(content, run.base, run.base), trajectories))
