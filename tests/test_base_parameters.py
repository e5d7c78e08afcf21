"""Base parameters do not hang on chance: any states give as many, and they alone give MuJoCo's motor torques."""

import re
import shutil
from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.catalogue import built_in_robots
from bench.dataset.robot import load_robot
from bench.model import base as base_module
from bench.model.base import UndecidedRankError, base_parameters, independent_columns
from bench.model.geometry import read_geometry
from bench.model.states import random_motion
from bench.robot_check.agreement import check_base_parameters
from bench.robot_check.machine import make_machine
from bench.robot_check.outcome import Check, CheckCode
from bench.robot_check.words import detail_of
from tests.mechanisms import NAMES, robot_named

# Robots that other people drew: the rank of plain MuJoCo inverse dynamics of random masses.
FOREIGN = {
    "g1_ankle": 42,
    "gep_5bar": 11,
    "jurmy_delta": 61,
    "kangaroo_leg": 49,
    "monoped_fixed": 11,
    "orbita": 27,
    "reachy_mini": 95,
    "spm": 33,
}


def foreign(name, measured_data):
    folder = measured_data / "foreign" / name
    if not folder.is_dir():
        pytest.skip("the robots that other people drew are not with the measured data (set PARABENCH_DATA)")
    return folder


def counts(geometry, monkeypatch, seeds=10):
    """What so many pairs of sets of states decide; each set is in two pairs, and computed once."""
    at, known, numbers = base_module._independent_at, {}, set()

    def once(*given):
        key = given[3:]  # its seed, and how many are wanted at least
        if key not in known:
            known[key] = at(*given)
        return known[key]

    monkeypatch.setattr(base_module, "_independent_at", once)
    for seed in range(seeds):
        monkeypatch.setattr(base_module, "SEEDS", (seed, seed + 1))
        numbers.add(len(base_parameters.__wrapped__(geometry).columns))
    return numbers


@pytest.mark.parametrize("name", sorted({*built_in_robots(), *NAMES}))
def test_ten_seeds_give_one_count(name, tmp_path, monkeypatch):
    geometry = read_geometry(robot_named(name, tmp_path))
    assert counts(geometry, monkeypatch) == {len(base_parameters(geometry).columns)}


@pytest.mark.parametrize("name", FOREIGN)
def test_ten_seeds_give_one_count_on_robots_of_others(name, measured_data, monkeypatch):
    geometry = read_geometry(load_robot(foreign(name, measured_data)))
    assert counts(geometry, monkeypatch) == {FOREIGN[name]}


def test_two_hinges_for_a_ball_have_one_count(measured_data, tmp_path, monkeypatch):
    """A six-legged head whose rods turn in two hinges."""
    folder = tmp_path / "head"
    shutil.copytree(foreign("reachy_mini", measured_data), folder)
    folder.chmod(0o755)
    mjcf = folder / "reachy_mini.xml"
    mjcf.chmod(0o644)
    ball = re.compile(r'<joint axis="0 0 1" name="(passive_[1-6])" type="ball" class="chosen_actuator" />')
    hinges = r'<joint axis="0 1 0" name="\1_y"/><joint axis="0 0 1" name="\1_z"/>'
    text, replaced = ball.subn(hinges, mjcf.read_text())
    assert replaced == 6
    mjcf.write_text(text)
    assert counts(read_geometry(load_robot(folder)), monkeypatch, seeds=5) == {101}


@pytest.mark.parametrize("name", sorted({*built_in_robots(), *NAMES}))
def test_base_parameters_alone_give_the_motor_torques(name, tmp_path):
    geometry = read_geometry(robot_named(name, tmp_path))
    check = check_base_parameters(
        make_machine(geometry), base_parameters(geometry), random_motion(geometry, 10, 7)
    )
    assert check.verdict == "ok"
    assert check.values["difference"] < 1e-8


