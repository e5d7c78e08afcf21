"""Scenario files: what they may say, how they build on each other, and how mistakes in them are told."""

import json

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.catalogue import built_in_scenarios
from bench.scenario.scenario import (
    TOLERANCES,
    home_position,
    load_scenario,
    payload_declared,
    payload_truth,
    per_joint,
    resolve_trajectories,
)
from bench.scenario.trajectory import random_trajectory

MINIMAL = """
robot = "five_bar"
[[recordings]]
name = "one"
use = "identify"
design = { span = 0.3, velocity_limit = 2.0 }
"""


@pytest.fixture
def write(tmp_path):
    def write_file(text, name="mine.toml"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write_file


@pytest.mark.parametrize("name", built_in_scenarios())
def test_every_built_in_scenario_loads_and_has_its_trajectories(name):
    scenario = load_scenario(name)
    trajectories = resolve_trajectories(
        scenario,
        lambda s, recordings: {
            r.name: random_trajectory(
                0,
                home_position(s.robot),
                per_joint(r.design.span, s.robot.joints),
                per_joint(r.design.velocity_limit, s.robot.joints),
            )
            for r in recordings
        },
    )
    assert list(trajectories) == [recording.name for recording in scenario.settings.recordings]
    assert {recording.use for recording in scenario.settings.recordings} == {"identify", "validate"}
    assert scenario.settings.tolerances.keys() <= TOLERANCES.keys()


def test_a_minimal_file_is_filled_up_with_defaults(write):
    scenario = load_scenario(write(MINIMAL))
    assert scenario.name == "mine"
    assert scenario.robot.name == "five_bar"
    assert scenario.log_every == 4
    assert scenario.log_period == 0.001
    trajectory = resolve_trajectories(scenario)["one"]
    np.testing.assert_array_equal(trajectory.center, home_position(scenario.robot))


def test_a_scenario_builds_on_another_one_in_another_folder(write, tmp_path):
    (tmp_path / "sub").mkdir()
    write(
        MINIMAL
        + "\n[sensors]\nencoder_bits = 18\ntime_jitter = 1e-5\n"
        + "[design]\nharmonics = 3\n[tolerances]\ngain_error = 0.1\n",
        "base.toml",
    )
    child = tmp_path / "sub" / "child.toml"
    child.write_text(
        'base = "../base.toml"\nseed = 7\n[sensors]\nencoder_bits = 0\nencoder_resolution = 1e-4\n'
        "[tolerances]\nloop_gap = 1e-6\n"
    )
    settings = load_scenario(child).settings
    assert settings.seed == 7
    assert settings.sensors.encoder_bits == 0
    assert settings.sensors.encoder_resolution == 1e-4
    assert settings.sensors.time_jitter == 1e-5
    assert settings.recordings[0].design.harmonics == 3
    assert dict(settings.tolerances) == {"loop_gap": 1e-6}


def test_overrides_come_last(write):
    overrides = {"seed": 3, "controller": {"natural_frequency": 5.0}}
    settings = load_scenario(write(MINIMAL), overrides).settings
    assert settings.seed == 3
    assert settings.controller.natural_frequency == 5.0


def test_a_trajectory_is_read_from_a_file_beside_the_scenario(write):
    trajectory = random_trajectory(1, [-2.35, -0.79], 0.2, 1.0)
    write(json.dumps(trajectory.to_dict()), "motion.json")
    text = MINIMAL.replace("design = { span = 0.3, velocity_limit = 2.0 }", 'trajectory_file = "motion.json"')
    read = resolve_trajectories(load_scenario(write(text)))["one"]
    np.testing.assert_array_equal(read.a, trajectory.a)


def test_designed_trajectories_come_from_the_designer_together(write):
    text = MINIMAL + MINIMAL.split('"five_bar"')[1].replace("one", "two")
    text = text.replace("span = 0.3", "span = 0.3, optimise = true")
    scenario = load_scenario(write(text))
    with pytest.raises(BenchError, match="'one' requests an optimised trajectory"):
        resolve_trajectories(scenario)
    asked = []

    def designer(given, recordings):
        asked.append([recording.name for recording in recordings])
        return {r.name: random_trajectory(9, home_position(given.robot), 0.1, 1.0) for r in recordings}

    assert set(resolve_trajectories(scenario, designer)) == {"one", "two"}
    assert asked == [["one", "two"]]


def test_what_is_declared_of_a_payload_may_differ_from_the_truth(write):
    text = MINIMAL + (
        "[payloads.disc]\nmass = 0.5\ncenter_of_mass = [0, 0, 0.1]\n[payloads.disc.declared]\nmass = 0.6\n"
    )
    table = load_scenario(write(text)).settings.payloads["disc"]
    assert payload_truth("disc", table).mass == 0.5
    declared = payload_declared("disc", table)
    assert declared.mass == 0.6
    assert declared.center_of_mass is None


def test_per_joint_values_follow_the_order_of_the_robot():
    np.testing.assert_array_equal(per_joint({"b": 2.0, "a": 1.0}, ("a", "b")), [1.0, 2.0])
    np.testing.assert_array_equal(per_joint(3, ("a", "b")), [3.0, 3.0])


MISTAKES = {
    "unknown key": ("sed = 3\n" + MINIMAL, "sed: unknown key"),
    "no robot": (MINIMAL.replace("robot", "#"), "robot: missing"),
    "no such robot": (MINIMAL.replace("five_bar", "six_bar"), "six_bar"),
    "wrong use": (MINIMAL.replace("identify", "fit"), r"recordings\[0\].use"),
    "name that is no file name": (MINIMAL.replace('"one"', '"a/b"'), r"recordings\[0\].name"),
    "two of a name": (MINIMAL + MINIMAL.split('"five_bar"')[1], "'one' is used twice"),
    "no trajectory": (MINIMAL.replace("design", "#"), "one of trajectory"),
    "no limits": (MINIMAL.replace("span = 0.3,", ""), r"recordings\[0\].design.span: missing"),
    "two kinds of gain": (MINIMAL + "[gains]\ntrue = 3.0\nerror = 0.1\n", "only one of true and error"),
    "gain of no joint": (
        MINIMAL + "[gains.error]\nleft = 0.1\nmiddle = 0.1\n",
        "gains.error: no actuated joint",
    ),
    "gain of one joint": (MINIMAL + "[gains.error]\nleft = 0.1\n", "gains.error: joint 'right' is missing"),
    "text for a number": (MINIMAL + '[gains]\nerror = "much"\n', "gains.error: should be a number"),
    "negative noise": (MINIMAL + "[sensors]\nposition_noise = -1.0\n", "sensors.position_noise"),
    "kp alone": (MINIMAL + "[controller]\nkp = 10.0\n", "kp and kv"),
    "unknown metric": (MINIMAL + "[tolerances]\ngain_eror = 0.1\n", "tolerances.gain_eror: no such metric"),
    "unknown payload": (
        MINIMAL + '[[recordings]]\nname = "two"\nuse = "identify"\npayload = "x"\n'
        "design = { span = 0.3, velocity_limit = 2.0 }\n",
        "payload: 'x' is not defined",
    ),
    "impossible payload": (
        MINIMAL + "[payloads.p]\nmass = 1.0\ninertia = [1.0, 1.0, 3.0, 0, 0, 0]\n",
        "payloads.p.inertia: .*triangle",
    ),
    "log between two steps": ("log_rate = 1500.0\n" + MINIMAL, "log_rate: .*whole number of steps"),
    "no TOML": (MINIMAL + "[gains\n", "not valid TOML"),
    "base that does not exist": ('base = "nothing"\n', "neither a built-in scenario"),
    "base of itself": ('base = "mine.toml"\n', "leads back"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_told_in_one_line_with_file_and_key(write, mistake):
    text, told = MISTAKES[mistake]
    path = write(text)
    with pytest.raises(BenchError, match=told) as raised:
        load_scenario(path)
    assert "\n" not in str(raised.value)


def test_trajectory_for_another_number_of_joints_is_refused(write):
    write(json.dumps(random_trajectory(1, [0.0], 0.2, 1.0).to_dict()), "motion.json")
    text = MINIMAL.replace("design = { span = 0.3, velocity_limit = 2.0 }", 'trajectory_file = "motion.json"')
    scenario = load_scenario(write(text))
    with pytest.raises(BenchError, match="'one' is for 1 joints, the robot has 2"):
        resolve_trajectories(scenario)


def test_missing_scenario_names_the_built_in_ones():
    with pytest.raises(BenchError, match="five_bar"):
        load_scenario("no_such_scenario")
