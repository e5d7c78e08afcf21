"""Joints that [locked] of robot.toml holds: the machine without them is the machine at these positions, exactly."""

import json
import re

import mujoco
import numpy as np
import pytest

from bench.api.simulate import simulate
from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.robot import load_robot
from bench.robot_check.check import check_robot
from bench.robot_check.words import detail_of
from tests.mechanisms import TILTED, write_robot

ARM = """<mujoco>
  <compiler angle="{angle}" eulerseq="zyx" autolimits="true"/>
  <worldbody>
    <frame pos=".1 .2 .3" euler="{tilt} 0 {tilt}">
      <body name="base" pos="0 0 .2" axisangle="1 2 3 {tilt}">
        <frame pos=".02 0 0" euler="0 {tilt} 0"><joint name="turn" axis="1 .2 .1" pos=".1 0 .05" ref="{ref}"/></frame>
        <joint name="lift" type="slide" axis="0 1 .3" ref=".05"/>
        <joint name="tilt" axis=".3 .2 1" pos="0 .1 .02" ref="{ref}" range="-{wide} {wide}"/>
        <joint name="shift" type="slide" axis="1 0 1"/>
        <joint name="nod" axis="0 1 0" pos=".03 0 0"/>
        <geom type="box" size=".1 .05 .02" pos=".05 .02 0"/><site name="hook" pos="0 .2 0"/>
        <body name="hand" pos=".2 .1 0" euler="{tilt} {tilt} {tilt}">
          <joint name="wrist" axis="0 0 1" ref="{ref}"/>
          <geom type="box" size=".05 .02 .03" pos="0 .03 .01"/>
          <body name="finger" pos="0 .1 0" xyaxes="1 1 0 0 1 1"><joint name="grip" type="slide" axis="0 1 0"/>
            <geom size=".02" pos=".01 0 0"/><site name="tool" pos=".1 0 0"/></body></body></body></frame>
    <body name="free" pos="1 0 0"><freejoint name="float"/><geom type="box" size=".1 .2 .3"/></body>
    <body name="swing" pos="0 0 1"><joint name="ball" type="ball"/><geom size=".1" pos=".1 0 0"/></body>
  </worldbody>
  <equality>
    <connect name="pin" body1="hand" body2="free" anchor=".1 .2 .3"/>
    <weld name="glue" body1="free" body2="finger"/>
    <connect name="post" body1="finger" anchor="0 .1 0"/>
    <tendon name="belt" tendon1="long" tendon2="short" polycoef=".1 2 .3 0 .5"/>
    {equality}
  </equality>
  <tendon>
    <fixed name="long"><joint joint="turn" coef="2"/><joint joint="grip" coef="3"/>
      <joint joint="wrist" coef=".5"/></fixed>
    <fixed name="short"><joint joint="nod" coef="-1"/><joint joint="tilt" coef=".7"/></fixed>
    <fixed name="winch" range="-9 9"><joint joint="turn" coef="4"/><joint joint="tilt" coef="2"/></fixed>
    {tendon}
  </tendon>
  <actuator><position name="a" joint="tilt"/><general name="b" joint="turn" dyntype="filter"/>
    <motor name="geared" tendon="winch" gear="3"/></actuator>
  <sensor><jointpos joint="tilt"/><jointpos joint="turn"/><actuatorpos actuator="a"/><tendonpos tendon="long"/></sensor>
  <keyframe><key name="home" qpos=".1 .2 .3 .4 .5 .6 .7 1 0 0 1 0 0 0 1 0 0 0" qvel="1 2 3 4 5 6 7 0 0 0 0 0 0 0 0 0"
    ctrl="1 2 3" act="8"/></keyframe>
</mujoco>
"""
UNITS = {"degree": {"tilt": 40, "ref": 20, "wide": 100}, "radian": {"tilt": 0.7, "ref": 0.35, "wide": 1.75}}
VALUES = {"tilt": 0.8, "lift": -0.1, "shift": 0.3, "grip": 0.02, "wrist": -1.2, "turn": 0.9, "nod": 0.4}