@pytest.mark.parametrize("name", FOREIGN)
def test_base_parameters_alone_give_the_motor_torques_of_robots_of_others(name, measured_data):
    geometry = read_geometry(load_robot(foreign(name, measured_data)))
    base = base_parameters(geometry)
    check = check_base_parameters(make_machine(geometry), base, random_motion(geometry, 10, 7))
    assert check.verdict == "ok"
    assert check.values["difference"] < max(1e-8, 100.0 * base.neglected)


def test_a_base_parameter_too_few_is_seen():
    """As when one row near a singular pose made real columns look small."""
    geometry = read_geometry(load_robot("five_bar"))
    base = base_parameters(geometry)
    short = replace(base, columns=base.columns[:-1], grouping=base.grouping[:-1], rotors=base.rotors[:-1])
    check = check_base_parameters(make_machine(geometry), short, random_motion(geometry, 10, 7))
    assert check.verdict == "failed"
    assert "right_rod" in detail_of(check)


def test_sets_of_states_that_disagree_are_refused(monkeypatch):
    calls = []

    def one_less_the_second_time(rows, least=0):
        independent = independent_columns(rows, least)
        calls.append(rows)
        return independent if len(calls) == 1 else replace(independent, kept=independent.kept[:-1])

    monkeypatch.setattr(base_module, "independent_columns", one_less_the_second_time)
    with pytest.raises(BenchError, match=r"right_rod.* not decided by random states.* at the motors' joints"):
        base_parameters.__wrapped__(read_geometry(load_robot("five_bar")))


def test_one_large_row_hides_no_column():
    random = np.random.default_rng(1)
    rows = random.normal(size=(60, 5))
    rows[:, 4] = rows[:, 0] - 2.0 * rows[:, 1]
    large = rows.copy()
    large[7] *= 1e7
    for matrix in (rows, large):
        independent = independent_columns(matrix)
        assert independent.kept.tolist() == [0, 1, 2, 3]
        assert np.allclose(independent.dependence[:, 4], [1.0, -2.0, 0.0, 0.0])
        assert independent.neglected == 0.0


def test_slack_of_a_drawing_is_neglected_and_said():
    random = np.random.default_rng(2)
    rows = random.normal(size=(60, 4))
    rows[:, 3] = rows[:, 0] + 1e-7 * rows[:, 3]
    independent = independent_columns(rows)
    assert independent.kept.tolist() == [0, 1, 2]
    assert 1e-9 < independent.neglected < 1e-6


def test_narrower_ranges_are_asked_for_where_the_motor_has_them():
    def cure(**motors):
        values = {"parameters": 8, "difference": 2e-8, "bodies": ["rod"], "motors": motors}
        return detail_of(Check(CheckCode.BASE_PARAMETERS_DIFFER, "failed", values)).partition("; ")[2]

    narrower = "write narrower ranges around home, away from singular poses, at "
    assert cure(left="joint", right="joint") == f"{narrower}the motors' joints"
    assert cure(left="joint", cable="tendon") == f"{narrower}joint 'left' and tendon 'cable'"
    assert "the joint or tendon of motor 'servo', which robot.toml then has to name" in cure(servo="motor")


def test_a_rank_that_no_gap_decides_is_refused():
    """Singular values that fall evenly down to rounding."""
    random = np.random.default_rng(3)
    left, _ = np.linalg.qr(random.normal(size=(60, 12)))
    right, _ = np.linalg.qr(random.normal(size=(12, 12)))
    with pytest.raises(UndecidedRankError):
        independent_columns(left * np.logspace(0, -15, 12) @ right.T)


def test_nearly_dependent_columns_make_no_large_coefficients():
    """Rounded axes: a column that is independent of those before it by 1e-4 is no base parameter where others are."""
    random = np.random.default_rng(4)
    rows = random.normal(size=(60, 4))
    rows = np.hstack((rows[:, :1], rows[:, :1] + 1e-4 * rows[:, 1:2], rows[:, 1:]))
    independent = independent_columns(rows)
    assert independent.kept.tolist() == [0, 2, 3, 4]
    assert np.abs(independent.dependence).max() < 10.0
