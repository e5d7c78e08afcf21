"""A wrong robot folder is refused in one line that names the culprit."""

import re
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.basics.files.toml_input import line_of
from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot

TOML = """\
name = "slider"
model = "slider.xml"

[[actuators]]
joint = "slide"
gain = 100
gain_unit = "N/A"

[[actuators]]
joint = "turn"
gain = 2.5
gain_unit = "N*m/V"

[tool]
site = "tool"
"""
MJCF = """\
<mujoco>
  <worldbody>
    <body>
      <joint name="slide" type="slide"/>
      <geom size="0.1"/>
      <body>
        <joint name="turn" type="hinge"/>
        <geom size="0.1"/>
        <site name="tool"/>
      </body>
    </body>
    <body>
      <joint name="wrist" type="ball"/>
      <geom size="0.1"/>
    </body>
  </worldbody>
</mujoco>
"""


def write_robot(folder: Path, toml: str = TOML, mjcf: str = MJCF) -> Path:
    (folder / "robot.toml").write_text(toml, encoding="utf-8")
    (folder / "slider.xml").write_text(mjcf, encoding="utf-8")
    return folder


def refusal(robot: str | Path, relative_to: Path | None = None) -> str:
    with pytest.raises(BenchError) as caught:
        load_robot(robot, relative_to)
    message = str(caught.value)
    assert "\n" not in message
    return message


def test_the_unspoilt_robot_loads(tmp_path: Path) -> None:
    robot = load_robot(write_robot(tmp_path))
    assert robot.joints == ("slide", "turn")
    assert robot.nominal_gains.tolist() == [100, 2.5]
    assert [actuator.gain_unit for actuator in robot.actuators] == ["N/A", "N*m/V"]
    assert robot.tool_site == "tool"
    assert robot.model_path == tmp_path.resolve() / "slider.xml"


def test_logs_of_torques_have_gains_of_one(tmp_path: Path) -> None:
    toml = TOML.replace('"N/A"', '"1"').replace('"N*m/V"', '"1"')
    units = [actuator.gain_unit for actuator in load_robot(write_robot(tmp_path, toml)).actuators]
    assert units == ["N/N", "N*m/(N*m)"]


def test_a_file_in_place_of_a_folder_is_named_with_what_to_do(tmp_path: Path) -> None:
    folder = write_robot(tmp_path)
    mjcf = folder / "slider.xml"
    assert f"this is a file; give its folder {folder}" in refusal(mjcf)
    (folder / "robot.toml").unlink()
    assert f"this is an MJCF file; bench robot new {mjcf} makes a robot folder of it" in refusal(mjcf)
    mjcf.unlink()
    assert f"neither a built-in robot nor a folder: there is no {mjcf}" in refusal(mjcf)


def test_the_tool_may_be_left_out(tmp_path: Path) -> None:
    assert load_robot(write_robot(tmp_path, TOML.split("[tool]", maxsplit=1)[0])).tool_site is None


@pytest.mark.parametrize(
    ("old", "new", "named"),
    [
        ("name =", "nane =", ("nane", "unknown key: did you mean 'name'?")),
        ('name = "slider"\n', "", ("name", "missing")),
        ('"slider"', '""', ("name", "at least 1 character")),
        ('model = "slider.xml"\n', "", ("model", "missing")),
        ("slider.xml", "other.xml", ("model", "other.xml")),
        ("slider.xml", "..", ("model", "there is no file")),
        ("gain = 100\n", "", ("actuators[0].gain", "missing")),
        ("gain = 2.5\n", "", ("actuators[1].gain", "missing")),
        ("gain = 100", "gain = 0", ("actuators[0].gain", "greater than 0")),
        ("gain = 100", "gain = -3.0", ("actuators[0].gain", "greater than 0", "-3.0")),
        ("gain = 100", "gain = nan", ("actuators[0].gain", "finite", "nan")),
        ("gain = 100", "gain = inf", ("actuators[0].gain", "finite", "inf")),
        ("gain = 100", 'gain = "100"', ("actuators[0].gain", "number", "'100'")),
        ("gain = 100", "gain = true", ("actuators[0].gain", "number", "True")),
        ("gain = 100", "gain = 100\ngear = 50", ("actuators[0].gear", "unknown key")),
        ('"N/A"', '"Nm/A"', ("actuators[0].gain_unit", "'Nm/A'")),
        ('"N/A"', '"N*m/A"', ("actuators[0].gain_unit", "'slide' is a slide", '"N/A"', "'N*m/A'")),
        ('"N*m/V"', '"N/V"', ("actuators[1].gain_unit", "'turn' is a hinge", '"N*m/V"', "'N/V'")),
        ('"turn"', '"twist"', ("actuators[1].joint", "slider.xml", "'twist'", "slide, turn, wrist")),
        ('"turn"', '"slide"', ("actuators[1].joint", "'slide'", "actuators[0]")),
        ('"turn"', '"wrist"', ("actuators[1].joint", "'wrist'", "ball")),
        ('site = "tool"', 'site = "flange"', ("tool.site", "slider.xml", "'flange'")),
        ('site = "tool"', 'sites = "tool"', ("tool.sites", "unknown key: did you mean 'site'?")),
        ("[tool]", "[tool", ("not valid TOML", "line 14")),
        ("[tool]", "[gripper]", ("gripper", "unknown key")),
        ("[[actuators]]", "[[motors]]", ("motors", "unknown key: did you mean 'actuators'?")),
        (TOML[TOML.index("[[") : TOML.index("[tool]")], "", ("actuators", "missing")),
        (TOML[TOML.index("[[") : TOML.index("[tool]")], "actuators = []\n", ("actuators", "at least one")),
        (TOML[TOML.index("[[") : TOML.index("[tool]")], "actuators = [3]\n", ("actuators[0]", "table", "3")),
    ],
)
def test_a_wrong_description_is_refused(tmp_path: Path, old: str, new: str, named: tuple[str, ...]) -> None:
    assert old in TOML
    message = refusal(write_robot(tmp_path, TOML.replace(old, new)))
    assert [text for text in ("robot.toml", *named) if text not in message] == [], message


