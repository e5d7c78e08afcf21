"""Broken robots: each a good five-bar with one thing spoilt, and what the check of it must name.

BROKEN_ROBOTS maps a name to (spoil, expected): `spoil(folder)` breaks the robot that `write_five_bar(folder)`
wrote; every text of `expected` must stand in the one line of the error.
"""

from collections.abc import Callable
from pathlib import Path

Spoil = Callable[[Path], None]
BROKEN_ROBOTS: dict[str, tuple[Spoil, tuple[str, ...]]] = {}

# Base 0.12 m, cranks 0.2 m, rods 0.3 m; home is symmetric, the rods meet below.
MJCF = """<mujoco model="linkage">
  <compiler angle="radian" autolimits="true"/>
  <option><flag contact="disable"/></option>
  <default>
    <joint type="hinge" axis="0 -1 0"/>
    <geom type="capsule" size="0.01"/>
  </default>
  <worldbody>
    <site name="base" pos="0 0 0"/>
    <body name="left_crank" pos="-0.06 0 0">
      <joint name="left" range="-3.3 -1.5"/>
      <geom fromto="0 0 0 0.2 0 0"/>
      <body name="left_rod" pos="0.2 0 0">
        <joint name="left_elbow"/>
        <geom fromto="0 0 0 0.3 0 0"/>
        <site name="left_tip" pos="0.3 0 0"/>
        <site name="tool" pos="0.3 0 0"/>
      </body>
    </body>
    <body name="right_crank" pos="0.06 0 0">
      <joint name="right" range="-1.64 0.16"/>
      <geom fromto="0 0 0 0.2 0 0"/>
      <body name="right_rod" pos="0.2 0 0">
        <joint name="right_elbow"/>
        <geom fromto="0 0 0 0.3 0 0"/>
        <site name="right_tip" pos="0.3 0 0"/>
      </body>
    </body>
  </worldbody>
  <equality>
    <connect name="tip" site1="left_tip" site2="right_tip"/>
  </equality>
  <keyframe>
    <key name="home" qpos="-2.35 1.5113606206690187 -0.7915926535897931 -1.5113606206690187"/>
  </keyframe>
</mujoco>
"""

ROBOT = """name = "linkage"
model = "linkage.xml"

[[actuators]]
joint = "left"
gain = 3.0
gain_unit = "N*m/A"

[[actuators]]
joint = "right"
gain = 3.0
gain_unit = "N*m/A"

[tool]
site = "tool"
"""

ACTUATOR = """[[actuators]]
joint = "{joint}"
gain = 3.0
gain_unit = "N*m/A"

"""

HOME = "-2.35 1.5113606206690187 -0.7915926535897931 -1.5113606206690187"


def write_five_bar(folder: Path) -> Path:
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "linkage.xml").write_text(MJCF)
    (folder / "robot.toml").write_text(ROBOT)
    return folder


def edit(path: Path, *changes: tuple[str, str]) -> None:
    text = path.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, f"{old!r} is not in {path}"
        text = text.replace(old, new)
    path.write_text(text, encoding="utf-8")


def edit_mjcf(folder: Path, *changes: tuple[str, str]) -> None:
    edit(folder / "linkage.xml", *changes)


def add_motor(folder: Path, joint: str) -> None:
    edit(folder / "robot.toml", ("[tool]", ACTUATOR.format(joint=joint) + "[tool]"))


def broken(*expected: str) -> Callable[[Spoil], Spoil]:
    def register(spoil: Spoil) -> Spoil:
        BROKEN_ROBOTS[spoil.__name__] = (spoil, expected)
        return spoil

    return register


# --- the home pose ------------------------------------------------------------------------------------------


@broken("linkage", "'tip'", "open by", "m", 'name="home" qpos="-2.35 1.511')
def home_not_assembled(folder: Path) -> None:
    edit_mjcf(folder, (HOME, "-2.35 1.5 -0.7915926535897931 -1.5"))


@broken("'tip'", "open by", "qpos0")
def no_home_and_qpos0_not_assembled(folder: Path) -> None:
    edit_mjcf(folder, ('<key name="home"', '<key name="start"'))


@broken("'tip'", "open by", "this pose closes", "<key")
def rods_too_short_to_meet(folder: Path) -> None:
    edit_mjcf(folder, ('pos="0.3 0 0"', 'pos="0.05 0 0"'))


@broken("'left'", "-2.35", "[-1.5, 1.5]")
def home_outside_a_range(folder: Path) -> None:
    edit_mjcf(folder, ("-3.3 -1.5", "-1.5 1.5"))


@broken("singular", "left_elbow", "right_elbow")
def home_with_the_rods_in_line(folder: Path) -> None:
    # elbows 0.6 m apart, cranks along the base
    edit_mjcf(
        folder,
        ('"-0.06 0 0"', '"-0.1 0 0"'),
        ('"0.06 0 0"', '"0.1 0 0"'),
        (HOME, "-3.141592653589793 3.141592653589793 0 3.141592653589793"),
    )


@broken("linkage.xml", "home")
def two_keyframes_home(folder: Path) -> None:
    edit_mjcf(folder, ("</keyframe>", f'<key name="home" qpos="{HOME}"/></keyframe>'))


@broken("'tip'", "open by", "keyframe home with 2 of 4 positions")
def home_of_too_few_numbers(folder: Path) -> None:
    edit_mjcf(folder, (HOME, "-2.35 1.5"))


# --- motors and degrees of freedom --------------------------------------------------------------------------


@broken("'left_elbow'", "'right_elbow'", "no motor")
def one_motor_too_few(folder: Path) -> None:
    edit(folder / "robot.toml", (ACTUATOR.format(joint="right"), ""))


