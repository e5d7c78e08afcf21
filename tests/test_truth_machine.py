"""The machine built from a user's own MJCF: what is taken over, what is left out, what is refused."""

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.scenario.scenario import load_scenario
from bench.truth.assembly import assembled, loop_rows, reduced_inertia
from bench.truth.machine import build_machine
from bench.truth.simulate import simulate

MJCF = """
<mujoco>
  <option integrator="implicitfast" timestep="0.01"/>
  <worldbody>
    <body name="cart"><joint name="x" type="slide" axis="1 0 0" range="-1 1"/>
      <inertial pos="0 0 0" mass="4" diaginertia=".1 .1 .1"/>
      <body name="arm"><joint name="swing" axis="0 1 0" damping="0.05" actuatorfrcrange="-0.01 0.01"/>
        <inertial pos="0 0 -.2" mass="1" diaginertia=".01 .01 .001"/>
        <geom size=".1" pos="0 0 -.4" mass="0"/><site name="tip" pos="0 0 -.4" euler="0 90 0"/></body></body>
    <geom type="plane" size="1 1 1" pos="0 0 -.45"/>
    <site name="ground"/>
  </worldbody>
  <actuator><position name="own" joint="x" kp="1e4"/></actuator>
  <sensor><jointpos joint="x"/></sensor>
  <keyframe><key name="home" qpos="0.1 0.2" ctrl="0.5"/></keyframe>
</mujoco>
"""
ROBOT = """
name = "cart"
model = "cart.xml"
actuators = [
  { joint = "swing", gain = 2.0, gain_unit = "N*m/A" },
  { joint = "x", gain = 50.0, gain_unit = "N/V" },
]
tool = { site = "tip" }
"""
SCENARIO = """
robot = "."
[gains]
true = { x = 55.0, swing = 1.9 }
[payloads.ball]
mass = 0.3
[[recordings]]
name = "one"
use = "identify"
payload = "ball"
design = { span = 0.2, velocity_limit = 1.0, duration = 2.0, ramp = 0.5, base_frequency = 0.5 }
"""


@pytest.fixture
def cart(tmp_path):
    """Write a robot and its scenario, with changes (old text, new text) to either; the scenario's path."""

    def write(*changes):
        for name, text in (("cart.xml", MJCF), ("robot.toml", ROBOT), ("cart.toml", SCENARIO)):
            changed = text
            for old, new in changes:
                changed = changed.replace(old, new)
            (tmp_path / name).write_text(changed)
        return tmp_path / "cart.toml"

    return write


def test_a_serial_robot_with_a_slide_runs_in_the_order_of_its_actuators(cart):
    simulation = simulate(load_scenario(cart()))
    machine, recording = simulation.machine, simulation.recordings[0]
    np.testing.assert_array_equal(machine.dofs, [1, 0])
    np.testing.assert_array_equal(machine.drive.true_gains, [1.9, 55.0])
    np.testing.assert_array_equal(recording.position, recording.motion.qpos[:, [1, 0]])
    assert recording.loop_gap == 0
    # q2 = swing: (M q̈ + bias) with the payload as a point mass at the tip, damping of the MJCF included
    q, qd, qdd = recording.motion.qpos, recording.motion.qvel, recording.motion.qacc
    inertia = 1.0 * 0.2**2 + 0.01 + 0.3 * 0.4**2
    moment = 1.0 * 0.2 + 0.3 * 0.4
    swing = inertia * qdd[:, 1] - moment * np.cos(q[:, 1]) * qdd[:, 0] + moment * 9.81 * np.sin(q[:, 1])
    force = 5.3 * qdd[:, 0] - moment * (np.cos(q[:, 1]) * qdd[:, 1] - np.sin(q[:, 1]) * qd[:, 1] ** 2)
    np.testing.assert_allclose(recording.motion.torque[:, 0], swing + 0.05 * qd[:, 1], atol=1e-11)
    np.testing.assert_allclose(recording.motion.torque[:, 1], force, atol=1e-11)


def test_drives_sensors_contacts_and_integration_of_the_mjcf_do_not_count(cart):
    machine = build_machine(load_scenario(cart()))
    model = machine.models[None]
    assert model.nu == 2
    assert model.nsensor == 0
    assert model.opt.timestep == 0.00025
    assert model.opt.integrator == int(mujoco.mjtIntegrator.mjINT_EULER)
    assert model.opt.disableflags & int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    np.testing.assert_array_equal(machine.home, [0.1, 0.2])


