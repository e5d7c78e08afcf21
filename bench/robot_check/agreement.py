"""Pinocchio and MuJoCo side by side: joints, body poses, masses, and the forces of motion."""

from collections.abc import Callable

import mujoco
import numpy as np
import pinocchio as pin

from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from bench.model.spin import idle_spins
from bench.model.supported import label_of
from bench.robot_check.machine import CheckedMachine, body_label, set_pose
from bench.robot_check.report import Check, count

TOLERANCE = 1e-10  # of the quantity's own size (at least 1, in its SI unit): two libraries, rounding only
KINDS = {
    "hinge": ("JointModelRX", "JointModelRY", "JointModelRZ", "JointModelRevoluteUnaligned"),
    "slide": ("JointModelPX", "JointModelPY", "JointModelPZ", "JointModelPrismaticUnaligned"),
    "ball": ("JointModelSpherical",),
    "free": ("JointModelFreeFlyer",),
}


def check_joint_list(machine: CheckedMachine) -> Check:
    """Every joint of the MJCF is in the model under its name, of its kind, on the body that MuJoCo says."""
    name = "joint tree"
    geometry, compiled = machine.geometry, machine.compiled
    if compiled.njnt != machine.model.njoints - 1:
        wrong = f"MuJoCo has {compiled.njnt} joints, Pinocchio {machine.model.njoints - 1}"
        return Check(name, "failed", wrong)
    for index in range(compiled.njnt):
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, index)
        own = mujoco.mjtJoint(int(compiled.jnt_type[index])).name.removeprefix("mjJNT_").lower()
        joint = machine.model.joints[index + 1]
        kind = joint.shortname()
        if machine.model.names[index + 1] != label:
            return Check(
                name, "failed", f"joint {label!r} is {machine.model.names[index + 1]!r} in Pinocchio"
            )
        if kind not in KINDS[own]:
            return Check(name, "failed", f"joint {label!r} is a {own}, in Pinocchio a {kind}")
        slices = (int(compiled.jnt_qposadr[index]), int(compiled.jnt_dofadr[index]))
        if slices != (joint.idx_q, joint.idx_v):
            return Check(name, "failed", f"joint {label!r} has other coordinates in Pinocchio")
        parent = _parent_joint(compiled, index)
        if machine.model.parents[index + 1] != parent + 1:
            return Check(name, "failed", f"joint {label!r} has another parent in Pinocchio")
    roots = sum(joint.parent < 0 for joint in geometry.joints)
    return Check(name, "ok", f"{count(compiled.njnt, 'joint')}, {roots} on the base, the same in both")


def check_joint_motion(machine: CheckedMachine, poses: np.ndarray) -> Check:
    """Place and axis of every joint at the configurations poses (N, nq), from both libraries' Jacobians."""
    name = "joint places and axes"
    compiled, model, data = machine.compiled, machine.model, machine.data
    linear, angular = np.empty((2, 3, machine.geometry.nv))
    frame = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    worst = np.zeros((compiled.njnt, 2))
    for q in poses:
        turn = set_pose(machine, q)
        pin.computeJointJacobians(model, data, q)
        for index, joint in enumerate(machine.geometry.joints):
            anchor = machine.state.xanchor[index]
            moved = anchor.copy()  # MuJoCo's anchor of a slide stays behind, Pinocchio's frame slides along
            if joint.kind == "slide":
                moved += machine.state.xaxis[index] * q[joint.q]
            placed = np.abs(moved - data.oMi[index + 1].translation).max()
            mujoco.mj_jac(compiled, machine.state, linear, angular, anchor, int(compiled.jnt_bodyid[index]))
            theirs = np.vstack((linear, angular))[:, joint.v]
            ours = (pin.getJointJacobian(model, data, index + 1, frame).reshape(6, -1) @ turn)[:, joint.v]
            worst[index] = np.maximum(worst[index], (placed, np.abs(ours - theirs).max()))
    return _verdict(
        name,
        worst.max(axis=1),
        lambda index: (
            f"joint {machine.geometry.joints[index].name!r}: place differs by {worst[index, 0]:.2e} m,"
            f" axis by {worst[index, 1]:.2e}"
        ),
        f"{count(compiled.njnt, 'joint')} at {len(poses)} poses",
    )


