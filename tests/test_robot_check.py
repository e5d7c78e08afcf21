"""`bench robot check`: what it finds is right, and it says so in a table, in JSON and in one line."""

import functools
import json
import re
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from bench.cli import main
from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.dataset.robot_drawing import home_gap
from bench.document.terminal.robot import joints_table
from bench.model.geometry import read_geometry
from bench.model.mobility import smallest_singular_values
from bench.model.states import random_motion
from bench.robot_check.check import check_robot
from bench.robot_check.features import notes
from bench.robot_check.loops import check_constraints
from bench.robot_check.machine import make_machine, random_open_poses
from bench.robot_check.mobility import amplification
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.report import loop_lines
from bench.robot_check.singularity import singularity_of, sweep
from bench.robot_check.words import WORDS, detail_of, name_of
from tests.broken_robots import HOME, add_motor, edit, edit_mjcf, write_five_bar
from tests.mechanisms import BALL
from tests.mechanisms import write_robot as mechanism
from tests.small_robots import OTHER_WELDS, SERIAL, spatial, welded, write_robot


@pytest.fixture
def linkage(tmp_path):
    return write_five_bar(tmp_path / "linkage")


def failures(report):
    return [(name_of(check), detail_of(check)) for check in report.failures]


def verdict(report, name):
    return next(check for check in report.checks if name_of(check) == name)


# --- good robots --------------------------------------------------------------------------------------------


@functools.cache
def checked(name):
    """The report of a built-in robot."""
    return check_robot(load_robot(name))


@pytest.mark.parametrize("name", built_in_robots())
def test_built_in_robots_pass(name):
    report = checked(name)
    assert failures(report) == []
    assert all(loop.gap < 1e-9 for loop in report.loops)
    assert len(report.base.names) > 0


@pytest.mark.parametrize(
    ("name", "tree", "equations", "rank", "motors"), [("five_bar", 4, 3, 2, 2), ("delta", 21, 18, 18, 3)]
)
def test_degrees_of_freedom(name, tree, equations, rank, motors):
    found = checked(name).mobility
    assert (found.tree, found.equations, found.rank, found.motors) == (tree, equations, rank, motors)
    assert found.remaining == motors


@pytest.mark.parametrize("name", OTHER_WELDS)
def test_welds_slides_and_free_bodies_pass(name, tmp_path):
    report = check_robot(welded(tmp_path / "robot", OTHER_WELDS[name]))
    assert failures(report) == []
    assert report.mobility.remaining == 2
    assert report.loops[0].kind == "weld"
    assert max(report.loops[0].gap, report.loops[0].twist) < 1e-9


def test_ball_joints_and_loops_in_space_pass(tmp_path):
    report = check_robot(spatial(tmp_path / "robot"))
    assert failures(report) == []
    assert (report.mobility.tree, report.mobility.rank) == (7, 6)


def test_serial_robot_passes(tmp_path):
    report = check_robot(write_robot(tmp_path / "r", SERIAL, {"shoulder": "N*m/A", "elbow": "N*m/A"}))
    assert failures(report) == []
    assert (report.loops, report.singularity, report.mobility.remaining) == ((), None, 2)


def test_joint_lines(linkage):
    left, elbow, *_ = check_robot(load_robot(linkage)).joints
    assert (left.name, left.kind, left.parent, left.actuated) == ("left", "hinge", "world", True)
    assert (left.lower, left.upper, left.home) == (-3.3, -1.5, -2.35)
    assert (elbow.name, elbow.parent, elbow.actuated, elbow.lower) == (
        "left_elbow",
        "left_crank",
        False,
        None,
    )


def test_masses_of_the_mjcf_change_nothing_but_the_mass(tmp_path):
    light, heavy = (write_five_bar(tmp_path / name) for name in ("light", "heavy"))
    edit_mjcf(heavy, ('<geom fromto="0 0 0 0.3 0 0"/>', '<geom fromto="0 0 0 0.3 0 0" mass="7"/>'))
    one, other = (check_robot(load_robot(folder)) for folder in (light, heavy))
    assert failures(one) == failures(other) == []
    assert verdict(one, "total mass").values["mass"] < verdict(other, "total mass").values["mass"]
    assert one.singularity == other.singularity
    np.testing.assert_array_equal(one.base.grouping, other.base.grouping)