def write(folder, locked, motors=("turn",), angle="degree", mjcf=ARM, tool=None, **parts):
    text = mjcf.format(angle=angle, **{**UNITS[angle], "equality": "", "tendon": "", **parts})
    (folder / "arm.xml").write_text(text)
    lines = ['name = "arm"', 'model = "arm.xml"']
    for motor in motors:
        kind, name, unit = motor if isinstance(motor, tuple) else ("joint", motor, "N*m/A")
        lines += ["[[actuators]]", f'{kind} = "{name}"', "gain = 2.0", f'gain_unit = "{unit}"']
    lines += ["[tool]", f'site = "{tool}"'] if tool else []
    lines += ["[locked]", *(f"{joint} = {value}" for joint, value in locked.items())] if locked else []
    (folder / "robot.toml").write_text("\n".join(lines))
    return folder


def states(full, locked, count=5):
    """Random states of the full model with joints at their values, and of these the entries of the others."""
    random = np.random.default_rng(1)
    held = [full.joint(name).id for name in locked]
    q, v = (
        np.delete(np.arange(full.nq), full.jnt_qposadr[held]),
        np.delete(np.arange(full.nv), full.jnt_dofadr[held]),
    )
    for _ in range(count):
        data = mujoco.MjData(full)
        data.qpos[:], data.qvel[:] = random.normal(size=full.nq), random.normal(size=full.nv)
        data.qpos[full.jnt_qposadr[held]] = list(locked.values())
        data.qvel[full.jnt_dofadr[held]] = 0.0
        mujoco.mj_normalizeQuat(full, data.qpos)
        yield data, q, v


def dense(model, data):
    mass = np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, mass)
    return mass


def opening(model, data, equality):
    of_equalities = data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY
    return data.efc_pos[of_equalities & (data.efc_id == model.equality(equality).id)]


@pytest.mark.parametrize("angle", UNITS)
@pytest.mark.parametrize(
    "names",
    [
        ("tilt",),
        ("lift",),
        ("turn",),
        ("nod", "turn"),
        ("lift", "tilt"),
        ("grip", "wrist"),
        ("tilt", "lift", "shift", "grip", "nod"),
        ("shift", "nod", "tilt", "lift"),
    ],
)
def test_the_locked_machine_is_the_whole_one_at_these_positions(names, angle, tmp_path):
    locked = {name: VALUES[name] for name in names}
    motor = next(name for name in VALUES if name not in locked and name not in ("lift", "shift", "grip"))
    robot = load_robot(write(tmp_path, locked, (motor,), angle))
    full, model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml")), robot.mjcf_model()
    for one in (full, model):
        one.opt.jacobian = mujoco.mjtJacobian.mjJAC_DENSE
        one.opt.disableflags = mujoco.mjtDisableBit.mjDSBL_CONTACT | mujoco.mjtDisableBit.mjDSBL_LIMIT
    assert model.nv == full.nv - len(locked)
    for whole, q, v in states(full, locked):
        data = mujoco.MjData(model)
        data.qpos[:], data.qvel[:] = whole.qpos[q], whole.qvel[v]
        for one, of in ((full, whole), (model, data)):
            mujoco.mj_forward(one, of)
        for name in ("base", "hand", "finger", "free", "swing"):
            assert data.body(name).xpos == pytest.approx(whole.body(name).xpos, abs=1e-12)
            assert data.body(name).xmat == pytest.approx(whole.body(name).xmat, abs=1e-12)
        assert data.site("tool").xpos == pytest.approx(whole.site("tool").xpos, abs=1e-12)
        assert dense(model, data) == pytest.approx(dense(full, whole)[np.ix_(v, v)], abs=1e-12)
        assert data.qfrc_bias == pytest.approx(whole.qfrc_bias[v], abs=1e-10)
        assert data.efc_pos == pytest.approx(whole.efc_pos, abs=1e-10), "what equalities are open by"
        jacobian = whole.efc_J.reshape(-1, full.nv)[:, v]
        assert data.efc_J.reshape(-1, model.nv) == pytest.approx(jacobian, abs=1e-10)


