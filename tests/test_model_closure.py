"""Loop closures against finite differences: Jacobians, velocity products, velocities and accelerations."""

import numpy as np
import pinocchio as pin
import pytest

from bench.model.closure import closures_of, loop_bias, loop_jacobian, loop_residual, loop_rows
from bench.model.elimination import eliminate
from bench.model.follow import advance, build_tree, home_pose, make_follower
from bench.model.geometry import read_geometry
from bench.model.kinematics import frames_of
from bench.model.motion import motion_of, rates_at
from bench.model.scalars import dense
from bench.model.states import random_motion
from tests.mechanisms import LOOPED, NAMES, movement, random_open_poses, robot_named

H = 1e-6


@pytest.fixture(params=LOOPED)
def geometry(request, tmp_path):
    return read_geometry(robot_named(request.param, tmp_path))


@pytest.fixture(params=NAMES)
def any_geometry(request, tmp_path):
    return read_geometry(robot_named(request.param, tmp_path))


def moved(model, q, step):
    """Pinocchio's integration of configurations (nq, N) by steps (nv, N)."""
    return np.stack([pin.integrate(model, *pair) for pair in zip(q.T, step.T, strict=True)], axis=1)


def difference(model, before, after):
    """Tree velocities (N, nv) that lead from configurations (N, nq) to others in unit time."""
    return np.array([pin.difference(model, *pair) for pair in zip(before, after, strict=True)])


def test_loop_jacobian_is_the_derivative_of_the_residual(geometry):
    """Everywhere for points and couplings; a weld's orientation error is an angle only where it is closed.

    An idle spin has a rate alone, and no residual.
    """
    model = build_tree(geometry)
    closed = random_motion(geometry, 4, seed=3).q.T
    parts = [np.arange(loop.size) < 3 for loop in geometry.loops]
    points = np.concatenate([*parts, np.full(len(geometry.couplings), True)])
    for q, rows in ((random_open_poses(geometry, 4), points), (closed, np.full(len(points), True))):
        jacobian = loop_jacobian(geometry, q)
        for index in range(geometry.nv):
            step = np.zeros((geometry.nv, 4))
            step[index] = H
            ahead, behind = (
                loop_residual(geometry, moved(model, q, step)),
                loop_residual(geometry, moved(model, q, -step)),
            )
            numeric = (ahead - behind) / (2 * H)
            assert np.abs(numeric - jacobian[:, index])[: len(rows)][rows].max() < 1e-8


def test_loop_bias_is_the_derivative_of_the_jacobian_times_velocity(geometry):
    model = build_tree(geometry)
    q = random_open_poses(geometry, 4)
    v = np.random.default_rng(2).normal(size=(geometry.nv, 4))
    closures = closures_of(geometry)
    bias = dense(loop_bias(closures, frames_of(closures.links, q), list(v)), 4)
    ahead, behind = (loop_jacobian(geometry, moved(model, q, s * H * v)) for s in (1, -1))
    numeric = np.einsum("mvk,vk->mk", (ahead - behind) / (2 * H), v)
    assert np.abs(numeric - bias).max() < 1e-7


def test_home_and_random_poses_are_closed(geometry):
    motion = random_motion(geometry, 30, seed=11)
    assert len(motion.time) == 30
    assert np.abs(loop_residual(geometry, motion.q.T)).max() < 1e-11
    assert np.ptp(motion.q[:, geometry.active_configuration], axis=0).min() > 0.1


def test_projection_is_the_derivative_of_the_closed_pose(geometry):
    """J_t and J_p of equation 3, from poses closed on either side."""
    model, follower = build_tree(geometry), make_follower(geometry)
    motion = random_motion(geometry, 3, seed=7)
    for q, jacobian in zip(motion.q, motion.jacobian, strict=True):
        pose, _ = advance(follower, home_pose(follower), q[geometry.active_configuration])
        for j in range(len(geometry.active)):
            way = np.zeros(len(geometry.active))
            way[j] = 1e-5
            start = q[geometry.active_configuration]
            ahead, behind = (advance(follower, pose, start + sign * way)[0].q for sign in (1, -1))
            numeric = pin.difference(model, behind, ahead) / 2e-5
            assert np.abs(numeric - jacobian[:, j]).max() < 1e-7


def test_motion_is_closed_and_its_rates_are_derivatives(any_geometry):
    geometry, model = any_geometry, build_tree(any_geometry)
    time, position, velocity, acceleration = movement(geometry)
    motion = motion_of(geometry, time, position, velocity, acceleration)
    active = geometry.active
    assert np.array_equal(motion.q[:, geometry.active_configuration], position - geometry.active_offset)
    assert np.array_equal(motion.v[:, active], velocity)
    assert np.array_equal(motion.a[:, active], acceleration)
    if geometry.closed:
        assert np.abs(loop_residual(geometry, motion.q.T)).max() < 1e-11
    assert np.abs(np.einsum("kvj,kj->kv", motion.jacobian, velocity) - motion.v).max() < 1e-12
    step = time[1]
    numeric_v = difference(model, motion.q[:-2], motion.q[2:]) / (2 * step)
    assert np.abs(numeric_v - motion.v[1:-1]).max() < 2e-4 * np.abs(motion.v).max()
    numeric_a = (motion.v[2:] - motion.v[:-2]) / (2 * step)
    assert np.abs(numeric_a - motion.a[1:-1]).max() < 2e-4 * np.abs(motion.a).max()
    # the error of these differences falls with the square of the step: what is left is theirs
    coarse = difference(model, motion.q[:-4], motion.q[4:]) / (4 * step)
    assert np.abs(coarse - motion.v[2:-2]).max() == pytest.approx(
        4.0 * np.abs(numeric_v - motion.v[1:-1]).max(), rel=0.05
    )


