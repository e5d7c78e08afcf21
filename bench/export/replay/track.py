"""A twin simulated along a motion: MuJoCo closes the loops and integrates, a stiff controller follows."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from bench.basics.interpolation import cubic_spline
from bench.identification.filtered import Measured
from bench.robot_check.contacts import GeomPair, active_contacts, geom_pair
from bench.twin import Twin

LONGEST_STEP = 5e-4  # s
STIFFNESS = 2.0 * np.pi * 15.0  # rad/s: of the controller, critically damped
FRESH = 0.02  # s: how long an apparent inertia serves
FRAME = 0.02  # s: between poses that are kept for display
LOST = 0.05  # of a joint's range: at a larger distance from the recorded motion the twin is lost
OPEN = 1e-4  # m or rad: a larger opening of a loop moves the motors


@dataclass(frozen=True)
class FileChange:
    """A change of the exported MJCF: contacts off, and equalities as stiff as the time step allows."""

    contacts_off: bool = False
    stiff: bool = False
    solimp: tuple[float, float, float] = (0.9999, 0.99999, 0.001)

    @property
    def phase(self) -> str:
        """The name of the simulation while it runs."""
        changes = [
            *(["without contacts"] if self.contacts_off else []),
            *(["with stiff loops"] if self.stiff else []),
        ]
        return " ".join(["replay", *changes])

    def solref(self, step: float) -> tuple[float, float]:
        """Of the stiff equalities, for a step of the simulation, s; MuJoCo raises shorter times to two steps."""
        return 2.0 * step, 1.0

    def make(self, model: mujoco.MjModel) -> None:
        """Change a model whose step is set."""
        if self.contacts_off:
            model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
        if self.stiff:
            model.eq_solref[:] = self.solref(model.opt.timestep)
            model.eq_solimp[:, : len(self.solimp)] = self.solimp


AS_EXPORTED = FileChange()


@dataclass(frozen=True)
class Lost:
    """The twin no longer follows: a joint, and the time from the start of the motion, s."""

    joint: str
    time: float


@dataclass(frozen=True, eq=False)
class Tracked:
    """torque (N, n): of the motors, N*m or N; position (N, n): of the twin's joints; opened: largest opening of a loop
    or coupling, m or rad; frames (F,): samples whose whole pose is kept, in poses (F, nq), in MuJoCo's coordinates;
    touching: geoms that push each other, with the impulse of it, N s; step: of the simulation, s; lost: None if the
    twin follows to the end, else values after that are NaN.
    """

    torque: np.ndarray
    position: np.ndarray
    opened: float
    frames: np.ndarray
    poses: np.ndarray
    touching: Mapping[GeomPair, float]
    step: float
    lost: Lost | None


def track(
    twin: Twin,
    gains: np.ndarray,
    recorded: Measured,
    start: tuple[np.ndarray, np.ndarray],
    change: FileChange,
) -> Tracked:
    """Simulate the twin along a recorded motion until it is lost; gains (n,): N*m or N per unit of control; start: qpos
    and qvel of the whole robot, in MuJoCo's coordinates.

    In every step the motor torques give the driven joints the required acceleration: the recorded one plus a correction
    towards the recorded state.
    """
    model, data = twin.model, twin.data
    time = recorded.time - recorded.time[0]
    interval = float(np.mean(np.diff(time)))
    substeps = int(np.ceil(interval / min(model.opt.timestep, LONGEST_STEP) - 1e-9))
    model.opt.timestep = interval / substeps
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_EULER
    model.opt.disableflags |= (
        mujoco.mjtDisableBit.mjDSBL_EULERDAMP
    )  # accelerations are then those of the state
    change.make(model)
    data.time = 0.0
    data.qpos[:], data.qvel[:] = start
    wanted = _between_samples(time, (recorded.position, recorded.velocity, recorded.acceleration), substeps)
    inertia = _ApparentInertia(twin)
    dofs, actuators = twin.dofs, twin.actuators
    renew = max(1, round(FRESH / model.opt.timestep))
    torque = np.zeros(len(gains))
    torques, positions = np.full((2, *recorded.position.shape), np.nan)
    opened, lost = 0.0, None
    pushed: defaultdict[tuple[int, int], float] = defaultdict(float)
    far = LOST * np.maximum(np.ptp(recorded.position, axis=0), np.finfo(float).tiny)
    frames_apart = max(1, round(FRAME / interval))
    frames = np.arange(0, len(time), frames_apart)
    poses = np.full((len(frames), model.nq), np.nan)
    for step in range(substeps * (len(time) - 1) + 1):
        mujoco.mj_step1(model, data)
        twin.apply_forces(torque / gains)
        _accelerate(model, data)
        if step % renew == 0:
            apparent = inertia.at(data)
        off, slow = wanted[0][step] - twin.positions, wanted[1][step] - twin.velocities
        asked = wanted[2][step] + STIFFNESS**2 * off + 2.0 * STIFFNESS * slow
        torque = torque + apparent @ (asked - data.qacc[dofs])
        data.ctrl[actuators] = torque / gains
        for index, pair in active_contacts(data):
            pushed[pair] += _normal_force(model, data, index)
        if step % substeps == 0:
            sample = step // substeps
            torques[sample], positions[sample] = torque, twin.positions
            opened = max(opened, float(np.abs(data.efc_pos[: data.ne]).max(initial=0.0)))
            if sample % frames_apart == 0:
                poses[sample // frames_apart] = data.qpos
            strayed = ~(np.abs(positions[sample] - recorded.position[sample]) < far)
            if strayed.any():
                lost = Lost(twin.joints[int(np.argmax(strayed))], float(time[sample]))
                break
        mujoco.mj_step2(model, data)
    touching: defaultdict[GeomPair, float] = defaultdict(float)
    for pair, force in pushed.items():
        touching[geom_pair(model, *pair)] += force * model.opt.timestep
    return Tracked(torques, positions, opened, frames, poses, touching, model.opt.timestep, lost)


def _normal_force(model: mujoco.MjModel, data: mujoco.MjData, contact: int) -> float:
    force = np.zeros(6)
    mujoco.mj_contactForce(model, data, contact, force)
    return float(force[0])


def _accelerate(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Accelerations under the present forces; positions and velocities are already evaluated."""
    mujoco.mj_fwdActuation(model, data)
    mujoco.mj_fwdAcceleration(model, data)
    mujoco.mj_fwdConstraint(model, data)


def _between_samples(time: np.ndarray, states: Sequence[np.ndarray], substeps: int) -> Sequence[np.ndarray]:
    """Position, velocity and acceleration at every step of the simulation."""
    if substeps == 1:
        return states
    fine = np.linspace(time[0], time[-1], substeps * (len(time) - 1) + 1)
    return [np.asarray(cubic_spline(time, values)(fine)) for values in states]


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
