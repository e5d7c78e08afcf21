"""Pinocchio compared with MuJoCo: joints, body poses, masses, and the forces of motion."""

import copy
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any, Literal

import mujoco
import numpy as np
import pinocchio as pin

from bench.model.base import BaseParameters
from bench.model.bounds import RANKS
from bench.model.cures import driven_parts
from bench.model.mobility import conditioning
from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from bench.model.spin import idle_spins
from bench.model.supported import label_of
from bench.robot_check.bounds import AGREEMENT
from bench.robot_check.machine import CheckedMachine, body_label, put_state, set_pose
from bench.robot_check.outcome import Check, CheckCode

KINDS = {
    "hinge": ("JointModelRX", "JointModelRY", "JointModelRZ", "JointModelRevoluteUnaligned"),
    "slide": ("JointModelPX", "JointModelPY", "JointModelPZ", "JointModelPrismaticUnaligned"),
    "ball": ("JointModelSpherical",),
    "free": ("JointModelFreeFlyer",),
}


def check_joint_list(machine: CheckedMachine) -> Check:
    """Every joint of the MJCF is in the model, with the same name, kind, coordinates and parent joint."""
    geometry, compiled = machine.geometry, machine.compiled
    if compiled.njnt != machine.model.njoints - 1:
        counts = {"mujoco": int(compiled.njnt), "pinocchio": machine.model.njoints - 1}
        return Check(CheckCode.JOINT_COUNTS_DIFFER, "failed", counts)
    for index in range(compiled.njnt):
        label = label_of(compiled, mujoco.mjtObj.mjOBJ_JOINT, index)
        mujoco_kind = mujoco.mjtJoint(int(compiled.jnt_type[index])).name.removeprefix("mjJNT_").lower()
        joint = machine.model.joints[index + 1]
        kind = joint.shortname()
        if machine.model.names[index + 1] != label:
            names = {"mujoco": label, "pinocchio": machine.model.names[index + 1]}
            return Check(CheckCode.JOINT_NAMES_DIFFER, "failed", names)
        if kind not in KINDS[mujoco_kind]:
            kinds = {"joint": label, "mujoco": mujoco_kind, "pinocchio": kind}
            return Check(CheckCode.JOINT_KINDS_DIFFER, "failed", kinds)
        slices = (int(compiled.jnt_qposadr[index]), int(compiled.jnt_dofadr[index]))
        if slices != (joint.idx_q, joint.idx_v):
            return Check(CheckCode.JOINT_COORDINATES_DIFFER, "failed", {"joint": label})
        before = int(compiled.dof_parentid[compiled.jnt_dofadr[index]])  # the velocity before; -1 at the base
        if machine.model.parents[index + 1] != (0 if before < 0 else int(compiled.dof_jntid[before]) + 1):
            return Check(CheckCode.JOINT_PARENTS_DIFFER, "failed", {"joint": label})
    roots = sum(joint.parent < 0 for joint in geometry.joints)
    return Check(CheckCode.JOINT_TREES_AGREE, "ok", {"joints": int(compiled.njnt), "roots": roots})


def check_joint_motion(machine: CheckedMachine, poses: np.ndarray) -> Check:
    """Place and axis of every joint at the configurations poses (N, nq), from both libraries' Jacobians."""
    compiled, model, data = machine.compiled, machine.model, machine.data
    linear, angular = np.empty((2, 3, machine.geometry.nv))
    frame = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
    worst = np.zeros((compiled.njnt, 2))
    for q in poses:
        turn = set_pose(machine, q)
        pin.computeJointJacobians(model, data, q)
        for index, joint in enumerate(machine.geometry.joints):
            anchor = machine.state.xanchor[index]
            moved = anchor.copy()  # MuJoCo's anchor of a slide is fixed, Pinocchio's frame moves along
            if joint.kind == "slide":
                moved += machine.state.xaxis[index] * q[joint.q]
            placed = np.abs(moved - data.oMi[index + 1].translation).max()
            mujoco.mj_jac(compiled, machine.state, linear, angular, anchor, int(compiled.jnt_bodyid[index]))
            theirs = np.vstack((linear, angular))[:, joint.v]
            ours = (pin.getJointJacobian(model, data, index + 1, frame).reshape(6, -1) @ turn)[:, joint.v]
            worst[index] = np.maximum(worst[index], (placed, np.abs(ours - theirs).max()))
    return _compared(
        worst.max(axis=1),
        (CheckCode.JOINT_AXES_AGREE, {"joints": int(compiled.njnt), "poses": len(poses)}),
        CheckCode.JOINT_AXES_DIFFER,
        lambda index: {
            "joint": machine.geometry.joints[index].name,
            "place": float(worst[index, 0]),
            "axis": float(worst[index, 1]),
        },
    )


