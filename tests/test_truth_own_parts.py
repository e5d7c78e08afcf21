"""What a file says of all parts, of masses and of the simulation never reaches the simulated machine's own parts."""

import mujoco
import numpy as np
import pytest

from bench.export.mjcf import DrivenJoint, set_motors
from bench.scenario.scenario import load_scenario
from bench.truth.machine import build_machine
from bench.truth.simulate import simulate

NASTY = """
  <motor ctrllimited="true" forcelimited="true" forcerange="-1e-3 1e-3" gear="7"/>
  <general ctrllimited="true" ctrlrange="-1e-3 1e-3" actlimited="true" actrange="0 1" dyntype="filter" dynprm="0.5"
    gainprm="9" biastype="affine" biasprm="3 4 5" gear="3" armature="0.3" damping="0.4"/>
  <joint damping="3" stiffness="40" springref="1" armature="0.7" frictionloss="2" limited="true" range="-0.1 0.1"
    ref="0.3" pos="1 2 3" axis="1 1 1" solreffriction="0.5 2" margin="0.2"/>
  <site type="box" size=".4 .5 .6" pos="1 1 1" quat="0 1 0 0"/>
  <geom type="box" size=".4 .5 .6" density="9000" fluidshape="ellipsoid" fluidcoef="5 5 5 5 5" pos="1 1 1"/>
  <equality active="false" solref="0.5 2" solimp="0.1 0.2 0.1"/>
  <tendon limited="true" range="-1e-3 1e-3" stiffness="50" damping="6" frictionloss="3" armature="0.5" width="0.3"
    springlength="0.2"/>
"""
OWN = """<joint damping="0" stiffness="0" springref="0" armature="0.01" frictionloss="0" limited="false" range="0 0"
    ref="0" pos="0 0 0" axis="0 1 0" solreffriction="0.02 1" margin="0"/>
  <site type="sphere" size=".01 .01 .01" pos="0 0 0" quat="1 0 0 0"/>
  <equality active="true"/>
  <tendon limited="false" range="0 0" stiffness="0" damping="0" frictionloss="0" armature="0" width="0.003"
    springlength="-1"/>"""
MJCF = """<mujoco>
  <compiler angle="radian" autolimits="true"{compiler}/>
  {option}
  <default>{nasty}<default class="mine">{own}</default><default class="around">{nasty}</default></default>
  <worldbody><frame childclass="around">
    <body name="crank"><joint name="crank" class="mine"/>
      <inertial pos="0 0.01 .1" mass="1" diaginertia=".01 .01 .002"/>
      <body name="rod" pos="0 0 .2"><joint name="knee" class="mine"/>
        <inertial pos=".2 0 0" mass="1" diaginertia=".002 .01 .01"/>
        <site name="end" class="mine" pos=".4 0 0"/></body></body>
    <body name="rocker" pos=".4 0 0"><joint name="rocker" class="mine"/>
      <inertial pos="0 0 .1" mass="1" diaginertia=".01 .01 .002"/>
      <site name="top" class="mine" pos="0 0 .2"/><site name="tip" class="mine" pos="0 0 .3"/></body>
    <body name="arm" pos="0 .5 0"><joint name="arm" class="mine"/>
      <inertial pos=".1 0 0" mass="1" diaginertia=".01 .01 .01"/></body>
  </frame></worldbody>
  <equality><connect name="loop" class="mine" site1="end" site2="top"/></equality>
  <tendon><fixed name="belt" class="mine"><joint joint="arm" coef="5"/></fixed></tendon>
</mujoco>"""
ROBOT = """name = "machine"
model = "machine.xml"
actuators = [
  { joint = "crank", gain = 2.0, gain_unit = "N*m/A" },
  { tendon = "belt", gain = 0.5, gain_unit = "N*m/A" },
]
tool = { site = "tip" }
"""
SCENARIO = """robot = "."
[payloads.ball]
mass = 0.3
[[recordings]]
name = "one"
use = "identify"
payload = "ball"
design = { span = 0.2, velocity_limit = 1.0, duration = 1.0, ramp = 0.2, base_frequency = 1.0 }
"""
HIDDEN = """
[[hidden]]
effect = "drive_flexibility"
joint = "crank"
stiffness = 500.0
damping = 1.0
[[hidden]]
effect = "constant_offset"
joint = "crank"
c = 0.2
[[hidden]]
effect = "joint_spring"
joint = "belt"
k = 0.1
q0 = 0.1
[[hidden]]
effect = "presliding_hysteresis"
joint = "belt"
Fc = 0.1
stiffness = 1.0
[[hidden]]
effect = "cogging_torque"
joint = "crank"
a = 0.1
b = 0.1
period = 0.3
[[hidden]]
effect = "viscous_friction"
joint = "crank"
Fv = 0.1
[[hidden]]
effect = "coulomb_friction"
joint = "crank"
Fc = 0.1
[[hidden]]
effect = "passive_load_friction"
joint = "rocker"
mu = 0.01
[[hidden]]
effect = "platform_force"
fx = 2.0
k = 1.0
[[hidden]]
effect = "tool_drag"
c = 0.2
"""
FLAGS = ("actuation", "damper", "frictionloss", "sensor", "clampctrl", "refsafe", "island", "autoreset")
SWITCHES = (
    " ".join(f'{flag}="disable"' for flag in FLAGS) + ' sleep="enable" energy="enable" override="enable"'
)
OPTION = (
    f'<option actuatorgroupdisable="0" noslip_iterations="9" iterations="1" ls_iterations="1" cone="elliptic" '
    f'impratio="7"><flag {SWITCHES}/></option>'
)