def test_a_body_of_many_tonnes_is_noted(linkage):
    edit_mjcf(linkage, ('<geom fromto="0 0 0 0.3 0 0"/>', '<geom fromto="0 0 0 0.3 0 0" mass="20000"/>'))
    (note,) = (c for c in check_robot(load_robot(linkage)).checks if c.code == CheckCode.MASSES_LARGE)
    assert note.verdict == "note"
    assert "2e+04 kg" in detail_of(note)


# --- home ---------------------------------------------------------------------------------------------------


def test_gap_is_the_distance_of_the_halves(linkage):
    edit_mjcf(
        linkage, ('<site name="right_tip" pos="0.3 0 0"/>', '<site name="right_tip" pos="0.3 0.002 0"/>')
    )
    machine = make_machine(read_geometry(load_robot(linkage)))
    (line,) = loop_lines(machine)
    assert line.gap == pytest.approx(0.002, rel=1e-9)
    assert line.bodies == ("left_rod", "right_rod")


def test_twist_of_a_weld(tmp_path):
    geometry = read_geometry(welded(tmp_path / "robot"))
    home = geometry.home.copy()
    quaternion = np.empty(4)
    mujoco.mju_mulQuat(quaternion, home[[7 + 1, 5, 6, 7]], [np.cos(0.05), np.sin(0.05), 0, 0])
    home[5:9] = np.roll(quaternion, -1)
    (line,) = loop_lines(make_machine(replace(geometry, home=home)))
    assert line.twist == pytest.approx(0.1, rel=1e-9)


def test_the_pose_that_is_proposed_is_assembled(linkage):
    edit_mjcf(linkage, (HOME, "-2.35 1.3 -0.79 -1.3"))
    report = check_robot(load_robot(linkage))
    (found,) = report.failures
    edit_mjcf(linkage, ("-2.35 1.3 -0.79 -1.3", re.search(r'qpos="(.*?)"', detail_of(found)).group(1)))
    assert failures(check_robot(load_robot(linkage))) == []


def test_a_home_is_searched_from_several_starts(linkage):
    """Newton's method does not close the rods from where they lie back on the cranks; the key that is printed works."""
    left, _, right, _ = HOME.split()
    rough = f"{left} 3 {right} 3"
    edit_mjcf(linkage, (HOME, rough))
    (found,) = check_robot(load_robot(linkage)).failures
    assert found.code == CheckCode.HOME_OPEN
    edit_mjcf(linkage, (f'qpos="{rough}"', re.search(r'qpos=".*?"', detail_of(found)).group()))
    assert failures(check_robot(load_robot(linkage))) == []


def test_distance_from_singularity_does_not_change_with_the_mount(linkage):
    before = check_robot(load_robot(linkage)).singularity
    text = (linkage / "linkage.xml").read_text()
    higher, count = re.subn(r'pos="(-?0\.06) 0 0"', r'pos="\1 0 3"', text)
    assert count == 2
    (linkage / "linkage.xml").write_text(higher)
    after = check_robot(load_robot(linkage)).singularity
    assert after.home == pytest.approx(before.home, rel=1e-9)
    assert after.length == pytest.approx(before.length, rel=1e-9)


def test_a_small_gap_is_rounding_which_is_taken_up_and_said(linkage):
    edit_mjcf(linkage, (HOME, HOME.replace("1.5113606206690187 ", "1.51136072 ")))
    report = check_robot(load_robot(linkage))
    assert failures(report) == []
    assert verdict(report, "home assembled").values["gap"] < 1e-12
    (rounded,) = (check for check in report.checks if check.code == CheckCode.DRAWING_ROUNDED)
    assert rounded.verdict == "note"
    assert "open by 2.2e-08 m, a rounding" in detail_of(rounded)


@pytest.mark.parametrize(
    ("equality", "unit"),
    [
        ('<weld body1="hand" relpose=".3 1e-7 0 1 0 0 0"/>', "m"),
        ('<weld body1="hand" relpose=".3 0 0 1 0 1e-7 0"/>', "rad"),
        ('<connect body1="hand" body2="arm" anchor="0 0 0"/>', "m"),
        ('<joint joint1="turn" polycoef="1e-7"/>', "rad"),
        ('<joint joint1="slide" polycoef="1e-7"/>', "m"),
        ('<tendon tendon1="both" polycoef="1e-7"/>', "m"),
    ],
)
def test_a_gap_has_the_unit_of_what_is_open(equality, unit):
    """The arm has a slide and a hinge; a hand is on the world beside it."""
    spec = mujoco.MjSpec.from_string(
        f"""<mujoco><worldbody>
        <body name="arm" pos=".3 1e-7 0"><joint name="slide" type="slide"/><joint name="turn"/><geom size=".1"/></body>
        <body name="hand" pos="-.3 0 0"><freejoint/><geom size=".1"/></body></worldbody>
        <tendon><fixed name="both"><joint joint="slide" coef="1"/></fixed></tendon>
        <equality>{equality}</equality></mujoco>"""
    )
    assert home_gap(spec)[1] == unit