def check_body_poses(machine: CheckedMachine, poses: np.ndarray, tree: Literal["opened", "closed"]) -> Check:
    """Position and orientation of every body, including fixed ones, at the configurations poses (N, nq)."""
    worst = np.zeros(machine.compiled.nbody)
    for q in poses:
        set_pose(machine, q)
        pin.forwardKinematics(machine.model, machine.data, q)
        for body, (joint, place) in machine.places.items():
            frame = machine.data.oMi[joint + 1] * pin.SE3(place.rotation, place.translation)
            rotation = machine.state.xmat[body].reshape(3, 3)
            apart = np.abs(frame.translation - machine.state.xpos[body]).max()
            worst[body] = np.max((worst[body], apart, np.abs(frame.rotation - rotation).max()))
    return _compared(
        worst,
        (CheckCode.BODY_POSES_AGREE, {"tree": tree, "poses": len(poses)}),
        CheckCode.BODY_POSES_DIFFER,
        lambda body: {
            "tree": tree,
            "body": body_label(machine.compiled, body),
            "difference": float(worst[body]),
        },
    )


def check_total_mass(machine: CheckedMachine) -> Check:
    """The total mass of all moving bodies."""
    moving = [body for body, (joint, _) in machine.places.items() if joint >= 0]
    theirs = float(machine.compiled.body_mass[moving].sum())
    ours = pin.computeTotalMass(machine.model)
    return _compared(
        np.array([abs(ours - theirs) / max(1.0, theirs)]),
        (CheckCode.TOTAL_MASSES_AGREE, {"mass": theirs}),
        CheckCode.TOTAL_MASSES_DIFFER,
        lambda _: {"pinocchio": float(ours), "mujoco": theirs},
    )


def check_mass_matrix(machine: CheckedMachine, poses: np.ndarray) -> Check:
    """Joint-space inertia matrix of the opened tree, rotor inertias included, at the configurations poses (N, nq)."""
    nv = machine.geometry.nv
    worst = np.zeros(nv)
    for q in poses:
        turn = set_pose(machine, q)
        theirs = np.zeros((nv, nv))
        mujoco.mj_fullM(machine.compiled, machine.state, theirs)
        upper = np.triu(pin.crba(machine.model, machine.data, q))
        ours = turn.T @ (upper + np.triu(upper, 1).T) @ turn
        worst = np.maximum(worst, np.abs(ours - theirs).max(axis=1) / max(1.0, np.abs(theirs).max()))
    return _compared(
        worst,
        (CheckCode.MASS_MATRICES_AGREE, {"size": nv, "poses": len(poses)}),
        CheckCode.MASS_MATRICES_DIFFER,
        lambda v: {"joint": machine.geometry.joint_at(v).name, "difference": float(worst[v])},
    )


def check_bias_forces(machine: CheckedMachine, poses: np.ndarray, velocities: np.ndarray) -> Check:
    """Gravity, centrifugal and Coriolis forces at poses (N, nq) and velocities (N, nv)."""
    worst = np.zeros(machine.geometry.nv)
    for q, v in zip(poses, velocities, strict=True):
        turn = set_pose(machine, q, v)
        ours = turn.T @ pin.rnea(machine.model, machine.data, q, v, model_acceleration(machine, v))
        theirs = machine.state.qfrc_bias
        worst = np.maximum(worst, np.abs(ours - theirs) / max(1.0, np.abs(theirs).max()))
    return _compared(
        worst,
        (CheckCode.BIAS_FORCES_AGREE, {"forces": machine.geometry.nv, "states": len(poses)}),
        CheckCode.BIAS_FORCES_DIFFER,
        lambda v: {"joint": machine.geometry.joint_at(v).name, "difference": float(worst[v])},
    )


