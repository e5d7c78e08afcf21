"""Which column of a log is which, and in which unit: what names tell, and what is left to the user."""

from dataclasses import replace

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin

from bench.basics.errors import BenchError
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.guess import guesses
from bench.dataset.logs.importing import LogRequest, import_log
from bench.dataset.logs.units import unit_in, units_of
from bench.dataset.robot import load_robot
from bench.local.checks import Mapped, checked
from bench.local.columns import look_at
from tests.good_data import write_robot
from tests.test_logs_ros import samples, write_bag


@pytest.fixture(scope="module")
def robot():
    return load_robot("five_bar")


def guessed(names, robot):
    return {target: (one["column"], one["unit"], one["why"]) for target, one in guesses(names, robot).items()}


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("q_left[deg]", "deg"),
        ("q_left (°)", "deg"),
        ("left.pos.mrad", "mrad"),
        ("q_left", ""),
        ("deg", ""),
        ("i_left_mA", ""),
        ("q_", ""),
    ],
)
def test_a_unit_is_what_a_name_ends_in(name, unit, robot):
    assert unit_in(name, units_of("position.left", robot)) == unit


def test_names_that_hold_the_joint_s_are_its_columns(robot):
    names = [
        "T",
        "Motor Left Position [deg]",
        "Motor Right Position [deg]",
        "Motor Left Current [mA]",
        "i.right",
        "temp",
    ]
    assert guessed(names, robot) == {
        "time": ("T", "", "name"),
        "position.left": (names[1], "deg", "name"),
        "position.right": (names[2], "deg", "name"),
        "current.left": (names[3], "mA", "name"),
        "current.right": ("i.right", "", "name"),
    }


def test_numbered_names_are_taken_in_their_order_and_marked_so(robot):
    assert guessed(["t_us", "q2", "q10", "i1", "i2", "i3"], robot) == {
        "time": ("t_us", "us", "name"),
        "position.left": ("q2", "", "order"),
        "position.right": ("q10", "", "order"),
    }


def test_units_tell_what_is_what_where_the_words_are_not_known(robot):
    names = ["Zeit [ms]", "hoek 1 [deg]", "hoek 2 [deg]", "stroom 1 [mA]", "stroom 2 [mA]"]
    targets = ("time", "position.left", "position.right", "current.left", "current.right")
    found = guesses(names, robot)
    assert {target: one["column"] for target, one in found.items()} == dict(zip(targets, names, strict=True))
    names = ["t", "hoek 1", "hoek 2", "stroom 1", "stroom 2"]
    stated = dict(zip(names, ("ms", "deg", "deg", "mA", "mA"), strict=True))
    found = guesses(names, robot, stated)
    assert {target: one["column"] for target, one in found.items()} == dict(zip(targets, names, strict=True))
    assert set(guesses(names, robot)) == {"time"}


def test_columns_of_a_kind_are_taken_in_their_order_where_there_are_as_many_as_joints(robot):
    names = [
        "Zeit [ms]",
        "Winkel links [deg]",
        "Winkel rechts [deg]",
        "Strom links [mA]",
        "Strom rechts [mA]",
    ]
    found = guesses(names, robot)
    targets = ("position.left", "position.right", "current.left", "current.right")
    assert [found[target]["column"] for target in targets] == names[1:]
    assert {found[target]["why"] for target in targets} == {"order"}
    assert set(guesses([*names[:3], "Winkel Mitte [deg]"], robot)) == {"time"}
    assert set(guesses(["t", "Weg links [mm]", "Weg rechts [mm]"], robot)) == {"time"}  # hinges have no paths


def test_a_current_is_that_of_the_position_that_is_named_alike():
    slide = load_robot("crank_slide")
    names = ["Zeit [ms]", "Winkel links [°]", "Weg rechts [mm]", "Strom links [mA]", "Strom rechts [A]"]
    found = guesses(names, slide)
    assert found["current.crank"] == {"column": "Strom links [mA]", "unit": "mA", "why": "alike"}
    assert found["current.carriage"] == {"column": "Strom rechts [A]", "unit": "A", "why": "alike"}
    same = ["Zeit [ms]", "Winkel [deg]", "Weg [mm]", "Strom a [A]", "Strom b [A]"]
    assert not {"current.crank", "current.carriage"} & guesses(same, slide).keys()


def test_what_is_ambiguous_is_left_open(robot):
    assert guessed(["q_left", "q_left_filtered", "volts", "left", "right"], robot) == {}


