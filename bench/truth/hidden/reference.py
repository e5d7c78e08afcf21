"""A movement without hidden effects, against which the size of an effect is measured."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.errors import BenchError
from bench.truth.hidden.movement import JointMovement
from bench.truth.simulate import Simulation

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Reference:
    """A simulation without hidden effects."""

    simulation: Simulation

    def __post_init__(self) -> None:
        if self.simulation.machine.hidden:
            names = {effect.name for effect in self.simulation.machine.hidden}
            raise BenchError(f"a reference has no hidden effects, this one has {', '.join(sorted(names))}")

    def torque(self) -> Array:
        """(N, n) of the motors, all recordings one after the other."""
        return np.concatenate([recording.motion.torque for recording in self.simulation.recordings])

    def movement(self, joint: str) -> JointMovement:
        """What an actuated joint and its motor do; BenchError for any other joint."""
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
