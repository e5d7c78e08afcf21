"""A saved model's twin compared with every recording of a dataset."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from bench.basics.errors import BenchError
from bench.basics.plain_data import finite
from bench.basics.progress import SILENT, Progress
from bench.basics.quiet import unwarned
from bench.basics.threads import on_one_thread
from bench.export.physical import PhysicalSet, with_values
from bench.export.replay.causes import Cause, causes_as_data, causes_of
from bench.export.replay.simulated import Recorded, simulate
from bench.export.replay.track import AS_EXPORTED
from bench.export.replay.words import lost_in_words
from bench.identification.model_file import Comparison, SavedModel, applied
from bench.identification.prepare import Prepared
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, error_summary, relative_error
from bench.identification.summary import modelled_series


@dataclass(frozen=True, eq=False)
class TwinMotion:
    """Motion of the twin in a recording: time (F,) s, as logged; poses (F, nq), in MuJoCo's coordinates."""

    time: np.ndarray
    poses: np.ndarray


@dataclass(frozen=True, eq=False)
class Replay:
    """twin: measured currents and those of the twin, at the fit's rate; model: likewise of the model.

    left_out: effects of the model that the twin lacks. off (recordings, n): RMS distance of the twin's joints from the
    recorded ones, rad or m. opened: largest opening of a loop or coupling in MuJoCo, m or rad. motions: of the twin, by
    recording. causes: of an error that the model does not have.
    """

    twin: Comparison
    model: Comparison
    left_out: tuple[str, ...]
    off: np.ndarray
    opened: float
    motions: Mapping[str, TwinMotion]
    causes: tuple[Cause, ...]


@on_one_thread
def replay(problem: Problem, physical: PhysicalSet, progress: Progress = SILENT) -> Replay:
    """Export a model, simulate it in MuJoCo along every recording, and compare its currents with the recorded ones.

    Raises BenchError if model and dataset do not match, or the twin does not follow.
    """
    dataset, joints = problem.dataset, list(problem.dataset.robot.joints)
    identified = replace(physical.model, declared={**physical.model.declared, **dataset.payloads})
    prepared, modelled = _modelled(problem, identified.saved)
    recorded = Recorded(prepared, replace(physical, model=identified), modelled)
    with unwarned():
        simulated = simulate(recorded, AS_EXPORTED, progress)
        possible = _with_possible_bodies(problem, recorded)
        causes = causes_of(recorded, simulated, possible, progress)
    if simulated.lost is not None:
        raise BenchError(lost_in_words(simulated.lost, causes))
    name = str(identified.path)
    return Replay(
        twin=Comparison(dataset.robot.name, name, simulated.series, error_summary(simulated.series, joints)),
        model=Comparison(dataset.robot.name, name, modelled, error_summary(modelled, joints)),
        left_out=simulated.left_out,
        off=np.array(
            [
                np.sqrt(((tracked.position - measurement.position) ** 2).mean(axis=0))
                for tracked, measurement in zip(simulated.tracked, prepared.measured, strict=True)
            ]
        ),
        opened=simulated.opened,
        motions={
            series.name: TwinMotion(measurement.time[tracked.frames], tracked.poses)
            for series, measurement, tracked in zip(
                modelled, prepared.measured, simulated.tracked, strict=True
            )
        },
        causes=causes,
    )


def _modelled(problem: Problem, saved: SavedModel) -> tuple[Prepared, tuple[CurrentSeries, ...]]:
    """The equations of all recordings, and a model's currents in each."""
    prepared, solution = applied(problem, saved)
    return prepared, tuple(
        modelled_series(prepared, observation, solution) for observation in prepared.observations
    )


def _with_possible_bodies(problem: Problem, recorded: Recorded) -> float:
    """Relative error of the model with the parameters of the exported bodies."""
    physical = recorded.physical
    if not physical.distance:
        return relative_error(recorded.modelled) or 0.0
    saved = physical.model.saved
    moved = replace(saved, model=with_values(saved.model, physical.model))
    return relative_error(_modelled(problem, moved)[1]) or 0.0


def replay_json(result: Replay) -> dict[str, Any]:
    """The answer as plain data."""
    answer = {
        "robot": result.twin.robot,
        "model": result.twin.model,
        "error": asdict(result.twin.error),
        "error_of_model": asdict(result.model.error),
        "of_all_recordings": {
            "twin": relative_error(result.twin.recordings),
            "model": relative_error(result.model.recordings),
        },
        "left_out": list(result.left_out),
        "opened": result.opened,
        "causes": causes_as_data(result.causes),
        "recordings": [
            {"name": trace.name, "use": trace.use, "payload": trace.payload, "off": off.tolist()}
            for trace, off in zip(result.twin.recordings, result.off, strict=True)
        ],
    }
    return dict(finite(answer))