def test_a_path_is_of_the_slide_by_its_unit_and_range():
    slide = load_robot("crank_slide")  # a hinge, and a carriage between 0.3 m and 0.6 m
    path, height = np.linspace(350.0, 550.0, 9), np.linspace(10.0, 20.0, 9)
    names = ["Zeit [ms]", "Winkel [deg]", "Weg [mm]", "Strom 1 [A]", "Strom 2 [A]"]
    found = guesses(names, slide)
    assert found["position.crank"] == {"column": "Winkel [deg]", "unit": "deg", "why": "unit"}
    assert found["position.carriage"] == {"column": "Weg [mm]", "unit": "mm", "why": "unit"}
    lengths = {"Weg [mm]": path, "Abstand [mm]": height}
    assert "position.carriage" not in guesses([*names, "Abstand [mm]"], slide)
    found = guesses([*names, "Abstand [mm]"], slide, values=lengths)
    assert found["position.carriage"]["column"] == "Weg [mm]"
    plain = ["Zeit [ms]", "Winkel [deg]", "Weg", "Strom 1 [A]", "Strom 2 [A]"]
    assert guesses(plain, slide)["position.carriage"] == {"column": "Weg", "unit": "", "why": "rest"}
    found = guesses(plain, slide, values={"Weg": path})
    assert found["position.carriage"] == {"column": "Weg", "unit": "mm", "why": "range"}
    axis = load_robot("emps")  # a slide between -0.02 m and 0.28 m
    for factor, unit, why in ((1e3, "mm", "range"), (1.0, "", "order")):
        found = guesses(["t", "Weg", "Strom"], axis, values={"Weg": factor * np.linspace(0.0, 0.25, 9)})
        assert found["position.axis"] == {"column": "Weg", "unit": unit, "why": why}


def test_the_unit_that_a_log_states_is_told_and_kept(tmp_path, robot):
    log = tmp_path / "log.txt"
    time = np.arange(2000) / 1e3
    q = 20.0 * np.sin(3.0 * time) - 130.0
    rows = [f"{t * 1e3:.9g} {a:.9g}" for t, a in zip(time, q, strict=True)]
    log.write_text("\n".join(["t q_left", "ms deg", *rows]))
    look = look_at(str(log), robot)
    assert look["stated"] == {"t": "ms", "q_left": "deg"}
    columns = {"time": "t", "position.left": "q_left"}
    assert all(one["ok"] for one in checked(str(log), robot, Mapped(columns, {})).values())
    found = checked(str(log), robot, Mapped(columns, {"time": "s", "position.left": "rad"}))
    assert found["time"]["problems"][0]["remedy"] == {"unit": "ms"}
    assert found["position.left"]["problems"][0]["remedy"] == {"unit": "deg"}


def test_of_several_topics_of_a_bag_one_is_chosen(tmp_path):
    own = load_robot(write_robot(tmp_path / "robot"))
    both = {"/arm": samples(), "/other": samples()}
    (bag,) = write_bag(tmp_path / "run", StoragePlugin.MCAP, both).glob("*.mcap")
    assert look_at(str(bag), own) == {"topics": ("/arm", "/other")}
    look = look_at(str(bag), own, "/other")
    assert look["topics"] == ("/arm", "/other")
    mapped = Mapped({target: one["column"] for target, one in look["guesses"].items()}, {}, topic="/other")
    assert all(one["ok"] for one in checked(str(bag), own, mapped).values())