def test_keyframes_lose_the_numbers_of_what_is_gone(tmp_path):
    robot = load_robot(write(tmp_path, {"tilt": 0.8, "grip": 0.02}))
    model = robot.mjcf_model()
    assert model.key_qpos[0].tolist() == [0.1, 0.2, 0.4, 0.5, 0.6, 1, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0]
    assert model.key_qvel[0].tolist() == [1, 2, 4, 5, 6, *9 * [0]]
    assert (model.key_ctrl[0].tolist(), model.key_act[0].tolist()) == ([2, 3], [8])
    assert [model.actuator(i).name for i in range(model.nu)] == ["b", "geared"]
    assert model.nsensor == 2


@pytest.mark.parametrize(
    ("motor", "gear"), [(("tendon", "winch", "N*m/A"), 1), (("motor", "geared", "N*m/A"), 3)]
)
def test_a_motor_on_a_tendon_reads_what_it_would_with_the_locked_joint(motor, gear, tmp_path):
    """Its length is that over all joints, and the locked one adds a constant."""
    model = load_robot(write(tmp_path, {"tilt": 0.8}, (motor,))).mjcf_model()
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    assert data.joint(motor[1]).qpos[0] == pytest.approx(gear * (4 * 0.1 + 2 * 0.8))
    assert opening(model, data, "rotor:" + motor[1]) == pytest.approx([0.0], abs=1e-12)
    data.joint("turn").qpos[0] += 0.1
    data.joint(motor[1]).qpos[0] += gear * 4 * 0.1
    mujoco.mj_forward(model, data)
    assert opening(model, data, "rotor:" + motor[1]) == pytest.approx([0.0], abs=1e-12)


TIED = '<joint name="mimic" joint1="grip" joint2="wrist" polycoef="0.1 0.5 0 0 0"/>'
BELT = '<tendon name="taut" tendon1="cord" polycoef="0.2 0 0 0 0"/>'
CORD = '<fixed name="cord"><joint joint="grip" coef="2"/></fixed>'


@pytest.mark.parametrize(
    ("locked", "parts", "said"),
    [
        ({"tlit": 0.0}, {}, ("no joint 'tlit'", "did you mean 'tilt'")),
        ({"ball": 0.0}, {}, ("'ball' is a ball or free joint", "remove it")),
        ({"float": 0.0}, {}, ("'float' is a ball or free joint",)),
        ({"tilt": 40}, {}, ("tilt = 40 rad is outside its range", "40 degrees are 0.698132 rad")),
        ({"tilt": "true"}, {}, ("locked.tilt", "number")),
        ({"turn": 0.1}, {}, ("actuators[0] drives 'turn'", "leave out one")),
        ({"wrist": 1.35}, {"equality": TIED}, ("equality 'mimic'", "lock it too, grip = 0.6")),
        ({"grip": 0.6}, {"equality": TIED}, ("equality 'mimic'", "lock it too, wrist = 1.35")),
        ({"grip": 0.5, "wrist": 1.35}, {"equality": TIED}, ("'mimic' holds 'grip' at 0.6: lock it there",)),
        ({"grip": 0.3}, {"equality": BELT, "tendon": CORD}, ("'taut' of tendons is open by 0.4",)),
    ],
)
def test_what_cannot_be_locked_is_refused_with_its_cure(locked, parts, said, tmp_path):
    folder = write(tmp_path, locked, angle="radian", **parts)
    with pytest.raises(BenchError) as refused:
        load_robot(folder)
    message = str(refused.value)
    assert [text for text in ("robot.toml", "locked", *said) if text not in message] == []
    assert "\n" not in message


