"""Robot files as other people draw them: accepted with a right model, or refused with the culprit and the cure."""

import re

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.mjcf_files import unreadable
from bench.dataset.robot import load_robot
from bench.dataset.robot_toml import mjcf_parts, write_robot_toml
from bench.model import states
from bench.model.model import build_model
from bench.model.nodes import NearSingularError
from bench.model.states import LoosePosesError
from bench.robot_check.check import check_robot
from bench.robot_check.outcome import CheckCode
from bench.robot_check.words import detail_of

INERTIAL = '<inertial pos="0.02 0.01 -0.1" mass="1" diaginertia="0.01 0.01 0.002"/>'
ARM = """<body name="c{i}" pos="{x} 0 1"><joint name="m{i}" axis="0 1 0"/>{inertial}
  <body name="r{i}" pos="0 0 -0.2"><joint name="p{i}" axis="0 1 0"/>{inertial}
    <site name="e{i}" pos="{end} 0 -0.3"/></body></body>"""
OTHER_ARM = ARM.format(i=2, x=0.1, end=-0.1, inertial=INERTIAL)
FIVE_BAR = ARM.format(i=1, x=-0.1, end=0.1, inertial=INERTIAL) + OTHER_ARM
TIPS = '<connect name="tips" site1="e1" site2="e2"/>'


def robot(folder, body, equality=TIPS, motors=("m1", "m2"), compiler='angle="radian"', rest=""):
    folder.mkdir(exist_ok=True)
    path = folder / "robot.xml"
    path.write_text(
        f"<mujoco><compiler {compiler}/><worldbody>{body}</worldbody><equality>{equality}</equality>{rest}</mujoco>"
    )
    write_robot_toml(path, [(motor, 2.0) for motor in motors], overwrite=True)
    return load_robot(folder)


def failures(report):
    return [detail_of(check) for check in report.failures]


def note(report, code):
    return next(detail_of(check) for check in report.checks if check.code == code)


# --- geoms that touch ---------------------------------------------------------------------------------------


def with_elbows(radius):
    """The five-bar with a sphere at each elbow, 0.2 m apart at home."""
    arms = FIVE_BAR
    for side in "12":
        elbow = f'<geom name="elbow{side}" size="{radius}"/>'
        arms = arms.replace(f'<joint name="p{side}"', f'{elbow}<joint name="p{side}"')
    return arms


def test_geoms_that_touch_are_noted_with_what_keeps_them_apart(tmp_path):
    at_home = note(check_robot(robot(tmp_path / "home", with_elbows(0.11))), CheckCode.GEOMS_TOUCH)
    assert at_home.startswith("geoms touch at home: 'elbow1' of r1 and 'elbow2' of r2; ")
    in_motion = note(check_robot(robot(tmp_path / "motion", with_elbows(0.09))), CheckCode.GEOMS_TOUCH)
    assert re.match(r"geoms touch in \d+ of \d+ poses within the ranges: 'elbow1' of r1", in_motion)
    (excluded,) = re.findall("<contact>.*</contact>", at_home)
    codes = [
        check.code
        for check in check_robot(robot(tmp_path / "cured", with_elbows(0.11), rest=excluded)).checks
    ]
    assert CheckCode.GEOMS_TOUCH not in codes


def test_geoms_that_a_pair_lets_collide_need_that_pair_deleted(tmp_path):
    apart = with_elbows(0.11).replace("<geom ", '<geom contype="0" conaffinity="0" ')
    pair = '<contact><pair geom1="elbow2" geom2="elbow1"/></contact>'
    touching = note(check_robot(robot(tmp_path, apart, rest=pair)), CheckCode.GEOMS_TOUCH)
    assert "delete the <pair> of these geoms" in touching
    assert "contype" not in touching


# --- bodies that closures hold still ------------------------------------------------------------------------


def test_a_base_that_an_equality_welds_to_the_world_is_accepted(tmp_path):
    """Its mass moves no motor: what MuJoCo gives for it is rounding, which no base parameter can reproduce."""
    base = f'<body name="base"><freejoint/>{INERTIAL}{FIVE_BAR}</body>'
    report = check_robot(robot(tmp_path / "welded", base, TIPS + '<weld body1="base"/>'))
    assert failures(report) == []
    fixed = check_robot(robot(tmp_path / "fixed", FIVE_BAR))
    assert report.base.names == fixed.base.names


