"""The command line refuses broken datasets and robots: exit code 2, one line, nothing half-written."""

import os
from pathlib import Path

import pytest

from bench.cli import main
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


def test_robot_check_names_a_robot_that_is_nowhere(tmp_path, refused):
    refused(["nowhere"], "robot", "check", tmp_path / "nowhere")


def test_the_robot_that_they_spoil_is_good(tmp_path, capsys):
    folder = write_five_bar(tmp_path / "linkage")
    assert main(["robot", "check", str(folder), "--json", str(tmp_path / "answer.json")]) == 0
    assert capsys.readouterr().err == ""
    assert (tmp_path / "answer.json").is_file()


def test_there_are_enough_of_them():
    assert len(BROKEN) + len(BROKEN_ROBOTS) >= 25
