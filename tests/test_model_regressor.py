"""The projected regressor against Pinocchio's and MuJoCo's own dynamics."""

from dataclasses import replace

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from bench.dataset.robot import load_robot
from bench.model import regressor as regressor_module
from bench.model.base import base_parameters
from bench.model.bounds import MEMORY
from bench.model.follow import build_tree
from bench.model.geometry import Anchor, Placement, read_geometry
from bench.model.motion import motion_of
from bench.model.regressor import (
    PARAMETERS,
    body_columns,
    parameter_names,
    payload_transform,
    projected_regressor,
    rotor_columns,
)
from bench.model.states import random_motion
from tests.mechanisms import NAMES, movement, robot_named, to_mujoco

STATES = 12


@pytest.fixture(params=NAMES)
def robot(request, tmp_path):
    return robot_named(request.param, tmp_path)


def tree_with(geometry, inertias):
    """Pinocchio's model of the opened tree with an inertia on every joint."""
    model = build_tree(geometry)
    for index, inertia in enumerate(inertias):
        model.appendBodyToJoint(index + 1, inertia, pin.SE3.Identity())
    return model


def random_inertias(geometry):
    pin.seed(3)
    return [pin.Inertia.Random() for _ in geometry.joints]


def rigid_machine(robot):
    """MuJoCo's model of the rigid robot: no rotor inertia, friction, damping, springs or limits."""
    compiled = robot.mjcf_model()
    for part in ("dof_armature", "dof_frictionloss", "dof_damping", "jnt_stiffness"):
        getattr(compiled, part)[:] = 0.0
    mujoco.mj_setConst(compiled, mujoco.MjData(compiled))  # a rotor's diagonal inertia is computed beforehand
    compiled.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_LIMIT | mujoco.mjtDisableBit.mjDSBL_CONTACT
    compiled.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    return compiled


def file_inertias(geometry, compiled):
    """The MJCF's inertias by joint: bodies without a joint added to what carries them."""
    inertias = [pin.Inertia.Zero() for _ in geometry.joints]
    place = {0: (-1, pin.SE3.Identity())}
    for body in range(1, compiled.nbody):
        if compiled.body_jntnum[body]:
            last = int(compiled.body_jntadr[body] + compiled.body_jntnum[body]) - 1
            free = geometry.joints[last].kind == "free"
            place[body] = (last, pin.SE3(np.eye(3), np.zeros(3) if free else -compiled.jnt_pos[last]))
        else:
            joint, frame = place[compiled.body_parentid[body]]
            own = pin.SE3(rotation(compiled.body_quat[body]), compiled.body_pos[body])
            place[body] = (joint, frame * own)
        joint, frame = place[body]
        if joint >= 0:
            turn = rotation(compiled.body_iquat[body])
            inertia = pin.Inertia(
                compiled.body_mass[body],
                compiled.body_ipos[body],
                turn @ np.diag(compiled.body_inertia[body]) @ turn.T,
            )
            inertias[joint] += frame.act(inertia)
    return inertias