def check_motor_forces(machine: CheckedMachine, motion: Motion) -> Check:
    """Motor forces at closed states: regressor times masses and rotor inertias, against MuJoCo's dynamics.

    This tests the whole identification model. MuJoCo's forces are projected by its constraint Jacobian. Rounding grows
    with the conditioning of the closures, so the bound does too.
    """
    geometry, armature = machine.geometry, machine.compiled.dof_armature
    driven = np.concatenate((geometry.active, geometry.redundant))
    unknown = np.setdiff1d(geometry.passive, driven)  # their rotors are not modelled, which a note reports
    parameters = np.concatenate(
        [*(inertia.toDynamicParameters() for inertia in list(machine.model.inertias)[1:]), armature[driven]]
    )
    ours = projected_regressor(geometry, motion, np.arange(len(parameters))) @ parameters
    theirs = np.empty_like(ours)
    full = np.zeros((geometry.nv, geometry.nv))
    for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
        turn = set_pose(machine, q, v)
        mujoco.mj_fullM(machine.compiled, machine.state, full)
        inertia = full.copy()
        inertia[unknown, unknown] -= armature[unknown]
        acceleration = turn.T @ (a - model_acceleration(machine, v))
        theirs[k] = motor_motions(machine).T @ (inertia @ acceleration + machine.state.qfrc_bias)
    worst = np.abs(ours - theirs).max(axis=0) / max(1.0, float(np.abs(theirs).max()))
    return _compared(
        worst,
        (CheckCode.MOTOR_FORCES_AGREE, {"states": len(ours)}),
        CheckCode.MOTOR_FORCES_DIFFER,
        lambda i: {"motor": geometry.robot.joints[i], "difference": float(worst[i])},
        AGREEMENT.rounding * conditioning(geometry, motion.q),
    )


def motor_motions(machine: CheckedMachine) -> np.ndarray:
    """MuJoCo's velocities (nv, n) for a unit velocity of each motor, from its constraint Jacobian."""
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
    """Rows (spins, nv) that give the spin rate of each rod about its axis from MuJoCo's velocities."""
    rows = []
    linear, angular = np.empty((2, 3, machine.geometry.nv))
    for spin in idle_spins(machine.geometry):
        body = int(machine.compiled.jnt_bodyid[spin.joint])
        mujoco.mj_jacBody(machine.compiled, machine.state, linear, angular, body)
        rows.append((machine.state.xmat[body].reshape(3, 3) @ spin.axis) @ angular)
    return np.array(rows).reshape(-1, machine.geometry.nv)


def model_acceleration(machine: CheckedMachine, v: np.ndarray) -> np.ndarray:
    """The model's accelerations (nv,) when MuJoCo's are zero: dT/dt qvel, as the frame of a free body rotates."""
    acceleration = np.zeros(machine.geometry.nv)
    for joint in machine.geometry.joints:
        if joint.kind == "free":
            linear = slice(joint.v.start, joint.v.start + 3)
            angular = v[joint.v.start + 3 : joint.v.stop]
            acceleration[linear] = -np.cross(angular, v[linear])
    return acceleration


def _compared(
    worst: np.ndarray,
    agreed: tuple[CheckCode, dict[str, Any]],
    differs: CheckCode,
    offender: Callable[[int], dict[str, Any]],
    tolerance: float = AGREEMENT.rounding,
) -> Check:
    """`ok` with what was compared and the largest difference, or `failed` with the offender nearest to the base."""
    largest = float(worst.max(initial=0.0))
    if largest < tolerance:
        code, done = agreed
        return Check(code, "ok", {**done, "difference": largest})
    return Check(differs, "failed", offender(int(np.argmin(worst < tolerance))))


SEED = 20120604  # of masses and inertias


def check_base_parameters(machine: CheckedMachine, base: BaseParameters, motion: Motion) -> Check:
    """Motor torques at the closed states of `motion`: MuJoCo's inverse dynamics against the base parameters.

    Computed for one body at a time, with random mass, centre of mass and inertia, and for the rotors, everything else
    massless. A body that the closures fix, such as a base welded to the world, causes no torque but rounding. The bound
    allows for what the base parameters neglect because of closure errors in the drawing.
    """
    regressor = projected_regressor(machine.geometry, motion, base.columns)
    allowed = max(AGREEMENT.closed, RANKS.gap * base.neglected)
    worst, differing = 0.0, []
    for label, standard, rotors, theirs, in_tree in motion_with_torques(machine, motion):
        ours = regressor @ (base.grouping @ standard + base.rotors @ rotors)
        largest = max(float(np.abs(theirs).max()), AGREEMENT.unfelt * in_tree)
        difference = float(np.abs(ours - theirs).max()) / largest if largest else 0.0
        worst = max(worst, difference)
        if not difference < allowed:
            differing.append(label)
    values: dict[str, Any] = {"parameters": len(base.columns), "difference": worst}
    if differing:
        values |= {"bodies": differing, "motors": driven_parts(machine.geometry.robot)}
        return Check(CheckCode.BASE_PARAMETERS_DIFFER, "failed", values)
    values |= {"states": len(motion.time), "neglected": base.neglected}
    return Check(CheckCode.BASE_PARAMETERS_AGREE, "ok", values)


