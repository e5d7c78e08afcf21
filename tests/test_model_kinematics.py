"""Vectorised kinematics of the opened tree against Pinocchio's and MuJoCo's."""

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from bench.model.closure import loop_residual
from bench.model.configuration import configuration_rates, displacements, hermite, integrate
from bench.model.follow import build_tree
from bench.model.geometry import read_geometry
from bench.model.kinematics import end_of, end_point, end_rotation, frames_of, link_of, rates_of
from bench.model.scalars import dense
from tests.mechanisms import LOOPED, NAMES, random_open_poses, robot_named, to_mujoco

POSES = 5


@pytest.fixture(params=NAMES)
def robot(request, tmp_path):
    return robot_named(request.param, tmp_path)


def array(vector):
    """(N, 3) of a vector, or (N, 3, 3) of a matrix, whose entries may be constants."""
    if isinstance(vector[0], tuple):
        return np.stack([array(column) for column in vector], axis=2)
    return dense(vector, POSES).T


def all_frames(geometry, q):
    return frames_of(tuple(link_of(i, joint) for i, joint in enumerate(geometry.joints)), q)


def test_frames_are_pinocchios(robot):
    geometry = read_geometry(robot)
    model = build_tree(geometry)
    data = model.createData()
    q = random_open_poses(geometry, POSES)
    frames = all_frames(geometry, q)
    for i in range(POSES):
        pin.forwardKinematics(model, data, q[:, i])
        for index in range(len(geometry.joints)):
            place = data.oMi[index + 1]
            assert np.abs(array(frames.rotation[index])[i] - place.rotation).max() < 1e-12
            assert np.abs(array(frames.origin[index])[i] - place.translation).max() < 1e-12


def test_frames_are_mujocos(robot):
    geometry = read_geometry(robot)
    compiled = robot.mjcf_model()
    state = mujoco.MjData(compiled)
    q = random_open_poses(geometry, POSES)
    frames = all_frames(geometry, q)
    for i in range(POSES):
        state.qpos[:] = to_mujoco(geometry, q[:, i])
        mujoco.mj_forward(compiled, state)
        for index, joint in enumerate(geometry.joints):
            if joint.kind != "slide":  # MuJoCo gives a slide's anchor before it slides
                assert np.abs(array(frames.origin[index])[i] - state.xanchor[index]).max() < 1e-12
            if joint.kind in ("hinge", "slide"):
                assert np.abs(array(frames.axis[index])[i] - state.xaxis[index]).max() < 1e-12
        for index, name in geometry.bodies:
            turn = state.body(name).xmat.reshape(3, 3)
            assert np.abs(array(frames.rotation[index])[i] - turn).max() < 1e-12
            free = geometry.joints[index].kind == "free"
            origin = state.body(name).xpos + (0.0 if free else turn @ compiled.jnt_pos[index])
            assert np.abs(array(frames.origin[index])[i] - origin).max() < 1e-12
        if geometry.tool is not None:
            tool, site = end_of(geometry.tool), state.site(robot.tool_site)
            assert np.abs(array(end_point(frames, tool))[i] - site.xpos).max() < 1e-12
            assert np.abs(array(end_rotation(frames, tool))[i] - site.xmat.reshape(3, 3)).max() < 1e-12


@pytest.mark.parametrize("name", LOOPED)
def test_loop_residual_is_mujocos(name, tmp_path):
    robot = robot_named(name, tmp_path)
    geometry = read_geometry(robot)
    compiled = robot.mjcf_model()
    compiled.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
    state = mujoco.MjData(compiled)
    q = random_open_poses(geometry, POSES)
    residual = loop_residual(geometry, q)
    for i in range(POSES):
        state.qpos[:] = to_mujoco(geometry, q[:, i])
        mujoco.mj_forward(compiled, state)
        row = 0
        for index, loop in enumerate(geometry.loops):
            theirs = state.efc_pos[
                (state.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY) & (state.efc_id == index)
            ]
            assert np.abs(residual[row : row + 3, i] + theirs[:3]).max() < 1e-12
            row += loop.size