def test_motion_closes_the_differentiated_loops(geometry):
    """J v = 0 and J a + dJ/dt v = 0 (equations 3 and 4) with Pinocchio-free arithmetic of this test's own."""
    motion = motion_of(geometry, *movement(geometry))
    jacobian = loop_jacobian(geometry, motion.q.T)
    closures = closures_of(geometry)
    bias = dense(
        loop_bias(closures, frames_of(closures.links, motion.q.T), list(motion.v.T)), len(motion.time)
    )
    assert np.abs(np.einsum("mvk,kv->mk", jacobian, motion.v)).max() < 1e-9
    assert np.abs(np.einsum("mvk,kv->mk", jacobian, motion.a) + bias).max() < 1e-8


def test_rates_at_closed_poses_are_those_of_the_motion(any_geometry):
    time, position, velocity, acceleration = movement(any_geometry)
    motion = motion_of(any_geometry, time, position, velocity, acceleration)
    again = rates_at(any_geometry, time, motion.q, velocity, acceleration)
    for name in ("q", "v", "a", "jacobian"):
        assert np.abs(getattr(again, name) - getattr(motion, name)).max() < 1e-8


def test_structure_is_seen_not_computed(tmp_path):
    """No row of the five-bar speaks of its third direction; a Delta's loop knows one leg and the platform."""
    planar = read_geometry(robot_named("five_bar", tmp_path))
    closures = closures_of(planar)
    _, rows = loop_rows(closures, frames_of(closures.links, random_open_poses(planar, 2)))
    assert [len(row) for row in rows] == [4, 0, 4]
    delta = read_geometry(robot_named("delta", tmp_path))
    closures = closures_of(delta)
    _, rows = loop_rows(closures, frames_of(closures.links, random_open_poses(delta, 2)))
    assert len(rows) == 18
    assert max(len(row) for row in rows) == 3 + 6


def random_rows(shape, sparse, samples, seed):
    random = np.random.default_rng(seed)
    matrix = random.normal(size=(*shape, samples)) * (random.uniform(size=shape) < sparse)[:, :, None]
    matrix[range(shape[1]), range(shape[1])] += 3.0
    rows = [{j: matrix[i, j] for j in range(shape[1]) if np.any(matrix[i, j])} for i in range(shape[0])]
    return matrix.transpose(2, 0, 1), rows


@pytest.mark.parametrize(("shape", "sparse"), [((6, 6), 1.0), ((12, 12), 0.2), ((9, 5), 0.4), ((3, 1), 1.0)])
def test_elimination_is_least_squares(shape, sparse):
    matrices, rows = random_rows(shape, sparse, 7, seed=4)
    right = np.random.default_rng(5).normal(size=(shape[0], 7))
    solved = eliminate(rows).solve(list(right))
    for sample, matrix in enumerate(matrices):
        expected = np.linalg.lstsq(matrix, right[:, sample])[0]
        ours = [solved[j][sample] for j in range(shape[1])]
        assert np.abs(ours - expected).max() < 1e-12


def test_elimination_needs_no_pivots():
    """Leading entries that vanish at some samples, which no fixed order of the rows would survive."""
    angle = np.linspace(0.0, 2.0 * np.pi, 9)
    rows = [{0: np.cos(angle), 1: -np.sin(angle)}, {0: np.sin(angle), 1: np.cos(angle)}]
    solved = eliminate(rows).solve([1.0, 0.0])
    assert np.abs(solved[0] - np.cos(angle)).max() < 1e-15
    assert np.abs(solved[1] + np.sin(angle)).max() < 1e-15


def test_elimination_of_constants():
    solved = eliminate([{0: 2.0, 1: 1.0}, {1: 4.0}]).solve([np.array([4.0, 6.0]), 8.0])
    assert solved[1] == 2.0
    assert np.array_equal(solved[0], [1.0, 2.0])


def test_elimination_shows_what_is_not_determined():
    slope = np.array([1.0, 2.0, 3.0])
    rows = [{0: np.ones(3), 1: 2.0 * np.ones(3)}, {0: np.ones(3), 1: slope}]
    with np.errstate(divide="ignore", invalid="ignore"):
        solved = eliminate(rows).solve([1.0, 0.0])
    assert not abs(solved[1][1]) < 1e12
    assert np.abs(solved[1][[0, 2]] - [1.0, -1.0]).max() < 1e-12
    with pytest.raises(np.linalg.LinAlgError, match="not determined"):
        eliminate([{0: 1.0, 1: 2.0}])