def test_a_gap_is_cut_and_a_check_is_accepted_where_asked(tmp_path, robot):
    log = tmp_path / "log.csv"
    time = np.concatenate([np.arange(3000), np.arange(3500, 6500)]) / 1e3
    held = np.clip(
        1.2 * np.sin(5.0 * time) + 0.001 * np.random.default_rng(1).normal(size=time.size), -1.0, 1.0
    )
    rows = [
        f"{t:.9g},{a:.9g},{float('nan') if k == 7 else a}"
        for k, (t, a) in enumerate(zip(time, held, strict=True))
    ]
    log.write_text("\n".join(["time,i,broken", *rows]))
    columns = {"time": "time", "current.left": "i", "current.right": "broken"}
    found = checked(str(log), robot, Mapped(columns, {}))
    assert found["time"]["problems"][0]["remedy"] == {"split_gaps": True}
    assert found["time"]["problems"][0]["where"] == "line 3002"
    assert found["current.left"]["problems"][0]["remedy"] == {"accept": "saturated"}
    assert found["current.right"]["problems"][0]["where"] == "line 9"
    assert found["current.right"]["problems"][0]["remedy"] == {"split_gaps": True}
    again = checked(str(log), robot, Mapped(columns, {}, split_gaps=True, accept=("saturated",)))
    assert [target for target, one in again.items() if one["ok"]] == ["time", "current.left", "current.right"]
    rows[4000] = f"{rows[4000].split(',')[0]},90,0"  # behind what is left out, it keeps its own line
    log.write_text("\n".join(["time,i,broken", *rows]))
    again = checked(str(log), robot, Mapped(columns, {}, split_gaps=True, accept=("saturated",)))
    (spike,) = again["current.left"]["problems"]
    assert (spike["where"], spike["remedy"]) == ("line 4002", {"accept": "spikes"})


def test_a_log_that_begins_anew_is_cut_there_and_each_piece_checked_by_itself(tmp_path, robot):
    log, columns = tmp_path / "log.csv", {"time": "time", "position.left": "q"}
    stamps = np.arange(2500) / 1e3
    rising = 0.3 * np.sin(5.0 * stamps) - 2.4
    stamps, angles = np.tile(stamps, 2), np.concatenate([rising, rising + 0.5])

    def write(times):
        rows = [f"{t:.9g},{q:.9g}" for t, q in zip(times, angles, strict=True)]
        log.write_text("\n".join(["time,q", *rows]))

    write(stamps)
    (back,) = checked(str(log), robot, Mapped(columns, {}))["time"]["problems"]
    assert (back["where"], back["remedy"]) == ("line 2502", {"split_gaps": True})
    assert "0 s goes back: it follows 2.499 s" in back["what"]
    again = checked(str(log), robot, Mapped(columns, {}, split_gaps=True))
    assert all(one["ok"] for one in again.values())  # no jump at the cut
    write(np.floor(stamps * 20) / 20)  # stamps that stand and rise: no piece is a recording
    (rounded,) = checked(str(log), robot, Mapped(columns, {}))["time"]["problems"]
    assert rounded["remedy"] is None
    (left,) = checked(str(log), robot, Mapped(columns, {}, split_gaps=True))["time"]["problems"]
    assert "nothing remains" in left["what"]


def test_torques_are_not_taken_for_currents(tmp_path):
    own = load_robot(write_robot(tmp_path / "robot"))
    units = tuple(
        replace(actuator, gain_unit="N/N" if actuator.joint == "rail" else "N*m/(N*m)")
        for actuator in own.actuators
    )
    log, time = tmp_path / "log.csv", np.arange(500) / 1e3
    log.write_text("\n".join(["time,i", *(f"{t:.9g},{900.0 * np.sin(7.0 * t):.9g}" for t in time)]))
    mapped = Mapped({"time": "time", "current.arm": "i"}, {})
    assert not checked(str(log), own, mapped)["current.arm"]["ok"]
    found = checked(str(log), replace(own, actuators=units), mapped)
    assert found["current.arm"]["problems"] == []


def test_a_unit_is_told_with_the_one_that_was_chosen(tmp_path, robot):
    log = tmp_path / "log.csv"
    log.write_text("\n".join(["t", *(str(1000 * k) for k in range(200))]))  # steps of 1 ms in us
    columns = {"time": "t"}
    for chosen in ("s", "ms"):
        found = checked(str(log), robot, Mapped(columns, {"time": chosen}))["time"]
        assert found["problems"][0]["remedy"] == {"unit": "us"}
    assert checked(str(log), robot, Mapped(columns, {"time": "us"}))["time"]["ok"]


def test_options_by_order_are_marked_and_no_preamble_is_suspected(tmp_path, robot):
    log = tmp_path / "log.csv"
    names = "Zeit [ms];Winkel links [deg];Winkel rechts [deg];Strom links [mA];Strom rechts [mA]"
    log.write_text(names + "\n" + "1;2;3;4;5\n" * 5, encoding="utf-8")
    with pytest.raises(BenchError, match="by their names and their order these may be right") as caught:
        import_log(robot, LogRequest(log, LogMap({}, {})), tmp_path / "data")
    assert "--map current.right='Strom rechts [mA]'" in str(caught.value)
    assert "preamble" not in str(caught.value)