def check_body_poses(machine: CheckedMachine, poses: np.ndarray, what: str) -> Check:
    """Position and orientation of every body, fixed ones included, at the configurations poses (N, nq)."""
    worst = np.zeros(machine.compiled.nbody)
    for q in poses:
        set_pose(machine, q)
        pin.forwardKinematics(machine.model, machine.data, q)
        for body, (joint, place) in machine.places.items():
            frame = machine.data.oMi[joint + 1] * pin.SE3(place.rotation, place.translation)
            rotation = machine.state.xmat[body].reshape(3, 3)
            apart = np.abs(frame.translation - machine.state.xpos[body]).max()
            worst[body] = np.max((worst[body], apart, np.abs(frame.rotation - rotation).max()))
    return _verdict(
        f"body poses, {what}",
        worst,
        lambda body: f"body {body_label(machine.compiled, body)!r} stands elsewhere by {worst[body]:.2e}",
        f"bodies at {len(poses)} poses",
    )


def check_total_mass(machine: CheckedMachine) -> Check:
    """The mass of everything that moves."""
    moving = [body for body, (joint, _) in machine.places.items() if joint >= 0]
    theirs = float(machine.compiled.body_mass[moving].sum())
    ours = pin.computeTotalMass(machine.model)
    return _verdict(
        "total mass",
        np.array([abs(ours - theirs) / max(1.0, theirs)]),
        lambda _: f"{ours:.9g} kg in Pinocchio, {theirs:.9g} kg in MuJoCo",
        f"{theirs:.6g} kg that move",
    )


def check_mass_matrix(machine: CheckedMachine, poses: np.ndarray) -> Check:
    """Joint-space inertia matrix of the opened tree, rotor inertias included: all masses and inertias."""
    nv = machine.geometry.nv
    worst = np.zeros(nv)
    for q in poses:
        turn = set_pose(machine, q)
        theirs = np.zeros((nv, nv))
        mujoco.mj_fullM(machine.compiled, machine.state, theirs)
        upper = np.triu(pin.crba(machine.model, machine.data, q))
        ours = turn.T @ (upper + np.triu(upper, 1).T) @ turn
        worst = np.maximum(worst, np.abs(ours - theirs).max(axis=1) / max(1.0, np.abs(theirs).max()))
    return _verdict(
        "masses and inertias",
        worst,
        lambda v: (
            f"what joint {_joint_of(machine, v)!r} moves differs by {worst[v]:.2e} of the largest entry"
        ),
        f"mass matrices {nv} × {nv} at {len(poses)} poses",
    )


def check_bias_forces(machine: CheckedMachine, poses: np.ndarray, velocities: np.ndarray) -> Check:
    """Gravity, centrifugal and Coriolis forces at poses (N, nq) and velocities (N, nv)."""
    worst = np.zeros(machine.geometry.nv)
    for q, v in zip(poses, velocities, strict=True):
        turn = set_pose(machine, q, v)
        ours = turn.T @ pin.rnea(machine.model, machine.data, q, v, _model_acceleration(machine, v))
        theirs = machine.state.qfrc_bias
        worst = np.maximum(worst, np.abs(ours - theirs) / max(1.0, np.abs(theirs).max()))
    return _verdict(
        "gravity and Coriolis forces",
        worst,
        lambda v: f"joint {_joint_of(machine, v)!r} differs by {worst[v]:.2e} of the largest force",
        f"{count(machine.geometry.nv, 'force')} at {len(poses)} states",
    )


