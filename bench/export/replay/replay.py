"""A saved model's twin compared with every recording of a dataset."""

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.basics.interpolation import cubic_spline
from bench.basics.plain_data import finite
from bench.basics.progress import SILENT, Progress
from bench.basics.sentence import in_percent
from bench.basics.threads import on_one_thread
from bench.effects import JointSignals
from bench.effects.effect import ActuatorEffect
from bench.export.identified import IdentifiedModel
from bench.export.mjcf import write_mjcf
from bench.export.physical import PhysicalSet
from bench.export.sidecar import sidecar, write_sidecar
from bench.identification.filtered import Measured
from bench.identification.model_file import Comparison, applied
from bench.identification.observation import all_currents
from bench.identification.problem import Problem
from bench.identification.result import CurrentSeries, error_summary, relative_error
from bench.identification.summary import modelled_series
from bench.model.configuration import configuration_rates
from bench.model.geometry import Geometry, to_mujoco
from bench.twin import Twin, load_twin

LONGEST_STEP = 5e-4  # s
STIFFNESS = 2.0 * np.pi * 15.0  # rad/s: of the controller, critically damped
FRESH = 0.02  # s: how long an apparent inertia serves
FRAME = 0.02  # s: between poses that are kept for display
LOST = 0.05  # of a joint's range: at a larger distance from the recorded motion the twin is lost
OPEN = 1e-4  # m or rad: a larger opening of a loop moves the motors


@dataclass(frozen=True, eq=False)
class TrackingReference:
    """Motion of driven joints: time (N,) s, from its start; position, velocity, acceleration (N, n); qpos, qvel: of the
    whole robot at the start, in MuJoCo's coordinates.
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    qpos: np.ndarray
    qvel: np.ndarray


@dataclass(frozen=True, eq=False)
class Tracked:
    """torque (N, n): of the motors, N*m or N; position (N, n): of the twin's joints; opened: largest opening of a loop
    or coupling, m or rad; frames (F,): samples whose whole pose is kept, in poses (F, nq), in MuJoCo's coordinates.
    """

    torque: np.ndarray
    position: np.ndarray
    opened: float
    frames: np.ndarray
    poses: np.ndarray


def track(twin: Twin, gains: np.ndarray, reference: TrackingReference) -> Tracked:
    """Simulate the twin along a motion; gains (n,): N*m or N per unit of control.

    In every step the motor torques give the driven joints the required acceleration: the recorded one plus a correction
    towards the recorded state. Raises BenchError if the twin does not follow.
    """
    model, data = twin.model, twin.data
    interval = float(np.mean(np.diff(reference.time)))
    substeps = int(np.ceil(interval / min(model.opt.timestep, LONGEST_STEP) - 1e-9))
    model.opt.timestep = interval / substeps
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.disableflags |= (
        mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    )  # accelerations are then those of the state
    data.time = 0.0
    data.qpos[:], data.qvel[:] = reference.qpos, reference.qvel
    wanted = _between_samples(reference, substeps)
    inertia = _ApparentInertia(twin)
    dofs, actuators = twin.dofs, twin.actuators
    renew = max(1, round(FRESH / model.opt.timestep))
    torque = np.zeros(len(gains))
    torques, positions = np.empty((2, *reference.position.shape))
    opened = 0.0
    frames_apart = max(1, round(FRAME / interval))
    frames = np.arange(0, len(reference.time), frames_apart)
    poses = np.empty((len(frames), model.nq))
    steps = substeps * (len(reference.time) - 1) + 1
    for step in range(steps):
        mujoco.mj_step1(model, data)
        twin.apply_forces(torque / gains)
        _accelerate(model, data)
        if step % renew == 0:
            apparent = inertia.at(data)
        off, slow = wanted[0][step] - twin.positions, wanted[1][step] - twin.velocities
        asked = wanted[2][step] + STIFFNESS**2 * off + 2.0 * STIFFNESS * slow
        torque = torque + apparent @ (asked - data.qacc[dofs])
        data.ctrl[actuators] = torque / gains
        if step % substeps == 0:
            sample = step // substeps
            torques[sample], positions[sample] = torque, twin.positions
            opened = max(opened, float(np.abs(data.efc_pos[: data.ne]).max(initial=0.0)))
            if sample % frames_apart == 0:
                poses[sample // frames_apart] = data.qpos
        mujoco.mj_step2(model, data)
    _check_followed(twin, reference, positions)
    return Tracked(torques, positions, opened, frames, poses)


def _accelerate(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Accelerations under the present forces; positions and velocities are already evaluated."""
    mujoco.mj_fwdActuation(model, data)
    mujoco.mj_fwdAcceleration(model, data)
    mujoco.mj_fwdConstraint(model, data)