@broken("'pendulum'", "no motor")
def pendulum_on_a_rod(folder: Path) -> None:
    pendulum = '<body name="bob"><joint name="pendulum"/><geom fromto="0 0 0 0 0 -0.1"/></body>'
    edit_mjcf(
        folder,
        ('<site name="tool" pos="0.3 0 0"/>', f'<site name="tool" pos="0.3 0 0"/>{pendulum}'),
        ("1.5113606206690187 -0.79", "1.5113606206690187 0.1 -0.79"),
    )


@broken("'plate'", "no motor")
def free_body_held_by_nothing(folder: Path) -> None:
    body = '<body name="plate"><freejoint name="loose_platform"/><geom fromto="0 0 0 0 0 -0.1"/></body>'
    edit_mjcf(folder, ("</worldbody>", f"{body}</worldbody>"))


@broken("'left_elbow'", "no motor", "no loop closure")
def loop_left_open(folder: Path) -> None:
    edit_mjcf(folder, ('<connect name="tip" site1="left_tip" site2="right_tip"/>', ""))


@broken("robot.toml", "'shoulder'", "ball")
def motor_on_a_ball_joint(folder: Path) -> None:
    edit_mjcf(folder, ('name="left" range="-3.3 -1.5"', 'name="shoulder" type="ball"'))
    edit(folder / "robot.toml", ('"left"', '"shoulder"'))


@broken("robot.toml", "'left'", "already")
def motor_listed_twice(folder: Path) -> None:
    add_motor(folder, "left")


# --- what only the simulator would know ---------------------------------------------------------------------


@broken("equality 'gears'", "'left'", "'right'", "joint")
def joints_coupled_by_an_equality(folder: Path) -> None:
    edit_mjcf(folder, ("</equality>", '<joint name="gears" joint1="left" joint2="right"/></equality>'))


@broken("equality 'locked'", "'left_elbow'")
def joint_locked_by_an_equality(folder: Path) -> None:
    edit_mjcf(folder, ("</equality>", '<joint name="locked" joint1="left_elbow"/></equality>'))


TENDON = (
    '<tendon><fixed name="belt"{}>'
    '<joint joint="left" coef="1"/><joint joint="right" coef="-1"/>'
    "</fixed></tendon>"
)


@broken("tendon 'belt'", "stiffness")
def tendon_with_a_spring(folder: Path) -> None:
    edit_mjcf(folder, ("</mujoco>", TENDON.format(' stiffness="10"') + "</mujoco>"))


@broken("equality 'taut'", "'left'", "open")
def tendon_of_constant_length(folder: Path) -> None:
    edit_mjcf(
        folder,
        ("</equality>", '<tendon name="taut" tendon1="belt"/></equality>'),
        ("</mujoco>", TENDON.format("") + "</mujoco>"),
    )


@broken("'left_rod'", "gravcomp")
def rod_without_weight(folder: Path) -> None:
    edit_mjcf(folder, ('<body name="left_rod"', '<body name="left_rod" gravcomp="1"'))


@broken("'target'", "mocap")
def mocap_body(folder: Path) -> None:
    edit_mjcf(
        folder,
        ("</worldbody>", '<body name="target" mocap="true"/></worldbody>'),
        ("</equality>", '<weld body1="target" body2="left_rod"/></equality>'),
    )


@broken("flex 'cloth'", "deformable")
def cloth(folder: Path) -> None:
    flex = (
        '<flexcomp name="cloth" type="grid" dim="2" count="3 3 1" spacing=".1 .1 .1" mass="1" radius=".01">'
        '<elasticity young="1e4" thickness="0.01" elastic2d="both"/></flexcomp>'
    )
    edit_mjcf(
        folder,
        ("</worldbody>", f"{flex}</worldbody>"),
        (f'<key name="home" qpos="{HOME}"/>', ""),
    )


@broken("gravity", "disable")
def gravity_switched_off(folder: Path) -> None:
    edit_mjcf(folder, ('contact="disable"', 'contact="disable" gravity="disable"'))


@broken("equality", "disable")
def loops_switched_off(folder: Path) -> None:
    edit_mjcf(folder, ('contact="disable"', 'contact="disable" equality="disable"'))


@broken("weld 'tip'", "torquescale")
def weld_that_holds_no_rotation(folder: Path) -> None:
    edit_mjcf(folder, ("<connect", "<weld"), ('site2="right_tip"', 'site2="right_tip" torquescale="0"'))


# --- names --------------------------------------------------------------------------------------------------


@broken("linkage.xml", "right_peak")
def connect_of_a_site_that_is_not_there(folder: Path) -> None:
    edit_mjcf(folder, ('site2="right_tip"', 'site2="right_peak"'))


@broken("tool", "'base'", "move")
def tool_on_the_world(folder: Path) -> None:
    edit(folder / "robot.toml", ('site = "tool"', 'site = "base"'))


@broken("robot.toml", "'flange'")
def tool_that_is_not_there(folder: Path) -> None:
    edit(folder / "robot.toml", ('site = "tool"', 'site = "flange"'))


@broken("robot.toml", "actuators")
def no_motor(folder: Path) -> None:
    (folder / "robot.toml").write_text('name = "linkage"\nmodel = "linkage.xml"\nactuators = []\n')


@broken("linkage.xml", "mass")
def rod_without_mass(folder: Path) -> None:
    edit_mjcf(folder, ('<geom fromto="0 0 0 0.3 0 0"/>', '<geom fromto="0 0 0 0.3 0 0" mass="0"/>'))