def test_a_weld_turned_by_a_whole_turn_is_accepted(tmp_path):
    """The drawn angles of the chain add up to 360 degrees: MuJoCo's quaternion of the weld has the other sign."""
    side = 0.2
    links = "".join(
        f'<body name="l{i}" pos="{side if i else 0} 0 0" euler="0 0 {turn}"><joint name="j{i}" axis="0 0 1"/>{INERTIAL}'
        for i, turn in enumerate((60, 120, 60, 120))
    )
    chain = links + f'<site name="end" pos="{side} 0 0"/>' + "</body>" * 4
    report = check_robot(
        robot(
            tmp_path / "robot",
            '<site name="start"/>' + chain,
            '<weld site1="start" site2="end"/>',
            motors=("j0",),
            compiler='angle="degree"',
        )
    )
    assert failures(report) == []


# --- files that are missing ---------------------------------------------------------------------------------

MESHES = """<asset><mesh name="crank" file="crank.stl"/><mesh name="rod" file="parts/rod.dae"/>
<texture name="wood" type="2d" file="wood.png"/><material name="wood" texture="wood"/></asset>"""


def drawn(body):
    return body.replace(INERTIAL, f'{INERTIAL}<geom type="mesh" mesh="crank" material="wood"/>', 1)


def test_missing_meshes_and_textures_are_not_needed(tmp_path):
    report = check_robot(robot(tmp_path / "drawn", drawn(FIVE_BAR), rest=MESHES))
    assert failures(report) == []
    said = note(report, CheckCode.FILES_LEFT_OUT)
    assert all(file in said for file in ("crank.stl", "parts/rod.dae", "wood.png"))
    assert report.base.names == check_robot(robot(tmp_path / "plain", FIVE_BAR)).base.names
    (tmp_path / "drawn" / "wood.png").write_text("version https://git-lfs.github.com/spec/v1\n")  # a pointer
    assert failures(check_robot(load_robot(tmp_path / "drawn"))) == []


def test_a_body_whose_mass_is_that_of_a_missing_mesh_is_named(tmp_path):
    body = FIVE_BAR.replace(INERTIAL, '<geom type="mesh" mesh="crank"/>', 1)
    with pytest.raises(
        BenchError, match=r"body 'c1' has no mass .*'crank.stl' cannot be read: add .* <inertial>"
    ):
        robot(tmp_path / "robot", body, rest=MESHES)


def test_shapes_that_make_up_a_mass_are_named_where_some_are_missing(tmp_path):
    body = FIVE_BAR.replace(INERTIAL, '<geom type="mesh" mesh="crank"/><geom size="0.05"/>', 1)
    made = robot(tmp_path / "robot", body, rest=MESHES)
    assert unreadable(made.model_path).bodies == ("c1",)
    assert "masses of 'c1'" in note(check_robot(made), CheckCode.FILES_LEFT_OUT)


def test_other_faults_keep_the_compilers_line(tmp_path):
    path = tmp_path / "robot.xml"
    path.write_text(
        f'<mujoco>\n<asset><mesh name="a" file="a.stl"/></asset>\n<worldbody>{FIVE_BAR}<oops/></worldbody></mujoco>'
    )
    with pytest.raises(BenchError, match=r"robot.xml, line 7: .*oops"):
        mjcf_parts(path)


# --- units --------------------------------------------------------------------------------------------------


def test_ranges_in_radians_in_a_file_in_degrees_are_noted(tmp_path):
    body = FIVE_BAR.replace('name="m1" ', 'name="m1" range="-1.57 1.57" ')
    report = check_robot(robot(tmp_path / "degrees", body, compiler='angle="degree"'))
    assert "the ranges of m1 count as degrees" in note(report, CheckCode.RANGES_IN_DEGREES)
    for meant in (body.replace("1.57", "90"), body):
        angle = "radian" if meant is body else "degree"
        report = check_robot(robot(tmp_path / "robot", meant, compiler=f'angle="{angle}"'))
        assert not any(check.code == CheckCode.RANGES_IN_DEGREES for check in report.checks)


# --- scenes -------------------------------------------------------------------------------------------------


def test_a_mocap_target_that_nothing_holds_is_no_part_of_the_robot(tmp_path):
    target = '<body name="target" mocap="true" pos="1 0 0"/>'
    assert failures(check_robot(robot(tmp_path / "free", FIVE_BAR + target))) == []
    cube = '<body name="cube" pos="1 0 0"><freejoint/><geom size="0.1"/></body>'
    held = robot(tmp_path / "held", FIVE_BAR + target + cube, TIPS + '<weld body1="target" body2="cube"/>')
    assert 'remove mocap="true"' in failures(check_robot(held))[0]


