"""Light bodies that take a machine's forces through a loop: pins, frames and ground links as CAD exports have them."""

import mujoco
import numpy as np
import pytest

from bench.dataset.robot_toml import write_robot_toml
from bench.scenario.scenario import load_scenario
from bench.truth.machine import build_machine
from bench.truth.simulate import simulate

# a four-bar whose last pin carries a ground link, welded to the world at a point far from the pin
GROUNDED = """<mujoco><worldbody>
  <body name="crank"><joint name="motor" axis="0 1 0"/>
    <inertial pos="0.05 0.01 0" mass="0.5" diaginertia="1e-3 1e-3 1e-3"/>
    <body name="coupler" pos="0.1 0 0"><joint name="a" axis="0 1 0"/>
      <inertial pos="0.1 0.01 0.02" mass="0.5" diaginertia="1e-3 1e-3 1e-3"/><site name="tool" pos="0.1 0 0.05"/>
      <body name="rocker" pos="0.2 0 0.1"><joint name="b" axis="0 1 0"/>
        <inertial pos="0 0.01 -0.1" mass="0.5" diaginertia="1e-3 1e-3 1e-3"/>
        <body name="ground" pos="0 0 -0.2"><joint name="c" axis="0 1 0"/>
          <inertial pos="0 0 0" mass="{mass}" diaginertia="{inertia} {inertia} {inertia}"/></body></body></body></body>
  </worldbody><equality><weld body1="ground"/></equality></mujoco>"""
SCENARIO = """robot = "robot"
step = 0.0005
[design]
optimise = false
duration = 2.0
span = 0.5
velocity_limit = 2.0
[sensors]
current_noise_ratio = 0.0
[[recordings]]
name = "free"
use = "identify"
design = {seed = 1}
"""
LARGEST_TURN = 1e-5  # rad


def largest_turn(folder, mass, inertia):
    """By how much the ground link turns, rad, while the machine runs."""
    (folder / "robot").mkdir(parents=True)
    mjcf = folder / "robot" / "robot.xml"
    mjcf.write_text(GROUNDED.format(mass=mass, inertia=inertia))
    write_robot_toml(mjcf, [("motor", 2.0)], tool="tool")
    (folder / "scenario.toml").write_text(SCENARIO)
    scenario = load_scenario(folder / "scenario.toml")
    model = build_machine(scenario).models[None]
    data = mujoco.MjData(model)
    (recording,) = simulate(scenario).recordings
    turns = []
    for qpos in recording.motion.qpos[::20]:
        data.qpos[:] = qpos
        mujoco.mj_kinematics(model, data)
        turns.append(2.0 * np.linalg.norm(data.body("ground").xquat[1:]))
    return max(turns)


@pytest.mark.parametrize(("mass", "inertia"), [(0.1, 1e-3), (1e-4, 1e-8)])
def test_a_ground_link_holds_however_light_it_is(mass, inertia, tmp_path):
    """It turned by 0.01 rad at 1e-8 kg m2, which the motor felt as 4 % of its torque."""
    assert largest_turn(tmp_path, mass, inertia) < LARGEST_TURN


# two jaws with heavy rotors that one motor drives by a fixed tendon; the rotor that is added for it is light
BELT = """<mujoco><worldbody>
  <body name="left" pos="0 0.1 0"><joint name="a" axis="0 1 0" armature="0.1"/>
    <inertial pos="0.05 0.01 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/><site name="tool" pos="0.1 0 0"/></body>
  <body name="right" pos="0 -0.1 0"><joint name="b" axis="0 1 0" armature="0.1"/>
    <inertial pos="0.05 0.01 0" mass="0.1" diaginertia="1e-4 1e-4 1e-4"/></body></worldbody>
  <tendon><fixed name="belt"><joint joint="a" coef="0.5"/><joint joint="b" coef="0.5"/></fixed></tendon>
  <equality><joint joint1="a" joint2="b"/></equality></mujoco>"""


def test_a_motor_on_a_tendon_moves_heavy_joints(tmp_path):
    """The simulation diverged: the coupling gave way like the light rotor, which the controller then moved alone."""
    (tmp_path / "robot").mkdir()
    mjcf = tmp_path / "robot" / "robot.xml"
    mjcf.write_text(BELT)
    write_robot_toml(mjcf, [("belt", 2.0)], tool="tool")
    (tmp_path / "scenario.toml").write_text(SCENARIO)
    (recording,) = simulate(load_scenario(tmp_path / "scenario.toml")).recordings
    a, b, rotor = recording.motion.qpos.T
    assert np.ptp(rotor) > 0.1
    assert np.abs(rotor - 0.5 * (a + b)).max() < 1e-5