def test_controller_is_tuned_to_the_inertia_of_each_joint(cart):
    scenario = load_scenario(cart(), {"controller": {"natural_frequency": 5.0, "damping": 0.7}})
    drive = build_machine(scenario).drive
    inertia = np.array([0.05, 5.0])
    np.testing.assert_allclose(drive.kp, inertia * (10 * np.pi) ** 2, rtol=1e-12)
    np.testing.assert_allclose(drive.kv, 2 * 0.7 * inertia * 10 * np.pi, rtol=1e-12)


def test_given_gains_of_the_controller_and_a_feedforward(cart):
    controller = {"kp": {"x": 1e4, "swing": 100.0}, "kv": {"x": 400.0, "swing": 4.0}}
    plain = simulate(load_scenario(cart(), {"controller": controller}))
    np.testing.assert_array_equal(plain.machine.drive.kp, [100.0, 1e4])
    ahead = simulate(load_scenario(cart(), {"controller": controller | {"feedforward": "acceleration"}}))
    lag = [
        np.sqrt(np.mean((r.motion.reference - r.position)[:, 1] ** 2))
        for r in (plain.recordings[0], ahead.recordings[0])
    ]
    assert lag[1] < 0.5 * lag[0]


@pytest.mark.parametrize(
    ("changes", "told"),
    [
        ([('site = "tip"', 'site = "ground"')], "tool site 'ground' does not move"),
        ([("span = 0.2", "span = 0.2, center = { x = 0.95, swing = 0 }")], "joint x reaches its end stop"),
    ],
)
def test_what_cannot_be_simulated_is_refused(cart, changes, told):
    with pytest.raises(BenchError, match=told):
        simulate(load_scenario(cart(*changes)))


def test_five_bar_is_followed_to_another_pose_in_its_assembly_mode():
    machine = build_machine(load_scenario("five_bar"))
    model = machine.models[None]
    target = machine.home[machine.addresses] + np.array([0.5, -0.4])
    pose = assembled(model, machine.home, machine.dofs, target)
    data = mujoco.MjData(model)
    data.qpos[:] = pose
    gap, _ = loop_rows(model, data)
    assert np.abs(gap).max() < 1e-12
    np.testing.assert_array_equal(pose[machine.addresses], target)
    # the elbows still bend the way they do at home
    assert (np.sign(pose[[1, 3]]) == np.sign(machine.home[[1, 3]])).all()


SLIDER_AND_TWO_RODS = """
<mujoco>
  <default><joint axis="0 1 0"/></default>
  <worldbody>
    <body name="slider"><joint name="x" type="slide" axis="1 0 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
      <body name="rod"><joint name="rod"/><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
        <body name="second" pos="0.3 0 0"><joint name="second"/>
          <inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/></body></body>
    </body>
  </worldbody>
  <equality><connect body1="second" anchor="0.3 0 0"/></equality>
</mujoco>
"""  # stretched, the rods reach from x = 0 to the point x = 0.6, where their end is held


@pytest.mark.parametrize("bend", [-1, 1])
def test_a_pose_is_followed_as_far_as_the_loop_reaches(bend):
    model = mujoco.MjModel.from_xml_string(SLIDER_AND_TWO_RODS)
    dofs = np.array([0])
    home = np.array([0.2, bend * np.arccos(2 / 3), -2 * bend * np.arccos(2 / 3)])
    angle = bend * np.arccos(1 / 2)
    np.testing.assert_allclose(
        assembled(model, home, dofs, np.array([0.3])), [0.3, angle, -2 * angle], atol=1e-11
    )
    with pytest.raises(BenchError, match="the loops do not close at the start"):
        assembled(model, home, dofs, np.array([-0.1]))


def test_reduced_inertia_is_that_of_the_kinetic_energy():
    machine = build_machine(load_scenario("five_bar"))
    model = machine.models[None]
    reduced = reduced_inertia(model, machine.home, machine.dofs)
    h, rates = 1e-6, np.array([0.7, -0.4])
    center = machine.home[machine.addresses]
    before, after = (assembled(model, machine.home, machine.dofs, center + s * h * rates) for s in (-1, 1))
    data = mujoco.MjData(model)
    data.qpos[:] = machine.home
    data.qvel[:] = (after - before) / (2 * h)
    model.opt.enableflags |= int(mujoco.mjtEnableBit.mjENBL_ENERGY)
    mujoco.mj_forward(model, data)
    assert 0.5 * rates @ reduced @ rates == pytest.approx(data.energy[1], rel=1e-7)