def test_the_rounding_of_a_closed_pose_is_printed_as_zero():
    report = check_robot(load_robot("five_bar"))
    first, *rest = report.joints
    table = joints_table(replace(report, joints=(replace(first, home=-3.9e-13), *rest)))
    (home,) = (column for column in table.columns if column.header == "home")
    assert home.cells[0] == 0.0
    assert home.cells[1] == rest[0].home
    met = Check(
        CheckCode.SINGULARITY_WITHIN_RANGES,
        "note",
        {"positions": {"left": 4.81e-7, "right": -0.5}, "units": {}},
    )
    assert "at left 0, right -0.5:" in detail_of(met)


def test_a_robot_without_a_tool_is_noted_with_the_lines_to_add(linkage):
    codes = [check.code for check in notes(load_robot(linkage).mjcf_model(), load_robot(linkage))]
    assert CheckCode.TOOL_MISSING not in codes
    edit(linkage / "robot.toml", ('[tool]\nsite = "tool"\n', ""))
    robot = load_robot(linkage)
    (missing,) = (check for check in notes(robot.mjcf_model(), robot) if check.code == CheckCode.TOOL_MISSING)
    assert "bench excite --payload-mass needs one" in detail_of(missing)
    assert "(sites of the MJCF: base, left_tip, tool, right_tip)" in detail_of(missing)
    assert "the MJCF needs a <site>" in detail_of(replace(missing, values={"sites": []}))


# --- singularities ------------------------------------------------------------------------------------------


def test_nearest_singularity_of_a_five_bar_has_its_rods_in_line(linkage):
    edit_mjcf(
        linkage, ('range="-3.3 -1.5"', 'range="-3.3 -0.2"'), ('range="-1.64 0.16"', 'range="-2.9 0.16"')
    )
    edit_mjcf(linkage, ('pos="-0.06 0 0"', 'pos="-0.15 0 0"'), ('pos="0.06 0 0"', 'pos="0.15 0 0"'))
    edit_mjcf(linkage, (HOME, "-1.8 0.6 -1.34 -0.6"))
    home = re.search(r'qpos="(.*?)"', detail_of(check_robot(load_robot(linkage)).failures[0])).group(1)
    edit_mjcf(linkage, ("-1.8 0.6 -1.34 -0.6", home))
    found = check_robot(load_robot(linkage)).singularity
    assert found.singular_at is not None
    assert set(found.loose) == {"left_elbow", "right_elbow"}
    # the elbows are then as far apart as both rods are long, or meet
    elbows = [
        np.array([x + 0.2 * np.cos(found.singular_at[name]), 0.2 * np.sin(found.singular_at[name])])
        for name, x in (("left", -0.15), ("right", 0.15))
    ]
    apart = np.linalg.norm(elbows[0] - elbows[1])
    assert min(abs(apart - 0.6), apart) < 1e-3


def test_no_singularity_in_narrow_ranges(linkage):
    found = check_robot(load_robot(linkage)).singularity
    assert found.singular_at is None
    assert found.reach == {
        "left": (pytest.approx(-3.3), pytest.approx(-1.5)),
        "right": (pytest.approx(-1.64), pytest.approx(0.16)),
    }
    assert 0 < found.lowest <= found.home


def test_smallest_singular_value_of_a_five_bar_is_that_of_its_rods(linkage):
    """Rods of length l (the robot's length) at an angle a to each other: the columns are two unit vectors."""
    geometry = read_geometry(load_robot(linkage))
    motion = random_motion(geometry, 10, 2)
    left, left_elbow, right, right_elbow = motion.q.T
    between = (left + left_elbow) - (right + right_elbow)
    expected = np.sqrt(1 - np.abs(np.cos(between)))
    np.testing.assert_allclose(smallest_singular_values(geometry, motion.q), expected, atol=1e-12)


