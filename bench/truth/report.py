"""The truth about a simulation, as plain data for truth.json: what a perfect identification would estimate."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from bench.basics.versions import versions
from bench.dataset.payload import Payload
from bench.dataset.robot_locked import locked_as_data
from bench.truth.hidden.base import MOTOR_SIDE, PAYLOAD_BODY
from bench.truth.machine import Machine
from bench.truth.simulate import SimulatedRecording, Simulation

Array = NDArray[np.float64]


def truth(simulation: Simulation) -> dict[str, Any]:
    """The true values of the machine, its payloads and its sensors; SI units, inertias in kg·m².

    The same scenario gives the same data, to the last bit. An inertia is Ixx Iyy Izz Ixy Ixz Iyz at the
    centre of mass, in the axes of the body.
    """
    scenario, machine = simulation.scenario, simulation.machine
    settings = scenario.settings
    suffix = settings.file_format
    return {
        "scenario": scenario.name,
        "robot": scenario.robot_reference,
        "seed": settings.seed,
        "locked": locked_as_data(machine.robot.locked),
        "drive_gains": _drive_gains(machine),
        "bodies": _bodies(machine.models[None]),
        "joints": _joints(machine.models[None]),
        "payloads": {
            name: table.model_dump(mode="json") | _weight(machine.payloads[name])
            for name, table in settings.payloads.items()
        },
        "hidden": [{"effect": effect.name, **asdict(effect)} for effect in machine.hidden],
        "loop_gap": simulation.loop_gap,
        "recordings": {
            f"{recording.name}.{suffix}": _recording(recording, machine.robot.driven)
            for recording in simulation.recordings
        },
        "settings": settings.model_dump(mode="json", exclude_none=True),
        "versions": versions().named(),
    }


def _drive_gains(machine: Machine) -> dict[str, Any]:
    drive = machine.drive
    return {
        actuator.joint: {
            "true": float(drive.true_gains[i]),
            "nominal": actuator.gain,
            "unit": actuator.gain_unit,
            "kp": float(drive.kp[i]),
            "kv": float(drive.kv[i]),
        }
        for i, actuator in enumerate(machine.robot.motors)
    }


def _weight(payload: Payload) -> dict[str, Any]:
    """The true mass and inertia, which a hidden effect may have changed."""
    inertia = np.zeros(6) if payload.inertia is None else payload.inertia
    return {"mass": payload.mass, "inertia": inertia.tolist()}


def _bodies(model: mujoco.MjModel) -> dict[str, Any]:
    bodies = {}
    for i in range(1, model.nbody):
        name = model.body(i).name or f"body {i}"
        if name == PAYLOAD_BODY or name.startswith(MOTOR_SIDE):
            continue
        axes = np.zeros(9)
        mujoco.mju_quat2Mat(axes, model.body_iquat[i])
        rotation = axes.reshape(3, 3)
        inertia = rotation @ np.diag(model.body_inertia[i]) @ rotation.T
        bodies[name] = {
            "mass": float(model.body_mass[i]),
            "center_of_mass": model.body_ipos[i].tolist(),
            "inertia": inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].tolist(),
        }
    return bodies


def _joints(model: mujoco.MjModel) -> dict[str, Any]:
    joints = {}
    for i in range(model.njnt):
        dof = model.jnt_dofadr[i]
        joints[model.joint(i).name or f"joint {i}"] = {
            "armature": float(model.dof_armature[dof]),
            "damping": np.ravel(model.dof_damping[dof]).tolist(),
            "frictionloss": float(model.dof_frictionloss[dof]),
            "stiffness": np.ravel(model.jnt_stiffness[i]).tolist(),
        }
    return joints


def _recording(recording: SimulatedRecording, joints: Sequence[str]) -> dict[str, Any]:
    log = recording.log

    def by_joint(values: Array) -> dict[str, float]:
        return dict(zip(joints, values.tolist(), strict=True))

    return {
        "use": recording.table.use,
        "payload": recording.table.payload,
        "trajectory": recording.trajectory.to_dict(),
        "loop_gap": recording.loop_gap,
        "position_noise": by_joint(log.position_noise),
        "position_error": by_joint(log.position_error),
        "current_noise": by_joint(log.current_noise),
        "current_error": by_joint(log.current_error),
        "current_rms": by_joint(np.sqrt(np.mean(recording.current**2, axis=0))),
    }