def rotation(quaternion):
    matrix = np.empty(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


def parameters_of(inertias):
    return np.concatenate([inertia.toDynamicParameters() for inertia in inertias])


def test_tree_torque_is_rneas(robot):
    """tau = Y pi on the opened tree with Pinocchio's own regressor: signs and order of the parameters."""
    geometry = read_geometry(robot)
    inertias = random_inertias(geometry)
    model, bare = tree_with(geometry, inertias), build_tree(geometry)
    data, scratch = model.createData(), bare.createData()
    random = np.random.default_rng(4)
    for _ in range(STATES):
        q = pin.integrate(model, pin.neutral(model), random.normal(size=model.nv))
        v, a = random.normal(size=(2, model.nv))
        torque = pin.rnea(model, data, q, v, a)
        linear = pin.computeJointTorqueRegressor(bare, scratch, q, v, a) @ parameters_of(inertias)
        assert np.abs(torque - linear).max() < 1e-11 * max(1.0, np.abs(torque).max())


def test_projected_regressor_is_the_projected_rnea(robot):
    geometry = read_geometry(robot)
    inertias = random_inertias(geometry)
    model = tree_with(geometry, inertias)
    data = model.createData()
    motion = motion_of(geometry, *movement(geometry, samples=101))
    modelled = projected_regressor(geometry, motion) @ parameters_of(inertias)
    for i in range(len(motion.time)):
        torque = motion.jacobian[i].T @ pin.rnea(model, data, motion.q[i], motion.v[i], motion.a[i])
        assert np.abs(modelled[i] - torque).max() < 1e-11 * max(1.0, np.abs(torque).max())


def test_chosen_columns_and_blocks(robot, monkeypatch):
    geometry = read_geometry(robot)
    motion = motion_of(geometry, *movement(geometry, samples=50))
    every = projected_regressor(geometry, motion)
    assert every.shape == (50, len(geometry.active), 10 * len(geometry.joints))
    chosen = np.random.default_rng(6).permutation(every.shape[2])[:7]
    monkeypatch.setattr(regressor_module, "MEMORY", replace(MEMORY, block=13))
    assert np.array_equal(projected_regressor(geometry, motion, chosen), every[:, :, chosen])


def test_true_parameters_give_mujocos_torques(robot):
    """The model's torque, put into MuJoCo's equations of motion with its loops closed, gives the acceleration.

    M a + bias = S' tau + J' f and J a = -dJ/dt v, all from MuJoCo: nothing of the model but tau and a.
    """
    geometry = read_geometry(robot)
    compiled = rigid_machine(robot)
    state = mujoco.MjData(compiled)
    motion = random_motion(geometry, STATES, seed=9)
    torque = projected_regressor(geometry, motion) @ parameters_of(file_inertias(geometry, compiled))
    motors = [int(compiled.joint(name).dofadr[0]) for name in robot.joints]
    for i in range(len(motion.time)):
        qpos = to_mujoco(geometry, motion.q[i])
        qvel = to_mujoco_velocity(geometry, motion, i)
        jacobian, mass, bias = equations(compiled, state, qpos, qvel)
        h = 1e-6
        jacobians = []
        for sign in (1, -1):
            near = qpos.copy()
            mujoco.mj_integratePos(compiled, near, qvel, sign * h)
            jacobians.append(equations(compiled, state, near, qvel)[0])
        drift = (jacobians[0] - jacobians[1]) @ qvel / (2 * h)
        force = np.zeros(compiled.nv)
        force[motors] = torque[i]
        rows = len(jacobian)
        system = np.block([[mass, jacobian.T], [jacobian, np.zeros((rows, rows))]])
        solved = np.linalg.lstsq(system, np.concatenate((force - bias, -drift)))[0]
        expected = motion.a[i][geometry.active]
        assert np.abs(solved[motors] - expected).max() < 1e-6 * np.abs(expected).max()


def to_mujoco_velocity(geometry, motion, i):
    """MuJoCo's velocities: a free joint's linear part is in the world's axes."""
    v = motion.v[i].copy()
    for joint in geometry.joints:
        if joint.kind == "free":
            turn = pin.Quaternion(motion.q[i][joint.q.stop - 4 : joint.q.stop]).matrix()
            v[joint.v.start : joint.v.start + 3] = turn @ v[joint.v.start : joint.v.start + 3]
    return v


def equations(compiled, state, qpos, qvel):
    """Equality Jacobian, inertia matrix and bias force of MuJoCo."""
    state.qpos[:], state.qvel[:] = qpos, qvel
    mujoco.mj_forward(compiled, state)
    mass = np.zeros((compiled.nv, compiled.nv))
    mujoco.mj_fullM(compiled, state, mass)
    return state.efc_J.reshape(-1, compiled.nv).copy(), mass, state.qfrc_bias.copy()


def test_payload_in_the_joints_frame():
    """A cloud of point masses, its parameters summed in either frame."""
    random = np.random.default_rng(5)
    masses, points = random.uniform(0.1, 1.0, 30), random.normal(size=(30, 3))
    turn = pin.SE3.Random().rotation
    shift = random.normal(size=3)

    def parameters(at):
        total = np.array([masses.sum(), *(masses @ at)])
        inertia = (masses * (at**2).sum(axis=1)).sum() * np.eye(3) - (at.T * masses) @ at
        return np.concatenate((total, inertia[[0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]))

    transform = payload_transform(Anchor(0, Placement(turn, shift)))
    assert np.abs(transform @ parameters(points) - parameters(points @ turn.T + shift)).max() < 1e-12


def test_names_follow_the_columns(robot):
    geometry = read_geometry(robot)
    names = parameter_names(geometry)
    assert len(names) == 10 * len(geometry.joints) + len(geometry.robot.driven)
    for joint, body in geometry.bodies:
        assert [names[10 * joint + k][0] for k in range(10)] == [f"{symbol}({body})" for symbol in PARAMETERS]
    assert [names[column][0] for column in rotor_columns(geometry)] == [
        f"Ia({joint})" for joint in geometry.robot.driven
    ]
    assert set(body_columns(geometry)) == {10 * joint + k for joint, _ in geometry.bodies for k in range(10)}


def test_rotors_are_parameters_where_no_body_can_stand_for_them(robot):
    """Torques of the bodies and the rotors together are those of the base parameters."""
    geometry = read_geometry(robot)
    base = base_parameters(geometry)
    motion = random_motion(geometry, 20, seed=3)
    bodies, rotors = body_columns(geometry), rotor_columns(geometry)
    random = np.random.default_rng(1)
    masses, inertias = random.normal(size=10 * len(geometry.joints)), random.normal(size=len(rotors))
    torque = projected_regressor(geometry, motion, bodies) @ masses[bodies]
    torque += projected_regressor(geometry, motion, rotors) @ inertias
    kept = base.grouping[:, bodies] @ masses[bodies] + base.rotors @ inertias
    modelled = projected_regressor(geometry, motion, base.columns) @ kept
    assert np.abs(modelled - torque).max() < 1e-6 * np.abs(torque).max()


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("delta", []),
        ("dualv", []),
        ("five_bar", []),
        (
            "orthoglide",
            ["Ia(axis_3)"],
        ),  # the one that works against gravity: mass by its weight, less than inertia
        ("stewart", [f"Ia(axis_{leg})" for leg in range(1, 7)]),
        ("three_rrr", []),
        ("two_link", ["Ia(elbow)"]),
    ],
)
def test_which_rotors_are_parameters_of_their_own(name, own):
    base = base_parameters(read_geometry(load_robot(name)))
    assert [found for found in base.names if found.startswith("Ia(")] == own