@pytest.mark.parametrize(
    ("mjcf", "named"),
    [
        (MJCF.replace("</worldbody>", ""), ("not valid XML: mismatched element", "line")),
        (MJCF.replace('<geom size="0.1"/>', '<gem size="0.1"/>', 1), ("gem", "line 5")),
        (MJCF.replace('type="slide"', 'type="prism"'), ("prism",)),
        (MJCF.replace('<geom size="0.1"/>', "", 1).replace('size="0.1"', 'size="-1"', 1), ()),
        ("", ()),
    ],
)
def test_a_broken_mjcf_is_refused_with_what_mujoco_says(
    tmp_path: Path, mjcf: str, named: tuple[str, ...]
) -> None:
    message = refusal(write_robot(tmp_path, mjcf=mjcf))
    assert "slider.xml" in message
    assert len(re.split("cannot compile it: |not valid XML: ", message)[1]) > 10
    assert [text for text in named if text not in message] == [], message


def test_a_robot_that_is_nowhere_names_the_built_in_ones(tmp_path: Path) -> None:
    message = refusal("six_bar", relative_to=tmp_path)
    assert "'six_bar'" in message
    assert "delta, dualv, emps, five_bar" in message
    assert str(tmp_path) in message
    assert refusal("five_bra").endswith("did you mean 'five_bar'?")


def test_a_mistake_is_told_with_its_line(tmp_path: Path) -> None:
    folder = write_robot(tmp_path)
    text = (folder / "robot.toml").read_text()
    lines = text.splitlines()
    at = next(i for i, line in enumerate(lines) if line.startswith("gain ="))
    lines[at] = 'gain = "three"'
    (folder / "robot.toml").write_text("\n".join(lines))
    assert f"robot.toml, line {at + 1}: actuators[0].gain: should be a valid number" in refusal(folder)


def test_lines_are_found_by_location() -> None:
    text = (
        'robot = "x"\n\n[payloads.disc]\nmass = 1\n\n[[recordings]]\nfile = "a"\n[[recordings]]\nuse = "b"\n'
    )
    assert line_of(text, ("robot",)) == 1
    assert line_of(text, ("payloads", "disc", "mass")) == 4
    assert line_of(text, ("recordings", 0, "file")) == 7
    assert line_of(text, ("recordings", 1, "file")) == 8  # it is missing there: its table
    assert line_of(text, ("recordings", 1, "use")) == 9
    assert line_of(text, ("elsewhere",)) is None


def test_a_folder_without_a_description_is_named(tmp_path: Path) -> None:
    assert f"no robot.toml in {tmp_path}" in refusal(tmp_path)


def test_a_description_that_is_no_text_is_named(tmp_path: Path) -> None:
    (write_robot(tmp_path) / "robot.toml").write_bytes(b'name = "\xff"')
    assert "robot.toml: not UTF-8" in refusal(tmp_path)


def test_a_path_is_never_taken_for_a_built_in_name(tmp_path: Path) -> None:
    (tmp_path / "delta").mkdir()
    write_robot(tmp_path / "delta")
    assert load_robot(Path("delta"), relative_to=tmp_path).name == "slider"
    assert load_robot("./delta", relative_to=tmp_path).name == "slider"
    assert load_robot("delta", relative_to=tmp_path).name == "delta"


FIVE_BAR = built_in_robots()["five_bar"]


def test_of_more_motors_than_degrees_of_freedom_the_first_ones_are_independent(tmp_path: Path) -> None:
    (tmp_path / "five_bar.xml").write_bytes((FIVE_BAR / "five_bar.xml").read_bytes())
    text = (FIVE_BAR / "robot.toml").read_text(encoding="utf-8")
    third = '[[actuators]]\njoint = "left_elbow"\ngain = 1.0\ngain_unit = "N*m/A"\n\n[tool]'
    (tmp_path / "robot.toml").write_text(text.replace("[tool]", third), encoding="utf-8")
    robot = load_robot(tmp_path)
    assert (robot.joints, robot.driven) == (("left", "right"), ("left", "right", "left_elbow"))
    first, second, third = re.split(
        r"(?=\[\[actuators\]\])", (tmp_path / "robot.toml").read_text(encoding="utf-8")
    )[1:]
    third, tool = third.split("[tool]")
    (tmp_path / "robot.toml").write_text(
        f'name = "five_bar"\nmodel = "five_bar.xml"\n{third}{first}{second}[tool]{tool}', encoding="utf-8"
    )
    assert load_robot(tmp_path).driven == ("left_elbow", "left", "right")