@pytest.fixture
def scenario(tmp_path):
    def write(nasty="", compiler="", option="", hidden=HIDDEN):
        mjcf = MJCF.format(nasty=nasty, own=OWN, compiler=compiler, option=option)
        (tmp_path / "machine.xml").write_text(mjcf)
        (tmp_path / "robot.toml").write_text(ROBOT)
        (tmp_path / "machine.toml").write_text(SCENARIO + hidden)
        return load_scenario(tmp_path / "machine.toml")

    return write


def differing(first, second):
    """Names of the arrays and options in which two compiled models differ."""
    found = []
    for one, other, before in ((first, second, ""), (first.opt, second.opt, "opt.")):
        for name in dir(one):
            value = getattr(one, name)
            if name.startswith("_") or not isinstance(value, np.ndarray | int | float):
                continue
            if not np.array_equal(value, getattr(other, name), equal_nan=True):
                found.append(before + name)
    return found


@pytest.mark.parametrize("hidden", ["", HIDDEN])
@pytest.mark.parametrize("payload", [None, "ball"])
def test_defaults_and_options_of_the_file_stay_with_its_own_parts(scenario, hidden, payload):
    plain = build_machine(scenario(hidden=hidden)).models[payload]
    nasty = build_machine(scenario(NASTY, option=OPTION, hidden=hidden)).models[payload]
    assert differing(plain, nasty) == []


def test_currents_are_the_same(scenario):
    plain, nasty = (simulate(scenario(text, hidden="")).recordings[0] for text in ("", NASTY))
    assert np.array_equal(plain.current, nasty.current)


@pytest.mark.filterwarnings("ignore:compiler attribute 'settotalmass' is deprecated")
@pytest.mark.parametrize(
    "setting",
    [
        'inertiafromgeom="true"',
        'settotalmass="8"',
        'boundmass="0.5"',
        'boundinertia="0.1"',
        'balanceinertia="true"',
    ],
)
def test_settings_for_the_masses_of_the_file_are_for_its_own_bodies(scenario, setting):
    """The payload weighs what the scenario says, and rotors next to nothing."""
    scenario = scenario(compiler=" " + setting)
    if "fromgeom" in setting:
        path = scenario.robot.model_path
        path.write_text(path.read_text().replace("<inertial", '<geom type="sphere" size=".05"/><inertial'))
    file = scenario.robot.mjcf_model()
    machine = build_machine(scenario)
    bare, loaded = machine.models[None], machine.models["ball"]
    for name in ("crank", "rod", "rocker", "arm"):
        assert bare.body(name).mass == pytest.approx(file.body(name).mass)
        assert bare.body(name).inertia == pytest.approx(file.body(name).inertia)
    assert loaded.body_mass.sum() - bare.body_mass.sum() == pytest.approx(0.3)
    rotors = [
        i
        for i in range(bare.nbody)
        if mujoco.mj_id2name(bare, mujoco.mjtObj.mjOBJ_BODY, i).startswith(("rotor:", "hidden:"))
    ]
    assert len(rotors) == 2
    assert bare.body_mass[rotors].max() < 1e-5
    assert bare.body_inertia[rotors].max() < 1e-5


def test_nor_the_motors_that_an_export_adds():
    spec = mujoco.MjSpec.from_string(MJCF.format(nasty=NASTY, own=OWN, compiler="", option=""))
    (motor,) = set_motors(spec, spec.compile(), [DrivenJoint("crank", 2.0, 0.5)], [])
    model = spec.compile()
    added = model.actuator(motor.name)
    assert (added.gainprm[0], added.biasprm[:3].tolist(), added.gear[0]) == (2.0, [-0.5, 0.0, 0.0], 1.0)
    limits = (model.actuator_ctrllimited, model.actuator_forcelimited, model.actuator_actlimited)
    assert not any(limited[added.id] for limited in limits)
    assert not model.actuator_armature[added.id]
