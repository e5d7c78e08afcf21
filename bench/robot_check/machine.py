"""The robot as MuJoCo reads it, masses included, and the conversion between its coordinates and the model's."""

from dataclasses import dataclass

import mujoco
import numpy as np
import pinocchio as pin

from bench.model.follow import build_tree
from bench.model.geometry import Geometry, Placement, rotation_matrix, to_mujoco
from bench.model.supported import label_of
from bench.robot_check.bounds import AGREEMENT


@dataclass(frozen=True)
class CheckedMachine:
    """Both libraries' models of one robot; `state` and `data` are scratch space."""

    geometry: Geometry
    compiled: mujoco.MjModel
    state: mujoco.MjData
    model: pin.Model
    """The opened tree, with the masses of the MJCF, which only the check reads."""
    data: pin.Data
    places: dict[int, tuple[int, Placement]]
    """By MuJoCo body: the model's joint that carries it (-1: the world), its placement in that joint's frame."""


def make_machine(geometry: Geometry) -> CheckedMachine:
    """Both libraries' models: the MJCF with dense constraint rows of its equalities only, and the model's tree with
    the masses of the MJCF.
    """
    compiled = geometry.robot.mjcf_model()
    compiled.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    for flag in ("CONTACT", "LIMIT", "FRICTIONLOSS"):
        compiled.opt.disableflags |= int(getattr(mujoco.mjtDisableBit, f"mjDSBL_{flag}"))
    model = build_tree(geometry)
    places = {body: geometry.body_frames[body_label(compiled, body)] for body in range(compiled.nbody)}
    for body, (joint, place) in places.items():
        if joint >= 0:
            frame = pin.SE3(place.rotation, place.translation)
            model.appendBodyToJoint(joint + 1, _inertia(compiled, body), frame)
    model.armature = compiled.dof_armature.copy()
    return CheckedMachine(geometry, compiled, mujoco.MjData(compiled), model, model.createData(), places)


def set_pose(machine: CheckedMachine, q: np.ndarray, v: np.ndarray | None = None) -> np.ndarray:
    """Set MuJoCo to the model's state q (nq,), v (nv,), evaluate it, and return T (nv, nv): v = T qvel.

    A free joint's linear velocity is in its frame in Pinocchio, and in world axes in MuJoCo.
    """
    turn = put_state(machine, q, v)
    mujoco.mj_fwdPosition(machine.compiled, machine.state)
    mujoco.mj_fwdVelocity(machine.compiled, machine.state)
    return turn


def put_state(machine: CheckedMachine, q: np.ndarray, v: np.ndarray | None) -> np.ndarray:
    """As `set_pose`, without evaluating it."""
    state, geometry = machine.state, machine.geometry
    state.qpos[:] = to_mujoco(geometry.joints, q[None])[0]
    turn = np.eye(geometry.nv)
    for joint in geometry.joints:
        if joint.kind == "free":
            linear = slice(joint.v.start, joint.v.start + 3)
            turn[linear, linear] = rotation_matrix(state.qpos[joint.q.start + 3 : joint.q.stop]).T
    state.qvel[:] = 0.0 if v is None else turn.T @ v
    return turn


def random_open_poses(geometry: Geometry, count: int, seed: int) -> np.ndarray:
    """Random configurations (count, nq) of the opened tree, ignoring loops."""
    random = np.random.default_rng(seed)
    q = np.empty((count, geometry.nq))
    for joint in geometry.joints:
        reach = np.pi if joint.kind == "hinge" else AGREEMENT.travel
        q[:, joint.q] = random.uniform(-reach, reach, size=(count, joint.q.stop - joint.q.start))
        if joint.kind in ("ball", "free"):
            quaternion = random.normal(size=(count, 4))
            quaternion /= np.linalg.norm(quaternion, axis=1)[:, None]
            q[:, joint.q.stop - 4 : joint.q.stop] = quaternion
    return q


def body_label(compiled: mujoco.MjModel, body: int) -> str:
    """The name of a body."""
    return label_of(compiled, mujoco.mjtObj.mjOBJ_BODY, body)


def _inertia(compiled: mujoco.MjModel, body: int) -> pin.Inertia:
    axes = rotation_matrix(compiled.body_iquat[body])
    inertia = axes @ np.diag(compiled.body_inertia[body]) @ axes.T
    return pin.Inertia(float(compiled.body_mass[body]), compiled.body_ipos[body].copy(), inertia)