@pytest.mark.parametrize("build", [welded, spatial])
def test_amplification_by_finite_differences(build, tmp_path):
    geometry = read_geometry(build(tmp_path / "robot"))
    found = amplification(geometry, geometry.home)
    step = 1e-6
    steps = []
    for sign in (-1, 1):
        target = dict.fromkeys(geometry.robot.joints, 0.0) | {found.motor: sign * step}
        steps.append(followed(geometry, np.array(list(target.values()))))
    speeds = np.abs(velocity_between(geometry, *steps)) / (2 * step)
    passive = speeds[geometry.passive]
    assert np.isclose(passive, found.value, rtol=1e-5).any()


def followed(geometry, move):
    from bench.model.follow import advance, home_pose, make_follower

    follower = make_follower(geometry)
    pose = home_pose(follower)
    return advance(follower, pose, pose.q[geometry.active_configuration] + move)[0].q


def velocity_between(geometry, before, after):
    import pinocchio as pin

    from bench.model.follow import build_tree

    return pin.difference(build_tree(geometry), before, after)


# Rods of half the widest way between the ends of the cranks: they are in line in one pose alone.
IN_LINE = """<mujoco>
  <compiler angle="radian" autolimits="true"/>
  <worldbody>
    <body name="left_crank" pos="-.06 0 0"><joint name="left" axis="0 -1 0" range="2.3 3.8"/><geom size=".03"/>
      <body name="left_rod" pos=".2 0 0"><joint name="left_elbow" axis="0 -1 0"/><geom size=".03" pos=".1 0 0"/>
        <site name="tip" pos="{rod} 0 0"/></body></body>
    <body name="right_crank" pos=".06 0 0"><joint name="right" axis="0 -1 0" range="-.8 .9"/><geom size=".03"/>
      <body name="right_rod" pos=".2 0 0"><joint name="right_elbow" axis="0 -1 0"/><geom size=".03" pos=".1 0 0"/>
        <site name="end" pos="{rod} 0 0"/></body></body>
  </worldbody>
  <equality><connect name="loop" site1="tip" site2="end"/></equality>
  <keyframe><key name="home" qpos="{home}"/></keyframe>
</mujoco>"""


def elbows_in_line(folder, rod):
    left, right = 2.55, 0.53
    ends = [np.array([x + 0.2 * np.cos(a), 0.2 * np.sin(a)]) for x, a in ((-0.06, left), (0.06, right))]
    between = ends[1] - ends[0]
    reach = np.linalg.norm(between) / 2
    along, rise = np.arctan2(between[1], between[0]), np.arccos(reach / rod)
    home = f"{left} {along - rise - left:.17g} {right} {np.pi + along + rise - right:.17g}"
    motors = {"left": "N*m/A", "right": "N*m/A"}
    return write_robot(folder, IN_LINE.format(rod=rod, home=home), motors)


def test_a_singularity_in_a_single_pose_is_found(tmp_path):
    found = check_robot(elbows_in_line(tmp_path / "touching", 0.26)).singularity
    assert found.singular_at is not None
    assert found.singular_at == pytest.approx({"left": np.pi, "right": 0.0}, abs=0.03)
    assert {"left_elbow", "right_elbow"} <= set(found.loose)


def test_rods_a_little_longer_have_none(tmp_path):
    found = check_robot(elbows_in_line(tmp_path / "longer", 0.27)).singularity
    assert found.singular_at is None
    assert found.lowest_at == pytest.approx({"left": np.pi, "right": 0.0}, abs=0.01)


def test_sweep_is_closed_and_seeded(tmp_path):
    geometry = read_geometry(spatial(tmp_path / "robot"))
    swept = sweep(geometry)
    machine = make_machine(geometry)
    assert check_constraints(machine, swept.q).verdict == "ok"
    assert singularity_of(geometry, swept) == singularity_of(geometry, sweep(geometry))


def test_coordinates_there_and_back(tmp_path):
    from bench.model.geometry import from_mujoco, to_mujoco

    geometry = read_geometry(spatial(tmp_path / "robot"))
    for q in random_open_poses(geometry, 3, 1):
        np.testing.assert_allclose(from_mujoco(geometry.joints, to_mujoco(geometry.joints, q[None]))[0], q)