def test_a_leg_that_is_locked_loses_its_loops(tmp_path):
    """Two five-bars, one of them held at its assembled pose, or at another."""
    both = TILTED.replace(
        "</worldbody>", TILTED[TILTED.index("<body") : TILTED.index("</worldbody>")] + "</worldbody>"
    )
    first, second = both.split('<body name="frame"', 2)[1:]
    renamed = re.sub(r'name="(?!frame)', 'name="other_', second.split("</worldbody>")[0]).replace(
        '<site name="other_tool"', "<site"
    )
    loop = '<connect name="others" body1="other_left_rod" body2="other_right_rod" anchor="0.22 0.24 0"/>'
    body = (
        f'<worldbody><body name="frame"{first}<body name="second"{renamed}</worldbody>'
        + both.split("</worldbody>")[1]
    )
    write_robot(tmp_path, body.replace("<equality>", f"<equality>{loop}"), ("left", "right"))
    toml = (tmp_path / "robot.toml").read_text()
    places = {"left": 0.3, "left_elbow": -0.2, "right": 0, "right_elbow": 0.5}
    held = "".join(f"\nother_{name} = {value}" for name, value in places.items())
    (tmp_path / "robot.toml").write_text(f"{toml}\n[locked]{held}")
    robot = load_robot(tmp_path)
    assert (robot.mjcf_model().nv, robot.mjcf_model().neq) == (4, 1)
    assert check_robot(robot).failures == ()
    (tmp_path / "robot.toml").write_text(f"{toml}\n[locked]{held.replace('0.5', '0.6')}")
    with pytest.raises(BenchError, match=r"loop 'others' between locked joints is open by 0\.02\d* m: lock"):
        load_robot(tmp_path)


def test_a_tendon_that_an_equality_ties_to_locked_joints(tmp_path):
    folder = write(tmp_path, {"grip": 0.1, "wrist": 0.1, "turn": 0.1}, ("nod",))
    with pytest.raises(BenchError, match="'belt' ties tendon 'short' to locked joints: lock its joints too"):
        load_robot(folder)


# An arm with a gripper; the fixed one has the gripper's rail and finger where the table holds them.
GRIPPER = """<mujoco><compiler angle="radian"/><worldbody><body name="upper"><joint name="a" axis="0 1 0"/>
  <geom size=".05" pos=".1 .02 0"/><body name="fore" pos=".2 0 0"><joint name="b" axis=".2 1 0"/>
    <geom size=".04" pos=".1 0 .03"/><body name="palm" pos=".2 0 0"{turned}>{twist}<geom size=".02" pos="0 .1 0"/>
      <body name="finger" pos=".1 0 {out}">{rail}<geom size=".02" pos="0 0 .1"/></body></body></body></body></worldbody>
  </mujoco>"""
HELD = {
    "turned": "",
    "twist": '<joint name="twist" axis="1 0 0"/>',
    "out": 0,
    "rail": '<joint name="rail" type="slide"/>',
}
FIXED = {"turned": f' axisangle="1 0 0 {np.pi / 3}"', "twist": "", "out": 0.05, "rail": ""}
LOCKED = {"twist": np.pi / 3, "rail": 0.05}
EXPERIMENT = """robot = "."
step = 0.0005
[gains]
error = 0.1
[sensors]
current_noise = 0.01
[[recordings]]
name = "one"
use = "identify"
design = { span = 0.8, velocity_limit = 3.0, duration = 2.0, ramp = 0.5, base_frequency = 0.5 }
"""


def gripper(folder, parts, locked):
    folder.mkdir()
    write(folder, locked, ("a", "b"), mjcf=GRIPPER, **parts)
    (folder / "arm.toml").write_text(EXPERIMENT)
    return folder


@pytest.fixture(scope="module")
def logged(tmp_path_factory):
    """The gripper's dataset, and the folder of the fixed one's."""
    folder = tmp_path_factory.mktemp("gripper")
    for name, parts, locked in (("held", HELD, LOCKED), ("fixed", FIXED, {})):
        simulate(gripper(folder / name, parts, locked) / "arm.toml", folder / name / "data")
    return folder


