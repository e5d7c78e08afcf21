"""The tasks of a sweep that workers run, as functions of plain values."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.quiet import stop_step_timers, unwarned
from bench.basics.versions import versions
from bench.diagnosis.discovery.find import find_missing_effects
from bench.excitation.scenario import designer
from bench.identification.identify import fit
from bench.identification.prepare import Prepared, prepare, with_gains
from bench.identification.problem import problem_of
from bench.identification.result import Identification
from bench.scenario.scenario import Scenario, resolve_trajectories, scenario_from_dict
from bench.scenario.trajectory import FourierTrajectory
from bench.studies.sweep.accuracy import Metrics
from bench.studies.sweep.hidden_share import with_sized_effect, without_share
from bench.studies.sweep.identified_run import IdentifiedRun
from bench.studies.sweep.journal import FAILED, OK, Row
from bench.studies.sweep.metrics import METRICS
from bench.studies.sweep.plan import Run, flat_settings, plain
from bench.studies.sweep.run_plan import Work
from bench.studies.sweep.sweep_file import Sweep
from bench.truth.dataset import as_dataset
from bench.truth.machine import true_gains
from bench.truth.resense import sense_again
from bench.truth.simulate import Simulation, simulate


def measure(
    simulation: Simulation, prepared: Prepared, result: Identification, record: Sequence[str]
) -> Metrics:
    """Metrics of one identification. record: groups of metrics, see `SweepTable`."""
    run = IdentifiedRun(simulation, prepared, result, record)
    metrics: Metrics = dict(run.accuracy)
    for name, metric in METRICS.items():
        if metric.group and metric.group not in record:
            continue
        if metric.value is not None:
            metrics[name] = metric.value(run)
        if metric.values is not None:
            metrics |= {f"{name}.{of}": value for of, value in metric.values(run).items()}
    return metrics


def diagnosis_metrics(simulation: Simulation, prepared: Prepared) -> dict[str, float | str]:
    """Number of missed and invented effects, names of the identified ones, and the gain error of the model with them.

    An effect that the data cannot distinguish from the true one counts as identified.
    """
    modelled = tuple(dict.fromkeys(instance.request for instance in prepared.effects))
    problem = problem_of(prepared.dataset, modelled, filters=prepared.settings)
    diagnosis = find_missing_effects(problem, discover=False)  # only effects of the catalogue count
    hidden = {effect.name for effect in simulation.machine.hidden} - {
        instance.name for instance in prepared.effects
    }
    alternatives = {verdict.effect: {verdict.effect, *verdict.alternatives} for verdict in diagnosis.ranking}
    missed = [name for name in hidden if not any(name in alternatives[other] for other in diagnosis.missing)]
    invented = [name for name in diagnosis.missing if not alternatives[name] & hidden]
    gains = diagnosis.after.drive_gains.values()
    errors = [
        abs(gain.value / truth - 1.0)
        for gain, truth in zip(gains, true_gains(simulation.scenario), strict=True)
    ]
    return {
        "diagnosis.missed": float(len(missed)),
        "diagnosis.invented": float(len(invented)),
        "diagnosis.missing": " + ".join(diagnosis.missing) or "none",
        "diagnosis.gain_error": max(errors),
        "diagnosis.unexplained": float(diagnosis.unexplained.significant),
    }


Trajectories = Mapping[str, FourierTrajectory]


def designed(run: Run, _: None = None) -> Trajectories:
    """Design the trajectories of a run, by recording name."""
    return resolve_trajectories(_scenario(run, without_share(run.design_content)), designer)


def shared_motion(run: Run, trajectories: Trajectories, _: None = None) -> Simulation:
    """Simulate the motion that several tasks share, reduced to the signals that `sense_again` needs."""
    return slim(_simulated(run, trajectories))


def rows_of(
    runs: tuple[Run, ...], trajectories: Trajectories, record: Sequence[str], motion: Simulation | None = None
) -> list[Row]:
    """Identify one set of equations with the settings of each run: a row for each run.

    A run that fails with a BenchError has the reason in its row. motion: a simulation shared with other tasks; with
    None, it is simulated.
    """
    first = runs[0]
    try:
        if motion is None:
            simulation = _simulated(first, trajectories)
        else:
            simulation = sense_again(motion, _scenario(first, without_share(first.content)))
        dataset = as_dataset(simulation)
        filters = simulation.scenario.settings.filter.model_dump(exclude_none=True)
        prepared = prepare(problem_of(dataset, first.identify["effects"], filters, fit_gains=False))
    except BenchError as error:
        return [failed_row(run, str(error)) for run in runs]
    rows = []
    for run in runs:
        options = {key: run.identify[key] for key in ("deviations", "essential")}
        try:
            for_run = with_gains(prepared, run.identify["fit_gains"])
            result = fit(for_run, run.identify["method"], **options)
            metrics: dict[str, float | str] = dict(measure(simulation, prepared, result, record))
            if run.identify["diagnose"]:
                metrics |= diagnosis_metrics(simulation, prepared)
        except BenchError as error:
            rows.append(failed_row(run, str(error)))
        else:
            rows.append(_row(run, metrics))
    return rows


def identification_work(sweep: Sweep) -> Work:
    """The tasks of a sweep that simulates and identifies."""
    record = sweep.table.record
    return Work(
        design=lambda run: partial(designed, run),
        motion=lambda run, trajectories: partial(shared_motion, run, trajectories),
        runs=lambda runs, trajectories: partial(rows_of, runs, trajectories, record),
        failed=failed_row,
    )


def failed_row(run: Run, reason: str) -> Row:
    """The row of a failed run."""
    return _row(run, {}) | {"status": FAILED, "reason": " ".join(reason.split())}


def slim(simulation: Simulation) -> Simulation:
    """A simulation reduced to the signals that `sense_again` needs (time, positions, current references), a few
    megabytes.
    """
    nothing = np.empty((0, 0))
    motion: Any = dict.fromkeys(("qpos", "qvel", "qacc", "torque", "reference", "gaps"), nothing)
    recordings = tuple(
        replace(
            recording,
            motion=replace(recording.motion, **motion),
            log=replace(recording.log, time=nothing, position=nothing, current=nothing),
        )
        for recording in simulation.recordings
    )
    return replace(simulation, recordings=recordings)


def _scenario(run: Run, content: Mapping[str, Any]) -> Scenario:
    return scenario_from_dict(content, run.base, run.base)


def _simulated(run: Run, trajectories: Trajectories) -> Simulation:
    content = with_sized_effect(run.content, run.base, trajectories)
    with unwarned():
        stop_step_timers()
        return simulate(_scenario(run, content), trajectories, threads=1)


def _row(run: Run, metrics: Mapping[str, float | str]) -> Row:
    row: Row = {"run": run.number, "status": OK, "reason": None, "scenario": run.base, "seed": run.seed}
    row |= run.axes
    row |= metrics
    row |= {key: plain(value) for key, value in run.identify.items()}
    row |= {key: value for key, value in flat_settings(run.content) if key not in row}
    return row | versions().columns()
