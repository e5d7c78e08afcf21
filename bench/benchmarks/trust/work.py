"""The work of the evaluation: cases of a trial, diagnosed and judged as in a trial, with their cells and cost."""

import time
from dataclasses import replace
from functools import partial
from math import sqrt

import numpy as np

from bench.basics.errors import BenchError
from bench.benchmarks.trust.cells import APART, TrustCase, TrustCells
from bench.benchmarks.trust.stability import NOISE, SURE, WITHOUT_LOG, certain_in, verdicts_of
from bench.diagnosis.discovery.find import find_missing_effects
from bench.identification.problem import problem_of
from bench.studies.sweep.journal import Row, cell_of
from bench.studies.sweep.plan import Run
from bench.studies.sweep.pool import Task
from bench.studies.sweep.run_plan import Work
from bench.studies.sweep.work import Trajectories
from bench.studies.trial.cases import KINDS, SHARES, SHARES_OF, Case, Kind, datasets_a_seed, draw_case
from bench.studies.trial.realise import realised
from bench.studies.trial.setup import Setup
from bench.studies.trial.work import diagnosed_row, failed_row, trial_trajectories, undisturbed
from bench.truth.dataset import as_dataset
from bench.truth.hidden.reference import Reference
from bench.truth.simulate import Simulation
from bench.truth.streams import stream

FRESH, FROZEN = "fresh", "frozen"
SECONDS, PROCESSOR = "seconds", "seconds.processor"
"""Columns of a case's wall and processor time, s; with `.again` for its further diagnoses."""

Place = dict[str, str | int]
"""The columns that identify the case of a row."""

NO_TIME = {SECONDS: 0.0, PROCESSOR: 0.0}


def case_rows(
    setup: Setup,
    place: Place,
    number: int,
    again: bool,
    trajectories: Trajectories,
    reference: Simulation | None = None,
) -> list[Row]:
    """Simulate and diagnose one case; return its row, with this number. again: also diagnose it under changed
    conditions.

    reference: the movements with nothing hidden; None: simulate them.
    """
    begun = _clocks()
    case = _case(setup, place)
    try:
        without = reference or undisturbed(setup, trajectories)
        case, simulation = realised(setup, case, Reference(without), trajectories)
        row = diagnosed_row(setup, case, number, simulation)
        seconds = _since(begun)
        if again:
            begun = _clocks()
            row |= again_columns(simulation, row)
            seconds |= {f"{name}.again": value for name, value in _since(begun).items()}
    except BenchError as error:
        row = failed_row(setup, case, number, str(error))
        seconds = _since(begun)
    return [row | {**place} | seconds]


def trust_work(cells: TrustCells) -> Work:
    """The tasks of an evaluation."""

    def setup_of(run: Run) -> Setup:
        return cells.setups[cells.case_of_row(run.number).cell.robot]

    def runs(runs: tuple[Run, ...], trajectories: Trajectories) -> Task:
        (run,) = runs
        case = cells.case_of_row(run.number)
        return partial(case_rows, setup_of(run), place_of(case), run.number, case.again, trajectories)

    def failed(run: Run, reason: str) -> Row:
        setup, place = setup_of(run), place_of(cells.case_of_row(run.number))
        return failed_row(setup, _case(setup, place), run.number, reason) | place | NO_TIME

    return Work(
        design=lambda run: partial(trial_trajectories, setup_of(run)),
        motion=lambda run, trajectories: partial(undisturbed, setup_of(run), trajectories),
        runs=runs,
        failed=failed,
    )


def place_of(case: TrustCase) -> Place:
    """The columns that identify a case in its row."""
    return {
        "robot": case.cell.robot,
        "question": case.cell.question.kind,
        "set": FROZEN if case.cell.frozen else FRESH,
        "number": case.number,
    }


def _clocks() -> tuple[float, float]:
    return time.perf_counter(), time.thread_time()


def _since(begun: tuple[float, float]) -> dict[str, float]:
    clock, processor = (after - before for after, before in zip(_clocks(), begun, strict=True))
    return {SECONDS: clock, PROCESSOR: processor}


def _case(setup: Setup, place: Place) -> Case:
    kind = next(kind for kind in KINDS if kind == place["question"])
    return drawn_case(setup, kind, int(place["number"]))


def drawn_case(setup: Setup, kind: Kind, number: int) -> Case:
    """The case of that number. In a fresh case, the size of a single effect is moved into the lower or upper half of
    its range, on a logarithmic scale; cases of the frozen set are those of a trial.
    """
    case = draw_case(setup, kind, number)
    if kind != "one" or number < APART:
        return case
    (hide,) = case.hides
    ends = SHARES_OF.get(hide.effect, SHARES)
    share = sqrt(hide.share * ends[number // datasets_a_seed(setup, kind) % 2])
    return replace(case, hides=(replace(hide, share=float(f"{share:.4g}")),))


MORE_NOISE = 0.25
"""Standard deviation of the noise added to the currents, over that of their present noise."""

FEWEST_LOGS = 3


def again_columns(simulation: Simulation, row: Row) -> Row:
    """Columns of the effects with a certain verdict: at first, with more noise and, given `FEWEST_LOGS`, without the
    last log.
    """
    columns: Row = {
        SURE: cell_of(certain_in(verdicts_of(row))),
        NOISE: _sure(with_more_noise(simulation)),
    }
    if len(simulation.recordings) >= FEWEST_LOGS:
        columns[WITHOUT_LOG] = _sure(replace(simulation, recordings=simulation.recordings[:-1]))
    return columns


def with_more_noise(simulation: Simulation) -> Simulation:
    """The simulation with independent noise added to the logged currents."""
    seed = simulation.scenario.settings.seed
    recordings = []
    for recording in simulation.recordings:
        current = recording.log.current
        noise = np.std(current - recording.current, axis=0)
        drawn = stream(seed, recording.name, "more noise").standard_normal(current.shape)
        log = replace(recording.log, current=current + MORE_NOISE * noise * drawn)
        recordings.append(replace(recording, log=log))
    return replace(simulation, recordings=tuple(recordings))


def _sure(simulation: Simulation) -> str:
    diagnosis = find_missing_effects(problem_of(as_dataset(simulation)))
    named = {v.effect: v.verdict for v in diagnosis.ranking if v.effect in diagnosis.missing}
    return cell_of(certain_in(named))