def check_motor_forces(machine: CheckedMachine, motion: Motion) -> Check:
    """Forces of the motors at closed states: regressor times masses and rotor inertias, against MuJoCo's dynamics.

    This is the whole identification model; MuJoCo's forces are projected by its own constraint Jacobian.
    """
    geometry, armature = machine.geometry, machine.compiled.dof_armature
    driven = np.concatenate((geometry.active, geometry.redundant))
    unknown = np.setdiff1d(geometry.passive, driven)  # rotors of which a note tells
    parameters = np.concatenate(
        [
            *(inertia.toDynamicParameters() for inertia in list(machine.model.inertias)[1:]),
            armature[driven],
        ]
    )
    ours = projected_regressor(geometry, motion, np.arange(len(parameters))) @ parameters
    theirs = np.empty_like(ours)
    full = np.zeros((geometry.nv, geometry.nv))
    for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
        turn = set_pose(machine, q, v)
        mujoco.mj_fullM(machine.compiled, machine.state, full)
        inertia = full.copy()
        inertia[unknown, unknown] -= armature[unknown]
        acceleration = turn.T @ (a - _model_acceleration(machine, v))
        theirs[k] = _motor_motions(machine).T @ (inertia @ acceleration + machine.state.qfrc_bias)
    worst = np.abs(ours - theirs).max(axis=0) / max(1.0, float(np.abs(theirs).max()))
    return _verdict(
        "motor forces",
        worst,
        lambda i: f"motor {geometry.robot.joints[i]!r} differs by {worst[i]:.2e} of the largest force",
        f"regressor and dynamics at {len(ours)} closed states",
    )


def _motor_motions(machine: CheckedMachine) -> np.ndarray:
    """MuJoCo's velocities (nv, n) for a unit velocity of each motor, from its own constraint Jacobian."""
    geometry, state = machine.geometry, machine.state
    active, passive = geometry.active, geometry.passive
    rows = state.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    jacobian = np.vstack((state.efc_J.reshape(-1, geometry.nv)[rows], _spin_rows(machine)))
    motions = np.zeros((geometry.nv, len(active)))
    motions[active, np.arange(len(active))] = 1.0
    if len(passive):
        motions[passive] = -np.linalg.lstsq(jacobian[:, passive], jacobian[:, active], rcond=None)[0]
    return motions


def _spin_rows(machine: CheckedMachine) -> np.ndarray:
    """Rates (spins, nv) at which rods turn about their own axes, by MuJoCo's velocities."""
    rows = []
    linear, angular = np.empty((2, 3, machine.geometry.nv))
    for spin in idle_spins(machine.geometry):
        body = int(machine.compiled.jnt_bodyid[spin.joint])
        mujoco.mj_jacBody(machine.compiled, machine.state, linear, angular, body)
        rows.append((machine.state.xmat[body].reshape(3, 3) @ spin.axis) @ angular)
    return np.array(rows).reshape(-1, machine.geometry.nv)


def _model_acceleration(machine: CheckedMachine, v: np.ndarray) -> np.ndarray:
    """The model's accelerations (nv,) when MuJoCo's are zero: T' qvel, from a free body's turning frame."""
    acceleration = np.zeros(machine.geometry.nv)
    for joint in machine.geometry.joints:
        if joint.kind == "free":
            linear = slice(joint.v.start, joint.v.start + 3)
            angular = v[joint.v.start + 3 : joint.v.stop]
            acceleration[linear] = -np.cross(angular, v[linear])
    return acceleration


def _joint_of(machine: CheckedMachine, v: int) -> str:
    return next(joint.name for joint in machine.geometry.joints if joint.v.start <= v < joint.v.stop)


def _parent_joint(compiled: mujoco.MjModel, joint: int) -> int:
    """The joint before this one on the way from the base; -1 for the base itself."""
    body = int(compiled.jnt_bodyid[joint])
    if joint > compiled.body_jntadr[body]:
        return joint - 1
    while body := int(compiled.body_parentid[body]):
        if compiled.body_jntnum[body]:
            return int(compiled.body_jntadr[body] + compiled.body_jntnum[body]) - 1
    return -1


def _verdict(name: str, worst: np.ndarray, culprit: Callable[[int], str], done: str) -> Check:
    """ok with what was done and the largest difference, or failed with the offender nearest to the base."""
    largest = float(worst.max(initial=0.0))
    if largest < TOLERANCE:
        return Check(name, "ok", f"{done} agree {f'to {largest:.0e}' if largest else 'exactly'}")
    return Check(name, "failed", culprit(int(np.argmin(worst < TOLERANCE))))