def test_rates_are_pinocchios(robot):
    geometry = read_geometry(robot)
    model = build_tree(geometry)
    data = model.createData()
    q = random_open_poses(geometry, POSES)
    v = np.random.default_rng(1).normal(size=(geometry.nv, POSES))
    links = tuple(link_of(i, joint) for i, joint in enumerate(geometry.joints))
    rates = rates_of(links, frames_of(links, q), list(v))
    for i in range(POSES):
        pin.forwardKinematics(model, data, q[:, i], v[:, i], np.zeros(geometry.nv))
        for index in range(len(geometry.joints)):
            velocity = pin.getVelocity(model, data, index + 1, pin.LOCAL_WORLD_ALIGNED)
            bias = pin.getClassicalAcceleration(model, data, index + 1, pin.LOCAL_WORLD_ALIGNED)
            assert np.abs(array(rates.angular[index])[i] - velocity.angular).max() < 1e-11
            assert np.abs(array(rates.angular_bias[index])[i] - bias.angular).max() < 1e-11
            assert np.abs(array(rates.linear_bias[index])[i] - bias.linear).max() < 1e-11


def test_integration_is_pinocchios(robot):
    geometry = read_geometry(robot)
    model = build_tree(geometry)
    q = random_open_poses(geometry, POSES)
    free = any(joint.kind == "free" for joint in geometry.joints)
    for size in (1.0, 1e-3, 0.0):
        step = size * np.random.default_rng(2).normal(size=(geometry.nv, POSES))
        moved = integrate(geometry, q, step)
        theirs = np.stack([pin.integrate(model, q[:, i], step[:, i]) for i in range(POSES)], axis=1)
        assert np.abs(moved - theirs).max() < (5.0 * size**2 if free else 0.0) + 1e-12


def test_displacements_undo_an_integration(robot):
    geometry = read_geometry(robot)
    q = random_open_poses(geometry, POSES)
    for size in (1.0, 1e-3, 0.0):
        step = size * np.random.default_rng(2).uniform(-1.0, 1.0, size=(geometry.nv, POSES))
        found = displacements(geometry, q, integrate(geometry, q, step))
        assert np.abs(found - step).max() < 1e-12


def test_configuration_rates_by_finite_differences(robot):
    geometry = read_geometry(robot)
    model = build_tree(geometry)
    q = random_open_poses(geometry, 1)
    random = np.random.default_rng(3)
    v, a = random.normal(size=(2, geometry.nv))
    h = 1e-4

    def along(t):
        """Where velocity v and acceleration a lead in time t: the mean velocity of each half."""
        half = pin.integrate(model, q[:, 0], 0.5 * t * (v + 0.25 * t * a))
        return pin.integrate(model, half, 0.5 * t * (v + 0.75 * t * a))

    first, second = configuration_rates(geometry, q, v[:, None], a[:, None])
    assert np.abs((along(h) - along(-h)) / (2 * h) - first[:, 0]).max() < 1e-6
    assert np.abs((along(h) - 2 * q[:, 0] + along(-h)) / h**2 - second[:, 0]).max() < 1e-5


def test_hermite_is_exact_for_quintics():
    time = np.array([0.0, 0.3, 0.45, 1.0])
    curves = [np.polynomial.Polynomial(c) for c in ((1, -2, 3, 0.5, -1, 2), (0, 1, 0, 0, 4, -3))]
    values = [np.array([curve.deriv(k)(time) for curve in curves]) for k in (1, 2)]
    between = hermite(time, np.array([curve(time) for curve in curves]), *values)
    fine = np.linspace(0.0, 1.0, 50)
    assert np.abs(between(fine).T - np.array([curve(fine) for curve in curves])).max() < 1e-12
