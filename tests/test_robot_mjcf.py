"""Motors behind belts, differentials and gears: fixed tendons and actuators of the MJCF, named in robot.toml."""

import mujoco
import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.robot import load_robot
from bench.model.geometry import read_geometry
from bench.model.model import build_model
from bench.model.motion import motion_of
from bench.robot_check.check import check_robot

ARM = """<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <worldbody>
    <body name="upper"><joint name="shoulder" axis="0 1 0" ref="0.2"/><geom size=".05" pos=".1 0 0"/>
      <body name="fore" pos=".3 0 0"><joint name="elbow" axis="0 1 0"/><geom size=".04" pos=".1 0 .02"/>
        <site name="tool" pos=".2 0 0"/></body></body>
    <body name="lift" pos="0 .5 0"><joint name="lift" type="slide" axis="0 0 1"/><geom size=".05"/></body>
  </worldbody>
  <tendon>
    <fixed name="one"><joint joint="shoulder" coef="20"/></fixed>
    <fixed name="two" armature="0.003" range="-30 30">
      <joint joint="shoulder" coef="10"/><joint joint="elbow" coef="-10"/></fixed>
    {tendon}
  </tendon>
  <actuator>
    <motor name="crane" joint="lift" gear="200"/>
    {actuator}
  </actuator>
  <keyframe><key name="home" qpos="0.5 -0.3 0.1"/></keyframe>
</mujoco>
"""
MOTORS = (("tendon", "one", "N*m/A"), ("tendon", "two", "N*m/A"), ("motor", "crane", "N*m/A"))


def write_arm(folder, motors=MOTORS, tendon="", actuator=""):
    mjcf = ARM.format(tendon=tendon, actuator=actuator)
    if all(name != "two" for _, name, _ in motors):  # it would couple the joints by its inertia
        mjcf = mjcf.replace('armature="0.003" range="-30 30"', "")
    (folder / "arm.xml").write_text(mjcf)
    text = 'name = "arm"\nmodel = "arm.xml"\n'
    for part, name, unit in motors:
        text += f'[[actuators]]\n{part} = "{name}"\ngain = 0.1\ngain_unit = "{unit}"\n'
    (folder / "robot.toml").write_text(text)
    return folder


@pytest.fixture
def arm(tmp_path):
    return load_robot(write_arm(tmp_path))


def refusal(folder):
    with pytest.raises(BenchError) as caught:
        build_model(load_robot(folder))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_motors_have_joints_of_their_own(arm):
    model = arm.mjcf_model()
    assert arm.joints == ("one", "two", "crane")
    assert (model.nv, model.neq) == (6, 3)
    assert model.joint("two").armature[0] == 0.003
    assert model.joint("two").range.tolist() == [-30, 30]
    assert not model.tendon_armature.any()
    state = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, state, model.key("home").id)
    mujoco.mj_forward(model, state)
    assert [state.joint(name).qpos[0] for name in arm.joints] == pytest.approx(
        [20 * 0.5, 10 * (0.5 + 0.3), 20.0]
    )
    assert np.abs(state.efc_pos[: model.neq]).max() < 1e-12
    assert np.abs(state.qfrc_bias[model.joint("one").dofadr[0] :]).max() < 1e-12, "rotors feel no weight"


def test_joints_follow_their_motors(arm):
    geometry = read_geometry(arm)
    time = np.linspace(0.0, 1.0, 101)
    angle = np.stack((0.3 * np.sin(3 * time), 0.2 * np.cos(2 * time) - 0.3, 0.05 * time), axis=1)
    rate = np.stack((0.9 * np.cos(3 * time), -0.4 * np.sin(2 * time), 0.05 + 0 * time), axis=1)
    growth = np.stack((-2.7 * np.sin(3 * time), -0.8 * np.cos(2 * time), 0 * time), axis=1)
    gears = np.array([[20.0, 0, 0], [10.0, -10.0, 0], [0, 0, 200.0]])
    motion = motion_of(geometry, time, *(one @ gears.T for one in (angle, rate, growth)))
    assert motion.q[:, 1:3] == pytest.approx(angle[:, 1:], abs=1e-10)
    assert motion.q[:, 0] == pytest.approx(angle[:, 0] - 0.2, abs=1e-10), "its zero lies at ref"
    assert motion.v[:, :3] == pytest.approx(rate, abs=1e-10)
    assert motion.a[:, :3] == pytest.approx(growth, abs=1e-9)
    assert motion.jacobian[:, :3] == pytest.approx(np.broadcast_to(np.linalg.inv(gears), (101, 3, 3)))