def test_an_object_of_the_scene_is_named_with_the_cure(tmp_path):
    cube = '<body name="cube" pos="1 0 0"><freejoint/><geom size="0.1"/></body>'
    (fault,) = failures(check_robot(robot(tmp_path / "closed", FIVE_BAR + cube)))
    assert "the free joint of body 'cube' can move" in fault
    assert "remove this object of the scene" in fault
    arm = ARM.format(i=1, x=0, end=0, inertial=INERTIAL)
    (fault,) = failures(check_robot(robot(tmp_path / "serial", arm + cube, "", motors=("m1", "p1"))))
    assert "remove this object of the scene" in fault


# --- freedom ------------------------------------------------------------------------------------------------


def test_a_platform_without_a_joint_is_named(tmp_path):
    plate = f'<body name="plate" pos="0 0 0.5">{INERTIAL}<site name="plate"/></body>'
    with pytest.raises(BenchError, match=r"joint 'm1' cannot move .*\('tie'.*body 'plate'.*<freejoint/>"):
        robot(tmp_path / "robot", FIVE_BAR + plate, TIPS + '<connect name="tie" site1="plate" site2="e1"/>')


def test_a_platform_that_one_connect_too_few_holds_is_told(tmp_path):
    plate = f'<body name="plate" pos="0 0 0.5"><freejoint/>{INERTIAL}<site name="plate"/></body>'
    made = robot(tmp_path / "robot", FIVE_BAR + plate, TIPS + '<connect site1="plate" site2="e1"/>')
    (fault,) = failures(check_robot(made))
    assert re.search(
        r"the free joint of body 'plate' can move .* it has no motor, .* a <weld> should hold a frame", fault
    )


# --- home ---------------------------------------------------------------------------------------------------


def test_the_proposed_pose_keeps_the_ranges(tmp_path):
    """qpos0 is closed but outside the range of a motor; the line that is printed is closed and within."""
    body = FIVE_BAR.replace('name="m1" ', 'name="m1" range="0.2 0.9" ')
    (fault,) = failures(check_robot(robot(tmp_path / "robot", body)))
    assert "'m1' is at 0 rad at home, outside its range [0.2, 0.9]" in fault
    key = re.search(r"<key .*/>", fault).group()
    made = robot(tmp_path / "robot", body, rest=f"<keyframe>{key}</keyframe>")
    assert failures(check_robot(made)) == []


def test_a_hinge_counted_from_another_turn_is_proposed_within_its_range(tmp_path):
    body = FIVE_BAR.replace('name="p1" ', f'name="p1" range="0.1 {2 * np.pi}" ')
    (fault,) = failures(check_robot(robot(tmp_path / "robot", body)))
    made = robot(
        tmp_path / "robot", body, rest=f"<keyframe>{re.search(r'<key .*/>', fault).group()}</keyframe>"
    )
    assert failures(check_robot(made)) == []


def turned(angle):
    """The five-bar with one crank drawn in a frame that is turned by about a right angle."""
    crank = f"""<body name="c1" pos="-0.1 0 1" euler="{angle} 0 0"><joint name="m1" axis="0 0 -1"/>{INERTIAL}
      <body name="r1" pos="0 -0.2 0"><joint name="p1" axis="0 0 -1"/>{INERTIAL}<site name="e1" pos="0.1 -0.3 0"/></body>
    </body>"""
    return crank + OTHER_ARM


@pytest.mark.parametrize("angle", ["1.57", "1.571", "1.5707"])
def test_an_angle_with_too_few_digits_is_named(angle, tmp_path):
    report = check_robot(robot(tmp_path / "robot", turned(angle)))
    tilt = next(check for check in report.checks if check.code == CheckCode.NEARLY_PARALLEL)
    assert "'m1' and 'm2'" in detail_of(tilt)
    assert "1.5707963267948966" in detail_of(tilt)
    assert tilt.verdict == "note" or report.failures[0] is tilt


def test_an_angle_with_too_few_digits_is_the_only_reason_that_is_named(tmp_path):
    """The loops cannot be closed in all poses then; times of states that nobody asked for are not named."""
    made = robot(tmp_path / "robot", turned("1.57"), '<connect body1="r1" body2="r2" anchor="0.1 -0.3 0"/>')
    (failure,) = check_robot(made).failures
    assert failure.code is CheckCode.NEARLY_PARALLEL
    with pytest.raises(
        LoosePosesError, match=f"; bench robot check {re.escape(str(tmp_path))}/robot names"
    ) as error:
        build_model(made)
    assert "t = " not in str(error.value)


