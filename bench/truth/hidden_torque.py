"""What the hidden effects of a simulated machine ask of its motors."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.truth.inverse import motor_torque, powers
from bench.truth.loops import loop_gaps
from bench.truth.machine import Machine, build_machine
from bench.truth.simulate import SimulatedRecording, Simulation

Array = NDArray[np.float64]
RATE = 100.0  # Hz: poses a second at which the torque is computed


@dataclass(frozen=True, eq=False)
class HiddenTorque:
    """What only a simulation can tell of one recording, S samples.

    time (S,) s; torque (S, n) N·m or N: what the motors supply beyond the same movement of the rigid robot;
    loop_gap (S, loops) m: how far the loops really open; reference (S, n) rad or m: what the controller was asked
    to follow. What redundant motors give counts by its power at the others.
    """

    time: Array
    torque: Array
    loop_gap: Array
    reference: Array


def plain_machine(simulation: Simulation) -> Machine:
    """The machine of a simulation with nothing hidden."""
    settings = simulation.scenario.settings.model_copy(update={"hidden": ()})
    return build_machine(replace(simulation.scenario, settings=settings))


def hidden_torque(simulation: Simulation, recording: SimulatedRecording, plain: Machine) -> HiddenTorque:
    """True gain times current, less the torque of the same movement of the machine with nothing hidden.

    The movement is that of the encoders: a spring or play in a drive, a wrong zero and a wrong length count as
    hidden torque, as a rigid model sees them. plain: see `plain_machine`.
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