def _between_samples(
    reference: TrackingReference, substeps: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, velocity and acceleration at every step of the simulation."""
    given = reference.position, reference.velocity, reference.acceleration
    if substeps == 1:
        return given
    start, end = reference.time[0], reference.time[-1]
    fine = np.linspace(start, end, substeps * (len(reference.time) - 1) + 1)
    position, velocity, acceleration = (
        np.asarray(cubic_spline(reference.time, values)(fine)) for values in given
    )
    return position, velocity, acceleration


class _ApparentInertia:
    """Inertia (n, n) of the whole robot at the driven joints, loops closed, no friction."""

    def __init__(self, twin: Twin) -> None:
        self._model = twin.model.__copy__()
        self._model.dof_frictionloss[:] = 0.0
        self._data = mujoco.MjData(self._model)
        self._dofs, self._actuators = twin.dofs, twin.actuators

    def at(self, data: mujoco.MjData) -> np.ndarray:
        """At a state."""
        model, scratch = self._model, self._data
        scratch.qpos[:], scratch.qvel[:], scratch.ctrl[:] = data.qpos, data.qvel, 0.0
        mujoco.mj_forward(model, scratch)
        still = scratch.qacc[self._dofs].copy()
        columns = []
        for actuator, dof in zip(self._actuators, self._dofs, strict=True):
            scratch.ctrl[actuator] = 1.0
            _accelerate(model, scratch)
            pushed = float(scratch.qfrc_actuator[dof]) - self._offset(actuator)
            columns.append((scratch.qacc[self._dofs] - still) / pushed)
            scratch.ctrl[actuator] = 0.0
        return np.linalg.inv(np.column_stack(columns))

    def _offset(self, actuator: int) -> float:
        """A motor's torque at no current, N*m or N."""
        return float(self._model.actuator_gear[actuator, 0] * self._model.actuator_biasprm[actuator, 0])


def _check_followed(twin: Twin, reference: TrackingReference, positions: np.ndarray) -> None:
    span = np.maximum(np.ptp(reference.position, axis=0), np.finfo(float).tiny)
    off = np.abs(positions - reference.position) / span
    late = ~(off < LOST)
    if late.any():
        sample, joint = np.argwhere(late)[0]
        raise BenchError(
            f"the twin does not follow the recording: joint {twin.joints[joint]} is lost at "
            f"t = {reference.time[sample]:.3f} s (a stop, a contact, or a time step that is too long?)"
        )


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
    recording.
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

    Raises BenchError if model and dataset do not match, or the twin does not follow.
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
    """Currents (N, n) that give these torques, through the effects between them."""
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


def replay_sentences(result: Replay) -> tuple[str, ...]:
    """Agreement of the twin with the measurements, compared with the model, and what it lacks."""
    twin, model = relative_error(result.twin.recordings), relative_error(result.model.recordings)
    if twin is None or model is None:
        return shortcomings(result)
    count = len(result.twin.recordings)
    said = (
        f"Simulated by MuJoCo along {count} recorded motion{'s' if count > 1 else ''}, the twin's currents differ "
        f"from the measured ones by {in_percent(twin)}; those of the exported model by {in_percent(model)}."
    )
    return (said, *shortcomings(result))


def shortcomings(result: Replay) -> tuple[str, ...]:
    """What the twin omits, and loops that open."""
    messages = [f"Not simulated, so its part of the current is missing: {name}." for name in result.left_out]
    if result.opened > OPEN:
        messages.append(
            f"Loops open by up to {1e3 * result.opened:.2g} mm or mrad: solref and solimp of the MJCF's equalities are "
            'soft; solref="0.002 1" solimp="0.9999 0.99999 0.001" keeps them closed.'
        )
    return tuple(messages)
