"""The force in a joint without a motor, against MuJoCo's own."""

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.effects import places_in, select_effects
from bench.effects.places import passive_joints
from bench.model.geometry import read_geometry
from bench.model.model import build_model
from bench.model.reaction import (
    bearing_of,
    bearing_rows,
    bearing_torques,
    mass_on_axis,
    undetermined_by,
    with_motors_held,
)
from bench.model.regressor import projected_regressor
from bench.model.states import random_motion
from tests.mechanisms import to_mujoco, write_robot
from tests.test_model_regressor import (
    equations,
    file_inertias,
    parameters_of,
    rigid_machine,
    to_mujoco_velocity,
)

STATES = 4
RESISTANCE = 3.0  # N*m, or N, in a joint without a motor
# A coupler on three parallel rockers: any two of them would carry it.
THREE_ROCKERS = """
  <worldbody>
    <body name="first"><joint name="first" axis="0 1 0"/><geom pos="0 0 0.1"/>
      <body name="coupler" pos="0 0 0.2"><joint name="first_pin" axis="0 1 0"/><geom pos="0.2 0 0"/></body></body>
    <body name="second" pos="0.2 0 0"><joint name="second" axis="0 1 0"/><geom pos="0 0 0.1"/></body>
    <body name="third" pos="0.4 0 0"><joint name="third" axis="0 1 0"/><geom pos="0 0 0.1"/></body>
  </worldbody>
  <equality><connect body1="coupler" body2="second" anchor="0.2 0 0"/>
    <connect body1="coupler" body2="third" anchor="0.4 0 0"/></equality>
"""


def mujocos_forces(compiled, state, qpos, qvel, torque, motors, drift):
    """Force (bodies, 3) that every body gets from its parent, world axes, loops closed without any softness."""
    jacobian, mass, bias = equations(compiled, state, qpos, qvel)
    force = np.zeros(compiled.nv)
    force[motors] = torque
    rows = len(jacobian)
    system = np.block([[mass, jacobian.T], [jacobian, np.zeros((rows, rows))]])
    solved = np.linalg.lstsq(system, np.concatenate((force - bias, -drift)))[0]
    state.qacc[:], state.efc_force[:] = solved[: compiled.nv], -solved[compiled.nv :]
    mujoco.mj_rnePostConstraint(compiled, state)
    return state.cfrc_int[:, 3:].copy()


def across(compiled, state, joint, forces):
    """Size of the force in a joint, forces (bodies, 3), at right angles to its axis."""
    index = compiled.joint(joint).id
    axis, force = state.xaxis[index], forces[compiled.jnt_bodyid[index]]
    return np.linalg.norm(force - axis * (axis @ force))


def drift_of(compiled, state, qpos, qvel, h=1e-6):
    jacobians = []
    for sign in (1, -1):
        near = qpos.copy()
        mujoco.mj_integratePos(compiled, near, qvel, sign * h)
        jacobians.append(equations(compiled, state, near, qvel)[0])
    return (jacobians[0] - jacobians[1]) @ qvel / (2 * h)


@pytest.mark.parametrize("name", ["five_bar", "delta", "palletiser", "stewart"])
def test_the_force_in_a_joint_is_mujocos(name):
    robot = load_robot(name)
    geometry = read_geometry(robot)
    compiled = rigid_machine(robot)
    state = mujoco.MjData(compiled)
    motion = random_motion(geometry, STATES, seed=9)
    held = with_motors_held(geometry, motion)
    parameters = parameters_of(file_inertias(geometry, compiled))
    torque = projected_regressor(geometry, motion) @ parameters
    motors = [int(compiled.joint(joint).dofadr[0]) for joint in robot.joints]
    joints = passive_joints(geometry)[:3]
    every = np.arange(10 * len(geometry.joints))
    stiff = geometry.joint_index(joints[0])
    bearings = {joint: bearing_of(geometry, geometry.joint_index(joint)) for joint in joints}
    found = {joint: bearing_rows(bearing, held, every) @ parameters for joint, bearing in bearings.items()}
    resisted = {
        joint: found[joint] + RESISTANCE * bearing_torques(bearing, held, stiff)[:, :, 0]
        for joint, bearing in bearings.items()
    }
    more = RESISTANCE * motion.jacobian[:, geometry.joints[stiff].v.start]
    with_stiff = [*motors, int(compiled.joint(joints[0]).dofadr[0])]
    for i in range(STATES):
        qpos, qvel = to_mujoco(geometry, motion.q[i]), to_mujoco_velocity(geometry, motion, i)
        drift = drift_of(compiled, state, qpos, qvel)
        forces = mujocos_forces(compiled, state, qpos, qvel, torque[i], motors, drift)
        applied = np.append(torque[i] + more[i], -RESISTANCE)
        against = mujocos_forces(compiled, state, qpos, qvel, applied, with_stiff, drift)
        for joint in joints:
            assert np.linalg.norm(found[joint][i]) == pytest.approx(
                across(compiled, state, joint, forces), rel=1e-5
            )
            assert np.linalg.norm(resisted[joint][i]) == pytest.approx(
                across(compiled, state, joint, against), rel=1e-5
            )


def test_a_force_that_closures_may_share_in_any_way_is_refused_with_the_reason(tmp_path):
    geometry = read_geometry(write_robot(tmp_path, THREE_ROCKERS, ["first"]))
    places = places_in(geometry, [])
    assert undetermined_by(geometry, geometry.joint_index("first_pin")) == "closures"
    assert places.passive == ("first_pin", "second", "third")
    assert places.bearing == ()
    with pytest.raises(
        BenchError, match="force in joint 'first_pin' does not follow from the motion: closures"
    ):
        select_effects(["passive_load_friction:first_pin"], places)
    with pytest.raises(BenchError, match="no joint without a motor whose force follows"):
        select_effects(["passive_load_friction"], places)


def test_a_mass_on_its_axis_is_all_of_an_elbow_s_force_that_motors_do_not_tell():
    model = build_model(load_robot("five_bar"))
    geometry = model.geometry
    for joint in passive_joints(geometry):
        index = geometry.joint_index(joint)
        mass, left = mass_on_axis(geometry, index)
        assert mass > 0.0
        assert left < 1e-9
        assert undetermined_by(geometry, index) == ""


def test_a_force_that_depends_on_masses_no_motor_shows_is_refused_with_the_reason():
    places = places_in(read_geometry(load_robot("three_rrr")), [])
    assert places.bearing == ("elbow_1", "elbow_2", "elbow_3")
    with pytest.raises(
        BenchError, match="'wrist_1' does not follow from the motion: it depends on where bodies"
    ):
        select_effects(["passive_load_friction:wrist_1"], places)