def test_poses_in_which_joints_are_loose_have_a_remedy_where_no_angle_is_the_reason(tmp_path, monkeypatch):
    def singular(*_):
        raise NearSingularError("t = 14.0000 s: singular")

    monkeypatch.setattr(states, "rates_at", singular)
    (failure,) = check_robot(robot(tmp_path / "robot", FIVE_BAR)).failures
    assert failure.code is CheckCode.POSES_LOOSE
    assert "narrower ranges around home" in detail_of(failure)


def test_an_angle_with_all_digits_is_not(tmp_path):
    report = check_robot(robot(tmp_path / "robot", turned("1.5707963267948966")))
    assert failures(report) == []
    assert all(check.code != CheckCode.NEARLY_PARALLEL for check in report.checks)


def test_a_home_at_the_end_of_a_range_is_noted_with_a_pose_inside(tmp_path):
    """As of grippers, which are drawn open: motions that start at home need room."""
    body = FIVE_BAR.replace('name="m1" ', 'name="m1" range="0 0.8" ')
    report = check_robot(robot(tmp_path / "robot", body))
    said = note(report, CheckCode.HOME_AT_RANGE_END)
    assert "the range of 'm1', 0 to 0.8" in said
    rest = f"<keyframe>{re.search(r'<key .*/>', said).group()}</keyframe>"
    report = check_robot(robot(tmp_path / "robot", body, rest=rest))
    assert failures(report) == []
    assert all(check.code != CheckCode.HOME_AT_RANGE_END for check in report.checks)


def test_a_keyframe_of_another_name_is_noted_and_proposed(tmp_path):
    """qpos0 is open; the keyframe is closed, in an assembly mode that no search from qpos0 would choose."""
    body = FIVE_BAR.replace('pos="-0.1 0 -0.3"', 'pos="-0.1 0 -0.25"')
    (fault,) = failures(check_robot(robot(tmp_path / "robot", body)))
    qpos = re.search(r'qpos="(.*?)"', fault).group(1)
    stand = np.array(qpos.split(), dtype=float) + np.array([0.3, 0.0, -0.3, 0.0])
    rest = f'<keyframe><key name="stand" qpos="{" ".join(map(str, stand))}"/></keyframe>'
    report = check_robot(robot(tmp_path / "robot", body, rest=rest))
    assert "'stand'" in note(report, CheckCode.KEYFRAMES_UNUSED)
    proposed = np.array(re.search(r'qpos="(.*?)"', failures(report)[0]).group(1).split(), dtype=float)
    assert proposed[[0, 2]] == pytest.approx(stand[[0, 2]])


def test_a_body_without_mass_is_named(tmp_path):
    """As of a file whose meshes somebody deleted."""
    with pytest.raises(BenchError, match=r"body 'c1' moves and has no mass .* give it an <inertial>"):
        robot(tmp_path / "robot", FIVE_BAR.replace(INERTIAL, "", 1))


# --- the rank of base parameters ----------------------------------------------------------------------------

TOGGLE = """<body pos="-0.25 0 0.35"><joint name="nut" type="slide" axis="1 0 0" range="-0.05 0.1"/>{inertial}
    <body><joint name="push" axis="0 1 0"/>{inertial}<site name="push_end" pos="0.2 0 0"/></body></body>
  <body pos="0 0 0.6" euler="0 0.1973955598 0"><joint name="top" axis="0 1 0"/>{inertial}
    <site name="knee" pos="0 0 -0.254950976"/>
    <body pos="0 0 -0.254950976" euler="0 -0.3947911197 0"><joint name="bend" axis="0 1 0"/>{inertial}
      <site name="low_end" pos="0 0 -0.254950976"/></body></body>
  <body pos="0 0 0.1"><joint name="ram" type="slide" axis="0 0 1" range="-0.3 0.3"/>{inertial}
    <site name="tip"/></body>"""


def test_where_one_set_of_states_has_an_earlier_gap_the_gap_of_both_decides(tmp_path):
    """A toggle press hardly moves its ram: one singular value is 1e-5 of the largest, next to 1e-13 of rounding."""
    screw = '<actuator><general name="servo" joint="nut" gear="628.3"/></actuator>'
    press = robot(
        tmp_path,
        TOGGLE.format(inertial=INERTIAL),
        '<connect site1="push_end" site2="knee"/><connect site1="low_end" site2="tip"/>',
        ["servo"],
        rest=screw,
    )
    report = check_robot(press)
    assert failures(report) == []
    assert len(report.base.names) == 8
