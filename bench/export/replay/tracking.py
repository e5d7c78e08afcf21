"""A twin follows a recorded motion under a stiff controller, and tells what torque that took."""

from dataclasses import dataclass

import mujoco
import numpy as np

from bench.basics.errors import BenchError
from bench.basics.interpolation import cubic_spline
from bench.twin import Twin

LONGEST_STEP = 5e-4  # s
STIFFNESS = 2.0 * np.pi * 15.0  # rad/s: of the controller, critically damped
FRESH = 0.02  # s: how long an apparent inertia serves
FRAME = 0.02  # s: between the poses that are kept, to be looked at
LOST = 0.05  # of a joint's range: farther from the recorded motion it is another motion


@dataclass(frozen=True, eq=False)
class TrackingReference:
    """What the driven joints do: time (N,) s, from its start; position, velocity, acceleration (N, n); qpos, qvel: of
    the whole robot at the start, in MuJoCo's coordinates.
    """

    time: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    qpos: np.ndarray
    qvel: np.ndarray


@dataclass(frozen=True, eq=False)
class Tracked:
    """torque (N, n): of the motors, N*m or N; position (N, n): where the twin's joints were; opened: the most by which
    a loop or coupling was open, m or rad; frames (F,): samples of which the whole pose is kept, in poses (F, nq), in
    MuJoCo's coordinates.
    """

    torque: np.ndarray
    position: np.ndarray
    opened: float
    frames: np.ndarray
    poses: np.ndarray


def track(twin: Twin, gains: np.ndarray, reference: TrackingReference) -> Tracked:
    """Simulate the twin along a motion; gains (n,): N*m or N per unit of control.

    In every step the motors get what gives the driven joints the acceleration that is asked for: the recorded one and
    a correction towards the recorded state. Raises BenchError where the twin does not follow.
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
    """Accelerations under the forces as they are set; positions and velocities are evaluated already."""
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
    """What the driven joints feel of the whole robot, loops closed and without friction, (n, n)."""

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
        """What a motor gives at no current, N*m or N."""
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