def test_rotors_are_no_bodies(arm):
    model = build_model(arm)
    assert [body for _, body in model.geometry.bodies] == ["upper", "fore", "lift"]
    assert "rotor" not in " ".join(model.base.descriptions)
    assert check_robot(arm).failures == ()


def test_a_gear_alone_scales_position_and_torque(tmp_path):
    """The same arm by its joints and by actuators with gears: the same base parameters of its bodies."""
    (tmp_path / "geared").mkdir()
    (tmp_path / "direct").mkdir()
    gears = '<motor name="m1" joint="shoulder" gear="5"/><motor name="m2" joint="elbow" gear="7"/>'
    motors = (("motor", "m1", "N*m/A"), ("motor", "m2", "N*m/A"), ("motor", "crane", "N*m/A"))
    joints = (("joint", "shoulder", "N*m/A"), ("joint", "elbow", "N*m/A"), ("joint", "lift", "N/A"))
    geared = build_model(load_robot(write_arm(tmp_path / "geared", motors, actuator=gears)))
    direct = build_model(load_robot(write_arm(tmp_path / "direct", joints)))
    assert [name for name in geared.base.names if "Ia" not in name] == [
        name for name in direct.base.names if "Ia" not in name
    ]


@pytest.mark.parametrize(
    ("motor", "named"),
    [
        (("tendon", "belt", "N*m/A"), ("no tendon 'belt'", "one, two")),
        (("motor", "winch", "N*m/A"), ("no actuator 'winch'", "crane")),
        (("tendon", "one", "N/A"), ()),
    ],
)
def test_a_motor_that_is_not_there(tmp_path, motor, named):
    if not named:
        load_robot(write_arm(tmp_path, (motor, *MOTORS[1:])))  # a length, if the robot's maker says so
        return
    message = refusal(write_arm(tmp_path, (motor, *MOTORS[1:])))
    assert [text for text in ("robot.toml", *named) if text not in message] == []


def test_one_of_joint_tendon_and_motor(tmp_path):
    folder = write_arm(tmp_path)
    text = (folder / "robot.toml").read_text()
    (folder / "robot.toml").write_text(text.replace('tendon = "one"', 'tendon = "one"\njoint = "shoulder"'))
    assert "one of joint, tendon, motor" in refusal(folder)


def test_a_name_that_is_taken(tmp_path):
    tendon = '<fixed name="elbow"><joint joint="elbow" coef="2"/></fixed>'
    folder = write_arm(tmp_path, (MOTORS[0], ("tendon", "elbow", "N*m/A"), MOTORS[2]), tendon)
    assert "tendon 'elbow': there is a joint of this name too" in refusal(folder)


def test_a_motor_on_a_tendon_that_robot_toml_does_not_name(tmp_path):
    joints = (("joint", "shoulder", "N*m/A"), ("joint", "elbow", "N*m/A"), ("joint", "lift", "N/A"))
    message = refusal(write_arm(tmp_path, joints, actuator='<motor name="pull" tendon="one"/>'))
    assert "motor 'pull' drives tendon 'one': name it in robot.toml" in message


def test_a_cable(tmp_path):
    tendon = '<spatial name="rope"><site site="tool"/><site site="hook"/></spatial>'
    folder = write_arm(tmp_path, (*MOTORS[:2], ("tendon", "rope", "N/A")), tendon)
    text = (folder / "arm.xml").read_text()
    (folder / "arm.xml").write_text(
        text.replace("</worldbody>", '<site name="hook" pos="1 0 1"/></worldbody>')
    )
    assert "'rope' is a cable in space" in refusal(folder)


def test_a_compiled_file_is_one_s_own_and_never_an_old_one(tmp_path):
    robot = load_robot(write_arm(tmp_path))
    first = robot.mjcf_model()
    mass = float(first.body_mass.sum())
    first.body_mass[:] = 0.0
    assert float(robot.mjcf_model().body_mass.sum()) == mass
    path = tmp_path / "arm.xml"
    path.write_text(path.read_text().replace('size=".04"', 'size=".08"'))
    changed = float(robot.mjcf_model().body_mass.sum())
    assert changed > mass
    body = '<mujoco><worldbody><body name="more"><geom size="{}"/></body></worldbody></mujoco>'
    (tmp_path / "more.xml").write_text(body.format(0.1))
    path.write_text(path.read_text().replace("<tendon>", '<include file="more.xml"/><tendon>', 1))
    small = float(robot.mjcf_model().body_mass.sum())
    (tmp_path / "more.xml").write_text(body.format(0.2))
    assert float(robot.mjcf_model().body_mass.sum()) > small > changed
