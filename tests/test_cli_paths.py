"""Paths on the command line that cannot be: refused before anything is computed, and nothing is written."""

import json

import numpy as np
import pytest

from bench.cli import main
from bench.dataset.recording import Recording
from bench.identification.finding_words import sentence
from bench.identification.findings import short_recordings
from bench.signals.settings import FilterSettings
from bench.truth.dataset import write_simulation
from tests.good_data import RATE, write_good_dataset
from tests.test_discriminate import machine, narrow_recordings


@pytest.fixture(scope="module")
def good(tmp_path_factory):
    return write_good_dataset(tmp_path_factory.mktemp("good") / "data")


@pytest.fixture
def refused(tmp_path, capsys, monkeypatch):
    """Run a command that must refuse in one line before it reads any data."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "afile").write_text("something else")

    def never(*_, **__):
        raise AssertionError("the data were read before the path was looked at")

    def run(*arguments, reads=False):
        if not reads:
            monkeypatch.setattr("bench.dataset.dataset.load_dataset", never)
            monkeypatch.setattr("bench.studies.trial.command.run_command", never)
        assert main([*map(str, arguments)]) == 2
        out, err = capsys.readouterr()
        assert out == ""
        assert err.count("\n") == 1
        assert [path.name for path in tmp_path.iterdir()] == ["afile"]
        return err

    return run


@pytest.mark.parametrize("folder", ["afile", "afile/results", "afile/more/results"])
@pytest.mark.parametrize("command", ["identify", "diagnose", "compare", "trial"])
def test_a_folder_of_results_that_is_a_file_is_refused(command, folder, good, refused):
    what = "five_bar" if command == "trial" else good
    assert f"-o {folder}: afile is a file: name a folder" in refused(command, what, "-o", folder)


@pytest.mark.parametrize(
    ("command", "option"),
    [
        ("identify", "--json"),
        ("identify", "--rrd"),
        ("diagnose", "--json"),
        ("diagnose", "--apply"),
        ("compare", "--json"),
        ("report", "-o"),
    ],
)
def test_a_file_in_a_folder_that_is_not_there_is_refused(command, option, good, refused):
    err = refused(command, good, option, "nodir/result.html")
    assert f"{option} nodir/result.html: there is no folder nodir" in err


@pytest.mark.parametrize("command", ["identify", "diagnose", "compare"])
def test_a_recording_in_place_of_its_dataset_is_told(command, good, refused):
    file = next(good.glob("*.csv"))
    assert f"{file}: is a file: give its folder, the one with the dataset.toml" in refused(
        command, file, reads=True
    )


def recording(name, seconds, use="identify"):
    time = np.arange(int(seconds * RATE) + 1) / RATE
    return Recording(name, use, None, time, np.zeros((len(time), 1)), np.zeros((len(time), 1)))


def test_a_recording_that_is_short_beside_its_filter_is_noted():
    settings = FilterSettings(position_cutoff=60.0, decimation=10)
    assert (
        short_recordings([recording("long.csv", 5.0), recording("checked.csv", 0.8, "validate")], settings)
        == []
    )
    (note,) = short_recordings([recording("long.csv", 5.0), recording("short.csv", 0.8)], settings)
    assert sentence(note).startswith("short.csv lasts 0.8 s, 48 periods of the position filter")
    assert "Record at least 1.9 s" in sentence(note)


def test_the_note_stands_in_the_answers(tmp_path, capsys):
    recordings = [
        one | {"design": one["design"] | {"duration": 0.8, "ramp": 0.2}} for one in narrow_recordings()
    ]
    write_simulation(machine(recordings), tmp_path / "data")
    answer = tmp_path / "model.json"
    assert main(["identify", str(tmp_path / "data"), "--json", str(answer)]) == 0
    assert "periods of the position filter" in " ".join(capsys.readouterr().out.split())
    assert any("periods of the position filter" in note for note in json.loads(answer.read_text())["notes"])


@pytest.fixture
def log(tmp_path_factory):
    file = tmp_path_factory.mktemp("logs") / "my log.csv"
    file.write_text("t,q,i\n0,1,2\n")
    return file


@pytest.mark.parametrize("command", ["identify", "compare", "report", "view"])
def test_a_log_in_place_of_a_dataset_leads_to_its_import(command, log, refused):
    options = ["-o", "page.html"] if command == "report" else []
    err = refused(command, log, *options, reads=True)
    assert f"{log}: is a log, not yet a dataset: `bench import '{log}' --robot ROBOT` makes one of it" in err


def test_a_folder_without_a_dataset_and_a_file_in_place_of_one_are_told(log, refused):
    assert f"{log.parent}: is not a dataset: it has no dataset.toml" in refused(
        "identify", log.parent, reads=True
    )
    assert f"{log}: is a file: name the folder that it is in" in refused("open", log)