def motion_with_torques(
    machine: CheckedMachine, motion: Motion
) -> Iterator[tuple[str, np.ndarray, np.ndarray, np.ndarray, float]]:
    """For each body, then for all rotors: its name, standard parameters (10 joints,), rotor inertias (driven joints,),
    MuJoCo's motor torques (N, n), and the largest force or torque in a joint of the opened tree.
    """
    geometry = machine.geometry
    driven = np.concatenate((geometry.active, geometry.redundant))
    motions = []
    for q, v in zip(motion.q, motion.v, strict=True):
        set_pose(machine, q, v)
        motions.append(motor_motions(machine))
    compiled = copy.copy(machine.compiled)
    compiled.body_sameframe[:] = compiled.body_simple[:] = (
        0  # shortcuts valid only for the file's centres of mass
    )
    compiled.body_mass[:] = compiled.body_inertia[:] = 0.0
    light = replace(machine, compiled=compiled, state=mujoco.MjData(compiled))
    random = np.random.default_rng(SEED)
    nothing = np.zeros(10 * len(geometry.joints))
    for body, (joint, place) in machine.places.items():
        if joint < 0 or geometry.joints[joint].body is None:
            continue
        inertia = _random_inertia(random)
        moments, axes = np.linalg.eigh(inertia.inertia)
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, (axes * np.linalg.det(axes)).ravel())
        compiled.body_mass[body], compiled.body_ipos[body] = inertia.mass, inertia.lever
        compiled.body_inertia[body], compiled.body_iquat[body] = moments, quaternion
        standard = nothing.copy()
        standard[10 * joint : 10 * joint + 10] = inertia.se3Action(
            pin.SE3(place.rotation, place.translation)
        ).toDynamicParameters()
        torques, in_tree = _torques(light, motion, motions)
        yield body_label(machine.compiled, body), standard, np.zeros(len(driven)), torques, in_tree
        compiled.body_mass[body], compiled.body_inertia[body] = 0.0, 0.0
    rotors = random.uniform(0.5, 2.0, size=len(driven))
    inertias = np.zeros(geometry.nv)
    inertias[driven] = rotors
    torques = np.array([to_motors.T @ (inertias * a) for to_motors, a in zip(motions, motion.a, strict=True)])
    yield "the rotors", nothing, rotors, torques, 0.0


def _torques(machine: CheckedMachine, motion: Motion, motions: list[np.ndarray]) -> tuple[np.ndarray, float]:
    """The motors' torques (N, n) from the bodies' masses, and the largest force or torque in the opened tree."""
    forces, in_tree = np.zeros(machine.geometry.nv), 0.0
    torques = np.empty((len(motion.time), len(machine.geometry.active)))
    for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
        turn = put_state(machine, q, v)
        machine.state.qacc[:] = turn.T @ (a - model_acceleration(machine, v))
        for evaluate in (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel):  # bodies may be massless
            evaluate(machine.compiled, machine.state)
        mujoco.mj_rne(machine.compiled, machine.state, 1, forces)
        torques[k] = motions[k].T @ forces
        in_tree = max(in_tree, float(np.abs(forces).max()))
    return torques, in_tree


def _random_inertia(random: np.random.Generator) -> pin.Inertia:
    """A body of about 1 kg, its centre of mass off its frame."""
    mass = float(random.uniform(0.5, 2.0))
    spread = AGREEMENT.length * random.normal(size=(3, 3))
    second = spread @ spread.T
    inertia = mass * (np.trace(second) * np.eye(3) - second)
    return pin.Inertia(mass, AGREEMENT.length * random.normal(size=3), inertia)
