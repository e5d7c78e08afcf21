"""The next best motion after existing recordings."""

from dataclasses import replace

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.mapper import IN_TURN, Mapper
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.excitation.experiment.nominal import Evidence, Noise, Nominal, equations
from bench.excitation.experiment.plan import (
    WHOLE,
    Aim,
    ExperimentPlan,
    Started,
    check_linear,
    noise_of,
    searched,
    shape_of,
    started,
)
from bench.excitation.experiment.planned_log import PlannedRows, row_evidence
from bench.excitation.experiment.request import ExperimentTable
from bench.excitation.experiment.room import Room, room_of
from bench.excitation.experiment.search import largest_of
from bench.identification.finding import MEND_FIRST
from bench.identification.finding_words import sentence
from bench.identification.identify import fit
from bench.identification.mistaken import mistaken
from bench.identification.prepare import Prepared, prepare
from bench.identification.problem import Problem
from bench.model.geometry import Geometry
from bench.signals.decimation import decimated_indices
from bench.signals.settings import signal_bands

NEXT = "next"


@on_one_thread
def plan_after(
    problem: Problem,
    table: ExperimentTable,
    aim: Aim = WHOLE,
    *,
    mapper: Mapper = IN_TURN,
    progress: Progress = SILENT,
) -> ExperimentPlan:
    """The motion, with or without a payload of the dataset, that adds most to its fitted recordings.

    problem: the recordings; its effects are not targets. The machine is identified from them; limits of speed and
    acceleration that the table omits are the largest recorded ones. See `plan_experiment`. Raises BenchError for a
    payload in the table.
    """
    if table.payload is not None:
        raise BenchError("payload: the next motion carries what the dataset declares: leave it out")
    progress.phase("fitting what is there")
    dataset = problem.dataset
    prepared = prepare(replace(problem, effects=(*problem.effects, *aim.effects)))
    check_linear(prepared.effects)
    nominal = _measured_machine(problem, prepared, table)
    if nominal.doubts and not (nominal.gains > 0.0).all():
        raise BenchError(f"{dataset.folder}: {sentence(nominal.doubts[0])}")
    known = _known(prepared, nominal)
    room = _room(nominal.model.geometry, table, prepared)
    shape = shape_of(room, table)
    loads = dict.fromkeys(observation.payload_name for observation in prepared.fitted)
    begun: list[Started] = []
    for load in loads:
        if load is None or nominal.payloads[load].mass is not None:
            sizes = begun[0].search.errors.sizes if begun else None
            begun.append(
                started(
                    nominal,
                    room,
                    shape,
                    (load,),
                    aim,
                    known=known,
                    sizes=sizes,
                    mapper=mapper,
                    progress=progress,
                )
            )
    if not begun:
        raise BenchError(f"{dataset.folder}: every fitted recording carries a payload of unknown mass")
    best = min(begun, key=lambda start: min(map(start.search.value, [*start.random, *start.sparse])))
    plan = searched(dataset.robot, best, (NEXT,), aim, mapper, progress)
    return replace(plan, before=largest_of(best.search.errors, equations(known)))


def _measured_machine(problem: Problem, prepared: Prepared, table: ExperimentTable) -> Nominal:
    """The machine identified from the data, the noise of its log, and the doubts of `identify`."""
    identified = fit(prepared)
    findings = (*mistaken(problem, identified), *identified.findings)
    values = {parameter.name: parameter.value for parameter in identified.parameters}
    dataset, model = prepared.dataset, prepared.model
    carried = [observation.payload_name for observation in prepared.fitted]
    return Nominal(
        model=model,
        base=np.array([values.get(name, 0.0) for name in model.base.names]),
        gains=np.array([gain.value for gain in identified.drive_gains.values()]),
        payloads={name: dataset.payloads[name] for name in dict.fromkeys(carried) if name is not None},
        layout=prepared.layout,
        effects=prepared.effects,
        gains_fitted=identified.gains_fitted,
        noise=_noise(prepared, table),
        source="the model and the gains that the recordings give",
        doubts=tuple(finding for finding in findings if finding.code in MEND_FIRST),
    )


def _noise(prepared: Prepared, table: ExperimentTable) -> Noise:
    """Given by the user, else from the spectra of the recordings."""
    noise = noise_of(prepared.dataset.robot, table)
    recordings = [measurement.recording for measurement in prepared.measured]
    rate = recordings[0].rate
    bands = signal_bands(
        [recording.position for recording in recordings],
        [recording.current for recording in recordings],
        rate,
    )
    if noise.current is not None:
        return replace(noise, rate=rate)
    current = np.sqrt(bands.current_noise * rate / 2.0)
    heard = bool(np.all(current > 0.0))
    return Noise(current if heard else None, noise.ratio, noise.encoder, rate, recorded=heard)


def _known(prepared: Prepared, nominal: Nominal) -> tuple[Evidence, ...]:
    """Evidence of fitted recordings."""
    used = [measurement for measurement in prepared.measured if measurement.recording.use == "identify"]
    decimation = prepared.settings.decimation
    return tuple(
        row_evidence(
            nominal,
            PlannedRows(
                measured.tree.at(decimated_indices(len(measured.time), decimation)),
                observation.moving,
                decimation,
            ),
            observation.payload_name,
        )
        for measured, observation in zip(used, prepared.fitted, strict=True)
    )


def _room(geometry: Geometry, table: ExperimentTable, prepared: Prepared) -> Room:
    """The room of the table, with the largest recorded speeds and accelerations if it has none."""
    joints = prepared.dataset.robot.joints
    changes = {}
    for key in ("velocity", "acceleration"):
        if getattr(table, key) is None:
            largest = np.max(
                [np.abs(getattr(measurement, key)).max(axis=0) for measurement in prepared.measured], axis=0
            )
            changes[key] = dict(zip(joints, largest.tolist(), strict=True))
    assumption = f"{' and '.join(changes)}: the largest of each joint in the recordings"
    room = room_of(geometry, table.model_copy(update=changes))
    return replace(room, assumed=(*room.assumed, assumption)) if changes else room