def test_the_machine_with_locked_joints_logs_what_the_fixed_one_does(logged):
    held, fixed = (load_dataset(logged / name / "data").recordings[0] for name in ("held", "fixed"))
    assert held.current == pytest.approx(fixed.current, abs=1e-9)


def test_every_answer_names_what_is_locked(logged, tmp_path, capsys):
    said = {"twist": {"value": np.pi / 3, "unit": "rad"}, "rail": {"value": 0.05, "unit": "m"}}
    data, answer = logged / "held" / "data", tmp_path / "answer.json"
    assert json.loads(data.with_suffix(".truth.json").read_text())["locked"] == said
    for command in (
        ["robot", "check", str(logged / "held")],
        ["identify", str(data)],
        ["diagnose", str(data)],
    ):
        assert main([*command, "--json", str(answer)]) == 0
        assert json.loads(answer.read_text())["locked"] == said
        printed = " ".join(capsys.readouterr().out.split())
        assert "twist = 1.0472 rad" in printed
        assert "rail = 0.05 m" in printed


def test_a_model_is_for_the_positions_that_it_was_identified_with(logged, tmp_path, capsys):
    data, model = logged / "held" / "data", tmp_path / "model.json"
    assert main(["identify", str(data), "--json", str(model)]) == 0
    assert main(["compare", str(data), "--model", str(model)]) == 0
    toml = logged / "held" / "robot.toml"
    before = toml.read_text()
    toml.write_text(before.replace("rail = 0.05", "rail = 0.02"))
    capsys.readouterr()
    assert main(["compare", str(data), "--model", str(model)]) == 2
    toml.write_text(before)
    assert (
        "rail = 0.05 m locked, but robot arm locks twist = 1.0472 rad, rail = 0.02 m"
        in capsys.readouterr().err
    )


def test_the_closed_home_that_the_check_tells_is_a_keyframe_of_the_file(tmp_path):
    """It has the numbers of locked joints, and none of rotors."""
    hook = '<body name="hook"><joint name="hook" axis="0 1 0"/><geom/></body><body name="weight"'
    belt = '<tendon><fixed name="belt"><joint joint="left" coef="20"/></fixed></tendon>'
    keys = '<keyframe><key name="home" qpos="0.3 -0.2 0 0 0.51"/></keyframe>'
    write_robot(
        tmp_path, TILTED.replace('<body name="weight"', hook) + belt + keys, ("left", "right", "hook")
    )
    toml = (
        (tmp_path / "robot.toml")
        .read_text()
        .replace('joint = "left"', 'tendon = "belt"')
        .split('[[actuators]]\njoint = "hook"')[0]
    )
    (tmp_path / "robot.toml").write_text(toml + "[locked]\nhook = 0.7")
    (told,) = check_robot(load_robot(tmp_path)).failures
    key = re.search(r"<key .*/>", detail_of(told)).group(0)
    assert len(re.findall(r"[-\d.]+(?=[ \"])", key)) == 5
    mjcf = (tmp_path / "robot.xml").read_text()
    (tmp_path / "robot.xml").write_text(mjcf.replace('<key name="home" qpos="0.3 -0.2 0 0 0.51"/>', key))
    assert check_robot(load_robot(tmp_path)).failures == ()


def test_a_robot_toml_is_written_with_locked_joints(tmp_path):
    folder = gripper(tmp_path / "new", HELD, {})
    words = ["--motor", "a=2", "--motor", "b=2", "--lock", "twist=0.3", "--lock", "rail=0"]
    assert main(["robot", "new", str(folder / "arm.xml"), *words, "--overwrite"]) == 0
    assert [(one.name, one.value) for one in load_robot(folder).locked] == [("twist", 0.3), ("rail", 0.0)]
    before = (folder / "robot.toml").read_text()
    assert main(["robot", "new", str(folder / "arm.xml"), *words[:4], "--lock", "a=0", "--overwrite"]) == 2
    assert (folder / "robot.toml").read_text() == before
