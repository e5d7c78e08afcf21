"""A simulated motion without hidden effects, relative to which the sizes of effects are defined."""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.truth.hidden.base import JointMovement
from bench.truth.inverse import motor_torque
from bench.truth.simulate import Simulation

Array = NDArray[np.float64]
SAMPLES = 40  # number of samples of each recording at which torques are compared


@dataclass(frozen=True, eq=False)
class ReferenceSamples:
    """Some samples (S,) of one recording; torque (S, n): torques of the motors at these samples."""

    payload: str | None
    rows: NDArray[np.signedinteger]
    """Of the recording."""
    first: int
    """Row of the recording's first sample in the concatenation of all recordings."""
    pose: Array
    q: Array
    qd: Array
    qdd: Array
    torque: Array


@dataclass(frozen=True, eq=False)
class Reference:
    """A simulation without hidden effects."""

    simulation: Simulation

    def __post_init__(self) -> None:
        if self.simulation.machine.hidden:
            names = {effect.name for effect in self.simulation.machine.hidden}
            raise BenchError(f"a reference has no hidden effects, this one has {', '.join(sorted(names))}")

    @cached_property
    def samples(self) -> tuple[ReferenceSamples, ...]:
        """Samples of every recording, as the baseline for the changes by effects."""
        machine = self.simulation.machine
        m = machine.leading
        collected, first = [], 0
        for recording in self.simulation.recordings:
            motion, payload = recording.motion, recording.table.payload
            rows = np.linspace(0, len(motion.time) - 1, SAMPLES + 2).astype(int)[1:-1]
            pose = motion.qpos[rows]
            q = pose[:, machine.addresses[:m]]
            qd, qdd = motion.qvel[rows][:, machine.dofs[:m]], motion.qacc[rows][:, machine.dofs[:m]]
            torque = motor_torque(machine, payload, pose, q, qd, qdd)
            collected.append(ReferenceSamples(payload, rows, first, pose, q, qd, qdd, torque))
            first += len(motion.time)
        return tuple(collected)

    def torque(self) -> Array:
        """Torques (N, n) of the motors, all recordings concatenated."""
        return np.concatenate([recording.motion.torque for recording in self.simulation.recordings])

    def movement(self, joint: str) -> JointMovement:
        """The motion of an actuated joint and its motor; BenchError for any other joint."""
        machine = self.simulation.machine
        if joint not in machine.robot.driven:
            raise BenchError(f"no actuated joint {joint!r}; there are {', '.join(machine.robot.driven)}")
        i = machine.robot.driven.index(joint)
        model, dof = machine.models[None], machine.dofs[i]
        recordings = self.simulation.recordings

        def joined(values: list[Array]) -> Array:
            return np.concatenate(values)

        def rate(values: list[Array]) -> list[Array]:
            period = self.simulation.scenario.log_period
            return [np.gradient(value, period) for value in values]

        torque = [r.motion.torque[:, i] for r in recordings]
        current = [r.current[:, i] for r in recordings]
        slide = model.jnt_type[model.dof_jntid[dof]] == int(mujoco.mjtJoint.mjJNT_SLIDE)
        return JointMovement(
            joint=joint,
            slide=bool(slide),
            time=joined([r.motion.time for r in recordings]),
            period=self.simulation.scenario.log_period,
            position=joined([r.motion.qpos[:, machine.addresses[i]] for r in recordings]),
            velocity=joined([r.motion.qvel[:, dof] for r in recordings]),
            acceleration=joined([r.motion.qacc[:, dof] for r in recordings]),
            torque=joined(torque),
            torque_rate=joined(rate(torque)),
            torque_bend=joined(rate(rate(torque))),
            current=joined(current),
            current_rate=joined(rate(current)),
            other_torques=joined([r.motion.torque.sum(axis=1) - r.motion.torque[:, i] for r in recordings]),
            inertia=float(machine.inertia[i]),
            armature=float(model.dof_armature[dof]),
            stiffness=float(machine.drive.kp[i]),
            damping=float(machine.drive.kv[i]),
        )