# --- notes --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('name="left_elbow"', 'name="left_elbow" damping="0.1"', ("damping", "left_elbow")),
        ('name="left_elbow"', 'name="left_elbow" stiffness="2"', ("spring", "left_elbow")),
        ('name="left"', 'name="left" frictionloss="0.3"', ("friction", "left")),
        (
            'name="right_elbow"',
            'name="right_elbow" armature="0.1"',
            ("--with passive_rotor_inertia:right_elbow",),
        ),
        (
            "</equality>",
            '<connect name="lock" active="false" body1="left_rod" anchor="0 0 0"/></equality>',
            ("'lock'", "inactive"),
        ),
        (
            "</mujoco>",
            '<actuator><motor name="m" joint="left"/></actuator></mujoco>',
            ("actuators", "robot.toml"),
        ),
        (
            "</mujoco>",
            '<tendon><fixed name="t"><joint joint="left" coef="1"/></fixed></tendon></mujoco>',
            ("tendon 't'",),
        ),
        ('name="right_elbow"', 'name="right_elbow" range="-1.6 -1.4"', ("'right_elbow'", "stop")),
        ('contact="disable"/>', 'contact="disable"/></option><option density="1.2">', ("density",)),
    ],
)
def test_what_the_model_does_not_know_is_told(linkage, old, new, told):
    edit_mjcf(linkage, (old, new))
    report = check_robot(load_robot(linkage))
    assert failures(report) == []
    notes = [detail_of(check) for check in report.checks if check.verdict == "note"]
    assert len(notes) == 1
    assert [text for text in told if text not in notes[0]] == []


def test_a_ball_joint_that_is_turned_too_far_is_told(tmp_path):
    tight = BALL.replace('type="ball"', 'type="ball" range="0 0.05"')
    report = check_robot(mechanism(tmp_path, tight, ("crank",)))
    (check,) = (one for one in report.checks if one.code is CheckCode.PASSIVE_RANGE_LEFT)
    (left,) = check.values["joints"]
    assert left["joint"] == "ball"
    assert (left["lower"], left["upper"]) == (0.0, 0.05)
    assert 0.05 < left["highest"] <= np.pi


def test_a_home_close_to_a_singularity_is_told_or_refused(linkage):
    """Rods that are almost in line: the elbows' speeds grow without bound."""
    edit_mjcf(linkage, ('"-0.06 0 0"', '"-0.15 0 0"'), ('"0.06 0 0"', '"0.15 0 0"'))
    verdicts = []
    for bend in (0.2, 0.01, 0.0005):
        # cranks spread so that the rods make the angle `bend` with the line between the elbows
        crank = np.arccos((0.3 * np.cos(bend) - 0.15) / 0.2)
        home = f"{np.pi + crank:.16g} {np.pi - crank - bend:.16g} {-crank:.16g} {np.pi + crank + bend:.16g}"
        text = re.sub(r'qpos=".*?"', f'qpos="{home}"', (linkage / "linkage.xml").read_text())
        text = re.sub(r' range=".*?"', "", text)
        (linkage / "linkage.xml").write_text(text)
        verdicts.append(verdict(check_robot(load_robot(linkage)), "home is regular").verdict)
    assert verdicts == ["ok", "note", "failed"]


# --- the command --------------------------------------------------------------------------------------------


