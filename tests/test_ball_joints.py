"""Friction and armature in ball joints: the model's laws against the simulated machine, which are written apart."""

from types import SimpleNamespace

import mujoco
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
from bench.model.body_rates import joint_rates
from bench.model.geometry import read_geometry
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
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
LAWS = {"passive_viscous_friction": 0.075, "passive_coulomb_friction": 0.1, "passive_rotor_inertia": 0.02}
NOISE = 0.01
USES = ("identify", "validate")
PARAMETER = {name: CATALOGUE[name].parameters[0].name for name in LAWS}


def scenario_of(robot, hidden=()):
    """Two movements of a robot, with and without a payload's part: the crank alone drives."""
    design = {"optimise": False, "duration": 8.0, "span": 0.5, "velocity_limit": 3.0}
    content = {
        "robot": str(robot.folder),
        "step": 0.0005,
        "sensors": {"current_noise_ratio": NOISE},
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
    """A machine with friction in both balls of its rod, and what a fit makes of its measurements."""
    folder = tmp_path_factory.mktemp("balls")
    robot = write_robot(folder, ROBOTS["two balls"], ("crank",))
    dataset = as_dataset(simulate(scenario_of(robot, hidden_in("near", "far"))))
    effects = [f"{law}:{ball}" for law in LAWS if "friction" in law for ball in ("near", "far")]
    result = identify(prepare(problem_of(dataset, effects)))
    save_model(result, folder / "model.json")
    return robot, result, load_identified(folder / "model.json", folder)


def test_a_fit_finds_what_the_machine_has(found):
    """Friction of MuJoCo's own kind, which brakes each axis by itself, would leave nearly twice the noise."""
    _, result, _ = found
    passed = np.sqrt(noise_bandwidth(result.settings.decimation))
    assert result.error.validate < 1.1 * NOISE * passed
    for law, size in LAWS.items():
        for values in result.effect_parameters.get(law, {}).values():
            value = values[PARAMETER[law]]
            assert abs(value.value - size) < 3.0 * value.std


def test_exports_have_it_or_say_that_they_do_not(found, tmp_path):
    _, _, model = found
    physical = physical_set(model)
    exported = write_mjcf(tmp_path / "out.xml", physical)
    left = {(one.effect.name, one.effect.place) for one in exported.placed.not_placed}
    assert left == {("passive_coulomb_friction", "near"), ("passive_coulomb_friction", "far")}
    assert "each axis of a ball joint by itself" in exported.placed.not_placed[0].why
    made = mujoco.MjModel.from_xml_path(str(tmp_path / "out.xml"))
    values = {
        effect.place: effect.values for effect in physical.model.effects_in() if "viscous" in effect.name
    }
    for ball in ("near", "far"):
        first = made.joint(ball).dofadr[0]
        assert made.dof_damping[first : first + 3] == pytest.approx(values[ball]["Fv"])
        assert not made.dof_frictionloss[first : first + 3].any()
    _, left_out = c_text(model)
    assert [line for line in left_out if "ball" in line] == [
        f"{effect.name} at {effect.place}: a ball joint" for effect in model.effects_in()
    ]


def test_a_feed_forward_has_it(found):
    _, _, model = found
    geometry = model.model.geometry
    state = geometry.home[geometry.active_configuration], np.array([0.7]), np.array([2.0])
    tree = motion_of(geometry, np.zeros(1), *(values[None] for values in state))
    seen = SimpleNamespace(geometry=geometry, tree=tree)
    wanted = projected_regressor(geometry, tree, model.model.base.columns) @ model.base
    for effect in model.effects_in():
        columns = effect.instance.effect.columns(seen, effect.place)
        wanted = wanted + columns @ np.array(list(effect.values.values()))
    assert Feedforward(model)(*state) * model.gains == pytest.approx(wanted[0], rel=1e-9)


def test_the_check_offers_what_the_catalogue_has(tmp_path):
    near = 'frictionloss="0.1" stiffness="0.2"'
    robot = write_robot(tmp_path, CRANK.format(near=near, end=HELD[0], closed=HELD[1]), ("crank",))
    notes = [check for check in check_robot(robot).checks if check.code == CheckCode.JOINT_FORCE_NOT_MODELLED]
    words = {check.values["term"]: detail_of(check) for check in notes}
    assert "--with passive_coulomb_friction:near" in words["frictionloss"]
    assert "as a whole" in words["frictionloss"]
    assert "no such effect" in words["stiffness"]


def test_a_body_too_light_for_its_friction_is_refused(found):
    robot, *_ = found
    for law, parameter in (("passive_coulomb_friction", "Fc"), ("passive_viscous_friction", "Fv")):
        with pytest.raises(BenchError, match="ball joint 'near': what it carries is too light"):
            build_machine(scenario_of(robot, [{"effect": law, parameter: 10.0, "joint": "near"}]))


def test_a_spring_is_not_for_a_ball(found):
    robot, *_ = found
    with pytest.raises(BenchError, match="no hinge or slide joint 'near'"):
        build_machine(
            scenario_of(robot, [{"effect": "passive_spring", "k": 1.0, "q0": 0.0, "joint": "near"}])
        )
    with pytest.raises(BenchError, match="no joint 'near' where it can sit"):
        select_effects(["passive_spring:near"], places_in(read_geometry(robot), ()))
