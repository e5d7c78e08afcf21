"""The command line refuses broken datasets and robots: exit code 2, one line, nothing half-written."""

import os
import tomllib
from pathlib import Path

import numpy as np
import pytest

from bench.cli import main
from bench.dataset.dataset import RecordingEntry, write_dataset_toml
from bench.dataset.recording import write_recording
from tests.broken import BROKEN
from tests.broken_robots import BROKEN_ROBOTS, write_five_bar
from tests.good_data import write_good_dataset, write_robot

OF_THE_ROBOT = [
    name
    for name in BROKEN
    if name.startswith("robot_") and name not in ("robot_key_missing", "robot_unknown")
]


@pytest.fixture
def refused(tmp_path, capsys, monkeypatch):
    """Run `bench ... --json FILE`: it must refuse in one line that names what is expected, and write nothing."""
    monkeypatch.chdir(tmp_path)

    def run(expected, *arguments):
        answers = tmp_path / "answers"
        answers.mkdir()
        before = listing(tmp_path)
        code = main([*map(str, arguments), "--json", str(answers / "answer.json")])
        out, err = capsys.readouterr()
        assert code == 2, out + err
        assert err.startswith("bench: ")
        assert err.count("\n") == 1
        assert "Traceback" not in out + err
        assert [text for text in expected if text not in err] == [], err
        assert listing(tmp_path) == before

    return run


def listing(folder: Path) -> list[str]:
    return sorted(str(Path(root) / name) for root, _, names in os.walk(folder) for name in names)


@pytest.mark.parametrize("name", BROKEN)
def test_identify_refuses_a_broken_dataset(name, tmp_path, refused):
    spoil, expected = BROKEN[name]
    folder = write_good_dataset(tmp_path / "dataset")
    spoil(folder)
    refused(expected, "identify", folder)


@pytest.mark.parametrize("name", OF_THE_ROBOT)
def test_robot_check_refuses_a_broken_description(name, tmp_path, refused):
    spoil, expected = BROKEN[name]
    write_robot(tmp_path / "dataset" / "robot")
    spoil(tmp_path / "dataset")
    refused(expected, "robot", "check", tmp_path / "dataset" / "robot")


@pytest.mark.parametrize("name", BROKEN_ROBOTS)
def test_robot_check_refuses_a_broken_robot(name, tmp_path, refused):
    spoil, expected = BROKEN_ROBOTS[name]
    folder = write_five_bar(tmp_path / "linkage")
    spoil(folder)
    refused(expected, "robot", "check", folder)


@pytest.mark.parametrize("name", sorted(BROKEN_ROBOTS))
def test_identify_refuses_a_broken_robot(name, tmp_path, refused):
    spoil, _ = BROKEN_ROBOTS[name]
    folder = write_five_bar(tmp_path / "robot")
    spoil(folder)
    actuators = tomllib.loads((folder / "robot.toml").read_text())["actuators"]
    write_measurements(tmp_path, [actuator["joint"] for actuator in actuators] or ["left"])
    refused([str(tmp_path) if name == "home_outside_a_range" else "robot"], "identify", tmp_path)


def write_measurements(folder, joints):
    time = np.arange(1500) / 500.0
    home = {"left": -2.35, "right": -0.79, "left_elbow": 1.51}
    waves = np.column_stack([np.sin(2 * np.pi * (0.5 + 0.3 * i) * time) for i in range(len(joints))])
    position = [home.get(joint, 0.0) for joint in joints] + 0.2 * waves
    noise = np.random.default_rng(1).normal(size=waves.shape)
    write_recording(folder / "a.csv", time, position, waves + 0.05 * noise, joints)
    write_dataset_toml(folder, "./robot", [RecordingEntry("a.csv", "identify")], [])


def test_robot_check_names_a_robot_that_is_nowhere(tmp_path, refused):
    refused(["nowhere"], "robot", "check", tmp_path / "nowhere")


def test_the_robot_that_they_spoil_is_good(tmp_path, capsys):
    folder = write_five_bar(tmp_path / "linkage")
    assert main(["robot", "check", str(folder), "--json", str(tmp_path / "answer.json")]) == 0
    assert capsys.readouterr().err == ""
    assert (tmp_path / "answer.json").is_file()


def test_there_are_enough_of_them():
    assert len(BROKEN) + len(BROKEN_ROBOTS) >= 25
