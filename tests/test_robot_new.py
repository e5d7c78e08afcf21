"""A robot.toml is made for an MJCF file, as a robot's own is, or not at all."""

import shutil
import tomllib
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.dataset.robot_toml import MotorPart, mjcf_parts, write_robot_toml

GEARED = """\
<mujoco>
  <worldbody>
    <body>
      <joint name="turn" type="hinge"/>
      <geom size="0.1"/>
      <body>
        <joint name="out" type="slide"/>
        <geom size="0.1"/>
        <body>
          <joint name="wrist" type="ball"/>
          <geom size="0.1"/>
          <site name="tip"/>
        </body>
      </body>
    </body>
  </worldbody>
  <tendon>
    <fixed name="belt"><joint joint="turn" coef="2"/></fixed>
  </tendon>
  <actuator>
    <motor name="drum" joint="turn" gear="50"/>
    <motor name="plain" joint="out"/>
  </actuator>
</mujoco>
"""


@pytest.fixture
def geared(tmp_path):
    path = tmp_path / "geared.xml"
    path.write_text(GEARED, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", ["five_bar", "delta", "wrist", "emps"])
def test_it_says_what_the_robot_toml_of_a_built_in_robot_says(name, tmp_path):
    robot = load_robot(name)
    shutil.copytree(built_in_robots()[name], tmp_path / name)
    (tmp_path / name / "robot.toml").unlink()
    words = [f"--motor={motor.joint}={motor.gain}" for motor in robot.motors]
    units = {motor.gain_unit.split("/")[1] for motor in robot.motors}
    tool = ["--tool", robot.tool_site] if robot.tool_site else []
    mjcf = tmp_path / name / robot.model_path.name
    assert main(["robot", "new", str(mjcf), *words, "--unit", units.pop(), *tool]) == 0
    made = load_robot(tmp_path / name)
    assert made.motors == robot.motors
    assert made.tool_site == robot.tool_site


def test_a_missing_tool_is_said_with_the_option_and_the_lines_to_add(geared, capsys):
    words = ["robot", "new", str(geared), "--motor=turn=2", "--motor=out=20"]
    assert main(words) == 0
    (note,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("note: ")]
    assert 'add the lines [tool] and site = "NAME" to robot.toml (sites of the MJCF: tip)' in note
    assert "--tool NAME --overwrite" in note
    assert main([*words, "--tool", "tip", "--overwrite"]) == 0
    assert "note: " not in capsys.readouterr().out


def test_what_a_motor_may_drive(geared):
    parts = mjcf_parts(geared)
    assert parts.motors == (
        MotorPart("turn", "joint", "N*m", True),
        MotorPart("out", "joint", "N", True),
        MotorPart("belt", "tendon", "N*m", False),
        MotorPart("drum", "motor", "N*m", True),
        MotorPart("plain", "motor", "N", True),
    )
    assert parts.sites == ("tip",)


def test_a_folder_elsewhere_names_the_file_from_there(geared, tmp_path):
    folder = write_robot_toml(
        geared, [("drum", 0.1), ("out", 20.0)], tool="tip", folder=tmp_path / "robots" / "g"
    )
    content = tomllib.loads((folder / "robot.toml").read_text())
    assert content["model"] == "../../geared.xml"
    assert [(one["gain"], one["gain_unit"]) for one in content["actuators"]] == [
        (0.1, "N*m/A"),
        (20.0, "N/A"),
    ]
    assert load_robot(folder).driven == ("drum", "out")


@pytest.mark.parametrize(
    ("motors", "keys", "said"),
    [
        ([("tur", 3.0)], {}, "did you mean 'turn'"),
        ([("wrist", 3.0)], {}, "no joint, fixed tendon or actuator"),
        ([("turn", 3.0)], {"tool": "tp"}, "did you mean 'tip'"),
        ([("turn", -3.0)], {}, "greater than 0"),
        ([("turn", 3.0), ("turn", 3.0)], {}, "already driven"),
    ],
)
def test_what_is_no_robot_is_not_written(geared, motors, keys, said, tmp_path):
    with pytest.raises(BenchError, match=said) as refused:
        write_robot_toml(geared, motors, **keys)
    assert "partial" not in str(refused.value)
    assert [path.name for path in tmp_path.iterdir()] == ["geared.xml"]


def test_a_robot_toml_is_replaced_only_when_asked_for(geared):
    folder = write_robot_toml(geared, [("turn", 3.0), ("out", 5.0)])
    before = (folder / "robot.toml").read_bytes()
    with pytest.raises(BenchError, match="already exists"):
        write_robot_toml(geared, [("turn", 4.0), ("out", 5.0)])
    assert (folder / "robot.toml").read_bytes() == before
    write_robot_toml(geared, [("turn", 4.0), ("out", 5.0)], overwrite=True)
    assert load_robot(folder).actuators[0].gain == 4.0


def test_without_motors_it_says_what_the_file_has(geared, capsys):
    assert main(["robot", "new", str(geared)]) == 2
    said = capsys.readouterr().err
    assert "joints turn, out; fixed tendons belt; actuators drum, plain; sites tip" in said
    assert main(["robot", "new", str(geared.with_name("none.xml")), "--motor", "a=1"]) == 2
    assert "there is no such file" in capsys.readouterr().err
    geared.write_text("<mujoco", encoding="utf-8")
    assert main(["robot", "new", str(geared)]) == 2
    assert "not valid XML" in capsys.readouterr().err
    assert not Path("robot.toml").exists()


def test_an_actuator_without_a_gear_may_drive_a_motor_by_its_name(tmp_path):
    mjcf = tmp_path / "leg.xml"
    mjcf.write_text(
        '<mujoco><worldbody><body><joint name="leg_slide" type="slide"/><geom size="0.1" mass="1"/></body></worldbody>'
        '<actuator><position name="leg" joint="leg_slide" kp="10"/></actuator></mujoco>'
    )
    assert main(["robot", "new", str(mjcf), "--motor=leg=10", "-o", str(tmp_path / "leg")]) == 0
    (motor,) = load_robot(tmp_path / "leg").motors
    assert (motor.joint, motor.gain, motor.gain_unit) == ("leg", 10.0, "N/A")
