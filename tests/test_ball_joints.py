"""Friction and armature in ball joints: the model's laws against the simulated machine, which are written apart."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.effects import CATALOGUE, places_in, select_effects
from bench.export.c_code import c_text
from bench.export.feedforward import Feedforward
from bench.export.identified import load_identified
from bench.export.mjcf import write_mjcf
from bench.export.physical import physical_set
from bench.identification.identify import identify
from bench.identification.model_file import save_model
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.model.geometry import read_geometry
from bench.model.joint_rates import joint_rates
from bench.model.motion import motion_of
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of
from bench.scenario.scenario import scenario_from_dict
from bench.signals.decimation import noise_bandwidth
from bench.truth.dataset import as_dataset
from bench.truth.inverse import motor_torque
from bench.truth.machine import build_machine
from bench.truth.simulate import simulate
from tests.mechanisms import movement, to_mujoco, write_robot

# A slider-crank in space whose rod has a ball joint of the tree at one end or at both.
CRANK = """
  <worldbody>
    <body name="crank"><joint name="crank" axis="0.3 1 0.2"/><geom pos="0.1 0.02 0.05" euler="0.1 0.3 0"/>
      <body name="rod" pos="0.2 0 0.1" euler="0.4 1.2 0.1"><joint name="near" type="ball" {near}/>
        <geom type="cylinder" size=".02 .25" pos="0 0 .25"/>{end}</body></body>
    <body name="slider" pos="0.66 0.02 0.23"><joint name="slide" type="slide" axis="1 0.2 0.1"/>
      <geom pos="0.02 0.03 0.01"/></body>
  </worldbody>
  <equality>{closed}</equality>
"""
FAR = (
    '<body name="block" pos="0 0 0.5"><joint name="far" type="ball"/><geom size=".02"/></body>',
    '<weld name="held" body1="block" body2="slider"/>',
)
HELD = ("", '<connect name="held" body1="rod" body2="slider" anchor="0 0 0.5"/>')
ROBOTS = {
    "one ball": CRANK.format(near="", end=HELD[0], closed=HELD[1]),
    "two balls": CRANK.format(near="", end=FAR[0], closed=FAR[1]),
}
LAWS = {"passive_viscous_friction": 0.3, "passive_coulomb_friction": 0.4, "passive_rotor_inertia": 0.02}
USES = ("identify", "validate")
PARAMETER = {name: CATALOGUE[name].parameters[0].name for name in LAWS}


def scenario_of(robot, hidden=()):
    """Two movements of a robot, with and without a payload's part: the crank alone drives."""
    design = {"optimise": False, "duration": 8.0, "span": 0.5, "velocity_limit": 3.0}
    content = {
        "robot": str(robot.folder),
        "step": 0.0005,
        "sensors": {"current_noise_ratio": 0.01},
        "design": design,
        "recordings": [{"name": use, "use": use, "design": {"seed": k}} for k, use in enumerate(USES)],
        "hidden": list(hidden),
    }
    return scenario_from_dict(content, "balls", robot=robot)


def hidden_in(*balls):
    return [{"effect": law, PARAMETER[law]: size, "joint": at} for at in balls for law, size in LAWS.items()]


@pytest.mark.parametrize("name", ROBOTS)
def test_they_ask_of_the_motors_what_the_machine_says(name, tmp_path):
    robot = write_robot(tmp_path, ROBOTS[name], ("crank",))
    geometry = read_geometry(robot)
    tree = motion_of(geometry, *movement(geometry, samples=5, size=0.3))
    seen = SimpleNamespace(geometry=geometry, tree=tree)
    active = [array[:, geometry.active] for array in (tree.v, tree.a)]
    poses = np.array([to_mujoco(geometry, q) for q in tree.q])
    position = tree.q[:, geometry.active_configuration] + geometry.active_offset

    def needed(*hidden):
        machine = build_machine(scenario_of(robot, hidden))
        return motor_torque(machine, None, poses, position, *active)

    for ball in places_in(geometry, ()).balls:
        for law, size in LAWS.items():
            more = needed({"effect": law, PARAMETER[law]: size, "joint": ball}) - needed()
            found = CATALOGUE[law].columns(seen, ball)[:, :, 0] * size
            assert np.abs(found).max() > 1e-3 * size
            assert found == pytest.approx(more, abs=1e-8 * np.abs(more).max()), (ball, law)


def test_the_rates_of_balls_are_the_smallest_that_a_rod_s_spin_allows(tmp_path):
    robot = write_robot(tmp_path, ROBOTS["two balls"], ("crank",))
    geometry = read_geometry(robot)
    tree = motion_of(geometry, *movement(geometry, size=0.3))
    rates = [joint_rates(geometry, tree, geometry.joint_index(ball)) for ball in ("near", "far")]
    near, far = ((one.velocity, one.acceleration) for one in rates)
    spun = [tree.v[:, geometry.joints[geometry.joint_index(ball)].v] for ball in ("near", "far")]
    squares = (near[0] ** 2).sum(axis=1) + (far[0] ** 2).sum(axis=1)
    assert np.all(squares <= sum((rate**2).sum(axis=1) for rate in spun) + 1e-12)
    assert squares.mean() < 0.999 * sum((rate**2).sum(axis=1) for rate in spun).mean()
    for velocity, acceleration in (near, far):  # in whatever frame: half the rate of the square
        power = np.gradient(0.5 * (velocity**2).sum(axis=1), tree.time)
        assert (velocity * acceleration).sum(axis=1)[5:-5] == pytest.approx(power[5:-5], abs=1e-3)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What a fit makes of a machine with all three in both balls."""
    folder = tmp_path_factory.mktemp("balls")
    robot = write_robot(folder, ROBOTS["two balls"], ("crank",))
    dataset = as_dataset(simulate(scenario_of(robot, hidden_in("near", "far"))))
    return identify(prepare(problem_of(dataset, [*LAWS, "passive_viscous_friction:slide"][:3]))), folder


def test_a_fit_finds_what_the_machine_has(found):
    result, _ = found
    passed = np.sqrt(noise_bandwidth(result.settings.decimation))
    print(result.error, passed, result.effect_parameters)
    assert result.error.validate < 1.1 * 0.01 * passed
