"""Do the base parameters alone give MuJoCo's motor torques, for every body's mass and every rotor?

Torques are linear in masses and inertias, so that each body is checked by itself: a light body does not hide behind a
heavy one.
"""

import copy
from collections.abc import Iterator

import mujoco
import numpy as np
import pinocchio as pin

from bench.model.base import BaseParameters
from bench.model.bounds import RANKS
from bench.model.motion import Motion
from bench.model.regressor import projected_regressor
from bench.robot_check.agreement import model_acceleration, motor_motions
from bench.robot_check.bounds import AGREEMENT
from bench.robot_check.machine import CheckedMachine, body_label, place_state, set_pose
from bench.robot_check.outcome import Check, CheckCode

SEED = 20120604  # of masses and inertias


def check_base_parameters(machine: CheckedMachine, base: BaseParameters, motion: Motion) -> Check:
    """Motor torques at the closed states of motion, by MuJoCo's inverse dynamics and by the base parameters alone.

    Once for every body, of random mass, centre of mass and inertia, and once for the rotors, all others without mass.
    A body that the closures hold still, such as a base welded to the world, has no torque but rounding. What the slack
    of a drawing makes, and the base parameters therefore neglect, is allowed for.
    """
    reference = motion_with_torques(machine, motion)
    regressor = projected_regressor(machine.geometry, motion, base.columns)
    allowed = max(AGREEMENT.closed, RANKS.gap * base.neglected)
    worst, differing = 0.0, []
    for label, standard, rotors, theirs, in_tree in reference:
        ours = regressor @ (base.grouping @ standard + base.rotors @ rotors)
        largest = max(float(np.abs(theirs).max()), AGREEMENT.unfelt * in_tree)
        difference = float(np.abs(ours - theirs).max()) / largest if largest else 0.0
        worst = max(worst, difference)
        if not difference < allowed:
            differing.append(label)
    values = {"parameters": len(base.columns), "difference": worst}
    if differing:
        return Check(CheckCode.BASE_PARAMETERS_DIFFER, "failed", {**values, "bodies": differing})
    return Check(
        CheckCode.BASE_PARAMETERS_AGREE,
        "ok",
        {**values, "states": len(motion.time), "neglected": base.neglected},
    )


def motion_with_torques(
    machine: CheckedMachine, motion: Motion
) -> Iterator[tuple[str, np.ndarray, np.ndarray, np.ndarray, float]]:
    """For every body, then for all rotors: what has mass, its standard parameters (10 joints,), the rotors' inertias
    (n,), the motors' torques (N, n) by MuJoCo, and the largest force or torque in a joint of the opened tree.
    """
    geometry = machine.geometry
    driven = np.concatenate((geometry.active, geometry.redundant))
    motions = []
    for q, v in zip(motion.q, motion.v, strict=True):
        set_pose(machine, q, v)
        motions.append(motor_motions(machine))
    compiled = copy.copy(machine.compiled)
    compiled.body_sameframe[:] = compiled.body_simple[:] = 0  # shortcuts for the centres of mass of the file
    compiled.body_mass[:] = compiled.body_inertia[:] = 0.0
    light = CheckedMachine(
        geometry, compiled, mujoco.MjData(compiled), machine.model, machine.data, machine.places
    )
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
    """The motors' torques (N, n) of the masses of the machine's bodies, and the largest force in the opened tree."""
    forces, in_tree = np.zeros(machine.geometry.nv), 0.0
    torques = np.empty((len(motion.time), len(machine.geometry.active)))
    for k, (q, v, a) in enumerate(zip(motion.q, motion.v, motion.a, strict=True)):
        turn = place_state(machine, q, v)
        machine.state.qacc[:] = turn.T @ (a - model_acceleration(machine, v))
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
