"""What `bench robot check` compares can differ: a model that is spoilt on purpose is found."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.model.geometry import Placement, read_geometry
from bench.model.states import random_motion
from bench.robot_check import agreement
from bench.robot_check.loops import check_closed_motion, check_constraints
from bench.robot_check.machine import make_machine, random_open_poses
from bench.robot_check.words import detail_of, name_of
from tests.broken_robots import write_five_bar
from tests.small_robots import SERIAL, spatial, welded, write_robot


def turned(angle):
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])


def with_joint(geometry, index, **changes):
    joints = list(geometry.joints)
    joints[index] = replace(joints[index], **changes)
    return replace(geometry, joints=tuple(joints))


def moved(placement, by):
    return Placement(placement.rotation, placement.translation + by)


def renamed(geometry):
    return with_joint(geometry, 1, name="sleigh")


def other_axis(geometry):
    return with_joint(geometry, 0, axis=turned(1e-6) @ geometry.joints[0].axis)


def other_place(geometry):
    return with_joint(geometry, 1, placement=moved(geometry.joints[1].placement, [0, 1e-8, 0]))


def other_offset(geometry):
    return with_joint(geometry, 0, offset=geometry.joints[0].offset + 1e-6)


def other_kind(geometry):
    return with_joint(geometry, 1, kind="hinge")


def other_parent(geometry):
    return with_joint(geometry, 1, parent=-1)


def no_gravity(geometry):
    return replace(geometry, gravity=np.zeros(3))


@pytest.mark.parametrize(
    ("change", "check", "culprit"),
    [
        (renamed, "joint tree", "'sleigh'"),
        (other_kind, "joint tree", "'rail' is a slide"),
        (other_parent, "joint tree", "'rail' has a different parent"),
        (other_axis, "joint places and axes", "'turn'"),
        (other_place, "joint places and axes", "'rail'"),
        (other_offset, "joint places and axes", "'"),
        (other_axis, "body poses, opened", "body '"),
        (no_gravity, "gravity and Coriolis forces", "joint '"),
    ],
)
def test_a_wrong_tree_is_found(change, check, culprit, tmp_path):
    machine = make_machine(change(read_geometry(welded(tmp_path / "robot"))))
    poses = random_open_poses(machine.geometry, 5, 1)
    found = {
        "joint tree": lambda: agreement.check_joint_list(machine),
        "joint places and axes": lambda: agreement.check_joint_motion(machine, poses),
        "body poses, opened": lambda: agreement.check_body_poses(machine, poses, "opened"),
        "gravity and Coriolis forces": lambda: agreement.check_bias_forces(machine, poses, poses[:, :8]),
    }[check]()
    assert (name_of(found), found.verdict) == (check, "failed")
    assert culprit in detail_of(found)


def test_a_wrong_mass_is_found(tmp_path):
    machine = make_machine(read_geometry(welded(tmp_path / "robot")))
    poses = random_open_poses(machine.geometry, 5, 1)
    assert agreement.check_mass_matrix(machine, poses).verdict == "ok"
    machine.model.inertias[3].mass *= 1 + 1e-6
    assert agreement.check_total_mass(machine).verdict == "failed"
    assert agreement.check_mass_matrix(machine, poses).values["joint"] == "floating"


def test_a_wrong_rotor_inertia_is_found(tmp_path):
    robot = write_robot(tmp_path / "r", SERIAL, {"shoulder": "N*m/A", "elbow": "N*m/A"})
    machine = make_machine(read_geometry(robot))
    machine.model.armature = np.zeros(2)
    found = agreement.check_mass_matrix(machine, random_open_poses(machine.geometry, 5, 1))
    assert found.verdict == "failed"
    assert found.values["joint"] == "shoulder"


@pytest.mark.parametrize("build", [welded, spatial])
def test_a_wrong_closure_is_found(build, tmp_path):
    geometry = read_geometry(build(tmp_path / "robot"))
    machine, motion = make_machine(geometry), random_motion(geometry, 5, 1)
    assert check_constraints(machine, motion.q).verdict == "ok"
    assert agreement.check_motor_forces(machine, motion).verdict == "ok"
    (loop,) = geometry.loops
    place = loop.second.placement
    for other in (moved(place, [0, 0, 1e-6]), Placement(place.rotation @ turned(1e-6), place.translation)):
        wrong = replace(loop, second=replace(loop.second, placement=other))
        spoilt = replace(machine, geometry=replace(geometry, loops=(wrong,)))
        found = check_constraints(spoilt, motion.q)
        assert found.verdict == "failed"
        assert found.values["closure"] == loop.name


def test_a_closed_motion_that_is_wrong_is_found(tmp_path):
    geometry = read_geometry(load_robot(write_five_bar(tmp_path / "linkage")))
    machine, motion = make_machine(geometry), random_motion(geometry, 5, 1)
    assert agreement.check_motor_forces(machine, motion).verdict == "ok"
    assert check_closed_motion(machine, motion).verdict == "ok"
    wrong = replace(motion, jacobian=motion.jacobian * (1 + 1e-6))
    assert agreement.check_motor_forces(machine, wrong).verdict == "failed"
    for wrong in (
        replace(motion, v=motion.v * [1, 1, 1, 1.001]),
        replace(motion, a=motion.a * [1, 1, 1, 1.001]),
    ):
        assert check_closed_motion(machine, wrong).verdict == "failed"
