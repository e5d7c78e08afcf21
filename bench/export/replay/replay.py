"""A saved model's twin compared with every recording of a dataset."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from bench.basics.plain_data import finite
from bench.basics.progress import SILENT, Progress
from bench.basics.threads import on_one_thread
from bench.effects import JointSignals
from bench.effects.effect import ActuatorEffect
from bench.export.identified import IdentifiedModel
from bench.export.mjcf import write_mjcf
from bench.export.physical import PhysicalSet
from bench.export.replay.tracking import Tracked, TrackingReference, track
from bench.export.sidecar import sidecar, write_sidecar
from bench.identification.filtered import Measured
from bench.identification.model_file import Comparison, applied
from bench.identification.observation import all_currents
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, error_summary, relative_error
from bench.identification.summary import modelled_series
from bench.model.configuration import configuration_rates
from bench.model.geometry import Geometry, to_mujoco
from bench.twin import load_twin


@dataclass(frozen=True, eq=False)
class TwinMotion:
    """Where the twin was during a recording: time (F,) s, as logged; poses (F, nq), in MuJoCo's coordinates."""

    time: np.ndarray
    poses: np.ndarray


@dataclass(frozen=True, eq=False)
class Replay:
    """twin: measured currents and those of the twin, at the fit's rate; model: and those of the model.

    left_out: effects of the model that the twin does not have. off (recordings, n): RMS distance of the twin's joints
    from the recorded ones, rad or m. opened: the most by which MuJoCo let a loop or coupling open, m or rad. motions:
    of the twin, by recording.
    """

    twin: Comparison
    model: Comparison
    left_out: tuple[str, ...]
    off: np.ndarray
    opened: float
    motions: Mapping[str, TwinMotion]


@on_one_thread
def replay(problem: Problem, physical: PhysicalSet, progress: Progress = SILENT) -> Replay:
    """Export a model, simulate it in MuJoCo along every recording, and compare its currents with the recorded ones.

    Raises BenchError where model and dataset do not go together, and where the twin does not follow.
    """
    dataset = problem.dataset
    identified = replace(physical.model, declared={**physical.model.declared, **dataset.payloads})
    physical = replace(physical, model=identified)
    prepared, solution = applied(problem, identified.saved)
    joints = list(dataset.robot.joints)
    modelled = tuple(
        modelled_series(prepared, observation, solution) for observation in prepared.observations
    )
    twins: list[CurrentSeries] = []
    off: list[np.ndarray] = []
    motions: dict[str, TwinMotion] = {}
    opened = 0.0
    left_out: tuple[str, ...] = ()
    with tempfile.TemporaryDirectory() as folder:
        progress.phase("replay", len(modelled))
        for measurement, series in zip(prepared.measured, modelled, strict=True):
            path = Path(folder) / "twin.xml"
            exported = write_mjcf(path, physical, measurement.recording.payload, measurement.recording.log)
            write_sidecar(path, sidecar(physical, exported))
            twin = load_twin(path, partial=True)
            tracked = track(twin, identified.gains, _reference(prepared.model.geometry, measurement))
            left_out = _left_out(identified, twin.left_out)
            currents = _currents(identified, measurement, tracked)
            twins.append(replace(series, modelled=_at_fit_rate(measurement, currents), by_effect={}))
            off.append(np.sqrt(((tracked.position - measurement.position) ** 2).mean(axis=0)))
            motions[series.name] = TwinMotion(measurement.time[tracked.frames], tracked.poses)
            opened = max(opened, tracked.opened)
            progress.advance()
    name = str(identified.path)
    return Replay(
        twin=Comparison(dataset.robot.name, name, tuple(twins), error_summary(twins, joints)),
        model=Comparison(dataset.robot.name, name, modelled, error_summary(modelled, joints)),
        left_out=left_out,
        off=np.array(off),
        opened=opened,
        motions=motions,
    )


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
        "recordings": [
            {"name": trace.name, "use": trace.use, "payload": trace.payload, "off": off.tolist()}
            for trace, off in zip(result.twin.recordings, result.off, strict=True)
        ],
    }
    return dict(finite(answer))


def _reference(geometry: Geometry, measured: Measured) -> TrackingReference:
    first = measured.tree.at(slice(0, 1))
    qpos = to_mujoco(geometry.joints, first.q)[0]
    return TrackingReference(
        time=measured.time - measured.time[0],
        position=measured.position,
        velocity=measured.velocity,
        acceleration=measured.acceleration,
        qpos=qpos,
        qvel=_mujoco_velocity(geometry, first.q, first.v, first.a),
    )


def _mujoco_velocity(geometry: Geometry, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Velocity (nv,) in MuJoCo's coordinates, in which a free body's linear one is along the world's axes."""
    velocity = v[0].copy()
    rates = configuration_rates(geometry, q.T, v.T, a.T)[0]
    for joint in geometry.joints:
        if joint.kind == "free":
            velocity[joint.v.start : joint.v.start + 3] = rates[joint.q.start : joint.q.start + 3, 0]
    return velocity


def _currents(identified: IdentifiedModel, measured: Measured, tracked: Tracked) -> np.ndarray:
    """Currents (N, n) that give these torques, through the effects that stand between them."""
    total = tracked.torque.copy()
    rate = measured.recording.rate
    joints = list(identified.robot.joints)
    kinds = {joint.name: joint.kind for joint in identified.model.geometry.joints}
    for fitted_effect in identified.effects_in(measured.recording.log):
        effect = fitted_effect.instance.effect
        if not effect.before_torque or not isinstance(effect, ActuatorEffect):
            continue
        j = joints.index(fitted_effect.place)
        needed = tracked.torque[:, j]
        signals = JointSignals(
            time=measured.time - measured.recording.time[0],
            position=measured.position[:, j],
            velocity=measured.velocity[:, j],
            acceleration=measured.acceleration[:, j],
            current=needed / identified.gains[j],
            gain=float(identified.gains[j]),
            speed=float(np.sqrt((measured.velocity[:, j] ** 2).mean())),
            rate=rate,
            band=measured.settings.band(rate),
            rotates=kinds[fitted_effect.place] != "slide",
            needs=partial(np.asarray, needed),
        )
        total[:, j] += effect.torque(signals) @ np.array(list(fitted_effect.values.values()))
    return np.asarray(total / identified.gains)


def _left_out(identified: IdentifiedModel, by_twin: Sequence[str]) -> tuple[str, ...]:
    """What the twin omits, except effects between current and torque, which are computed afterwards."""
    between = {
        f"{effect.name} at {effect.place}"
        for effect in identified.effects
        if effect.instance.effect.before_torque and isinstance(effect.instance.effect, ActuatorEffect)
    }
    return tuple(name for name in by_twin if name not in between)


def _at_fit_rate(measured: Measured, currents: np.ndarray) -> np.ndarray:
    """Currents (N, n), interpolated at standstill, filtered and decimated as the measured ones are: (M, n)."""
    rows = all_currents(replace(measured, current=currents))
    motors = np.arange(currents.shape[1])
    return rows[:, motors, motors]
