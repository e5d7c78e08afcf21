"""Inverse dynamics: torques of the motors for a given motion of their joints, loops closed."""

from dataclasses import dataclass, replace

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.truth.assembly import close_loops, followed, following, loop_rows
from bench.truth.balls import directions
from bench.truth.loops import loop_gaps
from bench.truth.machine import Machine, build_machine
from bench.truth.simulate import SimulatedRecording, Simulation

Array = NDArray[np.float64]
NUDGE = 1e-5  # s: time step of the numerical derivative of the loop Jacobian


def motor_torque(
    machine: Machine, payload: str | None, poses: Array, q: Array, qd: Array, qdd: Array
) -> Array:
    """Torque (S, n) for positions, velocities and accelerations (S, n) of the actuated joints that move independently.

    poses: (S, nq) from which the loops are closed, each near that of its sample, so that the assembly mode is kept.
    Included are inertia, weight, MuJoCo's damping, springs and dry friction in sliding, and actuators other than the
    motors; not included are laws of hidden effects, and springs and play in drives.
    Raises BenchError if the loops do not close.
    """
    model = machine.models[payload]
    data = mujoco.MjData(model)
    dofs, addresses = machine.dofs[: machine.leading], machine.addresses[: machine.leading]
    passive = np.setdiff1d(np.arange(model.nv), dofs)
    mass = np.zeros((model.nv, model.nv))
    torque = np.empty_like(q)
    for k, pose in enumerate(poses):
        data.qpos[:] = pose
        data.qpos[addresses] = q[k]
        jacobian = close_loops(model, data, passive)
        follow = followed(jacobian, dofs, passive)
        velocity = follow @ qd[k]
        acceleration = follow @ qdd[k]
        acceleration[passive] += _bent(model, data, jacobian[:, passive], velocity)
        data.qvel[:] = velocity
        mujoco.mj_fwdPosition(model, data)
        mujoco.mj_fwdVelocity(model, data)
        mujoco.mj_fwdActuation(model, data)
        mujoco.mj_fullM(model, data, mass)
        given = data.qfrc_actuator.copy()
        given[machine.motor_dofs] -= data.actuator_force[: len(machine.dofs)]
        force = mass @ acceleration + data.qfrc_bias - data.qfrc_passive - given
        force += model.dof_frictionloss * directions(model, velocity)
        torque[k] = follow.T @ force
    return torque


def powers(machine: Machine, payload: str | None, poses: Array, torque: Array) -> Array:
    """Torques (S, n) at the independent joints with the same power as the torques (S, N) of all motors.

    poses: (S, nq). Without redundant motors these are the torques themselves.
    """
    m = machine.leading
    if torque.shape[1] == m:
        return torque
    model, result = machine.models[payload], torque[:, :m].copy()
    data = mujoco.MjData(model)
    for k, pose in enumerate(poses):
        data.qpos[:] = pose
        result[k] += following(model, data, machine.dofs[:m])[machine.dofs[m:]].T @ torque[k, m:]
    return result


def _bent(model: mujoco.MjModel, data: mujoco.MjData, held: Array, velocity: Array) -> Array:
    """Accelerations of the passive joints that keep the loops closed at constant velocity of the others.

    held: columns (m, passive) of the loop Jacobian.
    """
    start = data.qpos.copy()
    ends = []
    for time in (-NUDGE, NUDGE):
        qpos = start.copy()
        mujoco.mj_integratePos(model, qpos, velocity, time)
        data.qpos[:] = qpos
        ends.append(loop_rows(model, data)[1] @ velocity)
    data.qpos[:] = start
    change = (ends[1] - ends[0]) / (2 * NUDGE)
    return np.asarray(-np.linalg.lstsq(held, change, rcond=None)[0], dtype=np.float64)


RATE = 100.0  # Hz: rate of the poses at which the torque is computed


@dataclass(frozen=True, eq=False)
class HiddenTorque:
    """True signals of one simulated recording, S samples.

    time (S,) s; torque (S, n) N·m or N: torque of the motors beyond that of the rigid robot in the same motion;
    loop_gap (S, loops) m: true gaps of the loops; reference (S, n) rad or m: the controller's reference. Torques of
    redundant motors are converted to the independent joints by equal power.
    """

    time: Array
    torque: Array
    loop_gap: Array
    reference: Array


def plain_machine(simulation: Simulation) -> Machine:
    """The machine of a simulation without hidden effects."""
    settings = simulation.scenario.settings.model_copy(update={"hidden": ()})
    return build_machine(replace(simulation.scenario, settings=settings))


def hidden_torque(simulation: Simulation, recording: SimulatedRecording, plain: Machine) -> HiddenTorque:
    """True gain times current minus the torque of the same motion without hidden effects.

    The motion is that of the encoders, so a spring or play in a drive, a wrong zero and a wrong length appear as
    hidden torque, as they do to a rigid model. plain: see `plain_machine`.
    """
    machine, motion = simulation.machine, recording.motion
    rate = (len(motion.time) - 1) / (motion.time[-1] - motion.time[0])
    shown = slice(0, None, max(1, round(rate / RATE)))
    payload, m = recording.table.payload, machine.leading
    poses = motion.qpos[shown]
    rigid = motor_torque(
        plain,
        payload,
        poses[:, : len(plain.home)],  # the rotors of drives with a spring or play come last
        recording.position[shown, :m],
        motion.qvel[shown][:, machine.motor_dofs[:m]],
        motion.qacc[shown][:, machine.motor_dofs[:m]],
    )
    given = powers(
        plain, payload, poses[:, : len(plain.home)], machine.drive.true_gains * recording.current[shown]
    )
    return HiddenTorque(
        time=motion.time[shown],
        torque=given - rigid,
        loop_gap=loop_gaps(machine.models[payload], poses),
        reference=motion.reference[shown, :m],
    )