def test_command_prints_and_writes(linkage, tmp_path, capsys):
    assert main(["robot", "check", str(linkage), "--json", str(tmp_path / "report.json")]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    for text in (
        "linkage",
        "left_elbow",
        "passive",
        "3 N·m/A",
        "tip",
        "left_rod",
        "rank of 3",
        "= 2",
        "nearest",
    ):
        assert text in out, text
    assert "mx(left_crank)" not in out
    answer = json.loads((tmp_path / "report.json").read_text())
    assert answer["ok"] is True
    assert [joint["name"] for joint in answer["joints"]] == ["left", "left_elbow", "right", "right_elbow"]
    assert answer["loops"][0]["gap"] < 1e-9
    counted = {"tree": 4, "equations": 3, "rank": 2, "motors": 2, "spins": 0, "remaining": 2}
    assert answer["degrees_of_freedom"] == counted
    assert {check["verdict"] for check in answer["checks"]} == {"ok"}
    (ranges,) = [check for check in answer["checks"] if check["code"] == "home_within_ranges"]
    assert ranges == {
        "name": "home within ranges",
        "verdict": "ok",
        "detail": "2 of 4 joints have a range",
        "code": "home_within_ranges",
        "values": {"ranged": 2, "joints": 4},
    }
    assert len(answer["base_parameters"]) == 11


def test_every_code_has_its_words():
    assert list(WORDS) == list(CheckCode)


@pytest.mark.parametrize(
    ("code", "values", "words"),
    [
        (
            CheckCode.JOINT_COUNTS_DIFFER,
            {"mujoco": 4, "pinocchio": 3},
            ("joint tree", "MuJoCo has 4 joints, Pinocchio 3"),
        ),
        (
            CheckCode.JOINT_COORDINATES_DIFFER,
            {"joint": "left"},
            ("joint tree", "joint 'left' has different coordinates in Pinocchio"),
        ),
        (
            CheckCode.PLUGINS_NOT_MODELLED,
            {"plugins": 2},
            ("note", "2 MuJoCo plug-ins: the model does not contain them"),
        ),
    ],
)
def test_words_of_what_no_robot_here_has(code, values, words):
    check = Check(code, "note", values)
    assert (name_of(check), detail_of(check)) == words


def test_a_broken_robot_is_told_in_values(linkage):
    edit_mjcf(linkage, ("-3.3 -1.5", "-1.5 1.5"))
    (found,) = check_robot(load_robot(linkage)).failures
    assert found.code is CheckCode.HOME_OUTSIDE_RANGE
    limits = {"lower": -1.5, "upper": 1.5}
    values = {key: value for key, value in found.values.items() if key != "closed_qpos"}
    assert values == {"joint": "left", "home": -2.35, "unit": "rad", **limits}


def test_command_lists_the_base_parameters(capsys):
    assert main(["robot", "check", "five_bar", "--verbose"]) == 0
    assert "mx(left_crank)" in capsys.readouterr().out


def test_command_shows_the_table_before_it_fails(linkage, capsys):
    edit(linkage / "robot.toml", ("gain = 3.0", "gain = 2.0"))
    edit_mjcf(linkage, (HOME, "-2.35 1.3 -0.79 -1.3"))
    assert main(["robot", "check", str(linkage)]) == 2
    out, err = capsys.readouterr()
    assert "left_elbow" in out
    assert "✗" in out
    assert err.startswith("bench: robot linkage: home assembled: loop 'tip' is open by ")


def test_lengths_in_millimetres_are_suspected(tmp_path):
    mjcf = SERIAL.replace('pos=".3 0 0"', 'pos="300 0 0"')
    report = check_robot(write_robot(tmp_path / "r", mjcf, {"shoulder": "N*m/A", "elbow": "N*m/A"}))
    assert any("lengths of up to 300 m" in detail_of(check) for check in report.checks)


def test_a_planar_loop_drawn_off_its_plane_is_told_by_how_much(linkage):
    edit_mjcf(linkage, ('<site name="right_tip" pos="0.3 0 0"', '<site name="right_tip" pos="0.3 0.01 0"'))
    (failure,) = check_robot(load_robot(linkage)).failures
    assert failure.code is CheckCode.HOME_OPEN_AND_NO_CLOSED_POSE
    ((_, apart),) = failure.values["fixed_gaps"].items()
    assert np.linalg.norm(apart) == pytest.approx(0.01)
    assert "move one site or anchor of each loop by that" in detail_of(failure)


def test_the_nearest_singularity_is_without_motors_that_do_not_matter_and_within_a_turn(linkage):
    edit_mjcf(
        linkage,
        ('range="-3.3 -1.5"', 'range="-100 100"'),
        ('range="-1.64 0.16"', 'range="-100 100"'),
        (
            "</worldbody>",
            '<body><joint name="wheel" range="-1 1"/><geom fromto="0 0 0 0.1 0 0"/></body></worldbody>',
        ),
        (f'qpos="{HOME}"', f'qpos="{HOME} 0"'),
    )
    add_motor(linkage, "wheel")
    found = check_robot(load_robot(linkage)).singularity
    assert found.travel["wheel"] == 0.0
    for low, high in found.reach.values():
        assert high - low < 2.0 * np.pi + 1e-9


def test_an_mjcf_without_gravity_is_noted(linkage):
    edit_mjcf(linkage, ("<option>", '<option gravity="0 0 0">'))
    codes = [check.code for check in check_robot(load_robot(linkage)).checks if check.verdict == "note"]
    assert CheckCode.GRAVITY_ZERO in codes
