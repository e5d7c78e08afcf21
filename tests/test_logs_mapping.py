"""Many logs in one call: a mapping file says what is in them; all become recordings, or none."""

from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.logs.mapping_file import import_mapping
from bench.dataset.recording import write_table
from tests.good_data import movement, time_stamps, write_robot

MAPPING = """
robot = "robot"

[columns]
time = "t"
"position.arm" = "qa"
"position.rail" = "qr"
"position.wheel" = "qw"
"current.arm" = "ia"
"current.rail" = "ir"
"current.wheel" = "iw"

[scale]
"position.rail" = "mm"

[payloads.disc]
mass = 0.5
center_of_mass = [0.0, 0.0, 0.02]

[[logs]]
files = "logs/free_*.csv"

[[logs]]
files = ["logs/held.csv"]
payload = "disc"
validate_fraction = 0.25

[[logs]]
files = "logs/check.csv"
use = "validate"
name = "another_day.parquet"
"""


@pytest.fixture
def mapping(tmp_path: Path) -> Path:
    write_robot(tmp_path / "robot")
    (tmp_path / "logs").mkdir()
    for seed, name in enumerate(("free_2", "free_1", "held", "check")):
        position, current = movement(time_stamps(), seed)
        position[:, 1] *= 1e3
        columns = np.column_stack([time_stamps(), position, current])
        names = ("t", "qa", "qr", "qw", "ia", "ir", "iw")
        write_table(tmp_path / "logs" / f"{name}.csv", dict(zip(names, columns.T, strict=True)))
    (tmp_path / "map.toml").write_text(MAPPING, encoding="utf-8")
    return tmp_path / "map.toml"


def test_every_log_becomes_a_recording_with_its_payload(
    mapping: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir("/")  # paths are relative to the mapping file
    assert main(["import", "--mapping", str(mapping), "-o", str(tmp_path / "data")]) == 0
    said = capsys.readouterr().out.splitlines()
    assert said[-1] == f"next: bench identify {tmp_path / 'data'}"
    dataset = load_dataset(tmp_path / "data")
    assert [(one.name, one.use, one.payload) for one in dataset.recordings] == [
        ("free_1.csv", "identify", None),
        ("free_2.csv", "identify", None),
        ("held.csv", "identify", "disc"),
        ("held-validate.csv", "validate", "disc"),
        ("another_day.parquet", "validate", None),
    ]
    np.testing.assert_allclose(dataset.recordings[1].position, movement(time_stamps(), 0)[0], rtol=1e-12)
    assert dataset.payloads["disc"].center_of_mass is not None


FAULTS: dict[str, tuple[tuple[str, str], str]] = {
    "an unknown key": (("use = ", "usage = "), "line 30: logs[2].usage: unknown key"),
    "a like key": (("[[logs]]", "[[recordings]]"), "map.toml: recordings: unknown key: did you mean 'logs'?"),
    "a pattern without a file": (("free_*", "fast_*"), "logs[0].files: no file 'logs/fast_*.csv' in "),
    "a log that is not there": (("held.csv", "heavy.csv"), "logs[1].files: no file 'logs/heavy.csv' in "),
    "one name for two logs": (
        ('files = "logs/free_*.csv"', 'files = "logs/free_*.csv"\nname = "a.csv"'),
        "logs[0].name: 'a.csv' cannot be the name of 2 logs",
    ),
    "a log twice": (
        ('["logs/held.csv"]', '["logs/held.csv", "logs/held.csv"]'),
        "held.csv: two logs would become",
    ),
    "a payload that nobody carries": (('payload = "disc"\n', ""), "payloads.disc: no log carries it"),
    "a payload that is not defined": (
        ('payload = "disc"', 'payload = "disk"'),
        "payloads.disc: no log carries it",
    ),
    "a mass that cannot be": (("mass = 0.5", "mass = -0.5"), "payloads.disc.mass: "),
    "a unit that is none": (('"mm"', '"ells"'), "the scale of position.rail: no unit 'ells'"),
    "a column that is not there": (('"qw"', '"qx"'), "there is no 'qx' for position.wheel"),
    "wrong units": (
        ('"position.rail" = "mm"', ""),
        "free_1.csv: column position.rail ('qr' of the log): looks like millim",
    ),
    "an unknown robot": (('robot = "robot"', 'robot = "robbot"'), "robot 'robbot'"),
    "no log": ((MAPPING[MAPPING.index("[[logs]]") :], ""), "logs: missing"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_what_is_wrong_is_one_line_and_nothing_is_written(name: str, mapping: Path, tmp_path: Path) -> None:
    (old, new), expected = FAULTS[name]
    assert old in MAPPING
    mapping.write_text(MAPPING.replace(old, new), encoding="utf-8")
    with pytest.raises(BenchError) as caught:
        import_mapping(mapping, tmp_path / "data")
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "data").exists()


@pytest.mark.parametrize("words", [["log.csv"], ["--robot", "five_bar"], ["--rate", "100"], ["--no-header"]])
def test_nothing_stands_beside_a_mapping(
    words: list[str], mapping: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["import", "--mapping", str(mapping), "-o", str(tmp_path / "data"), *words]) == 2
    assert "belongs in the mapping file" in capsys.readouterr().err
    assert not (tmp_path / "data").exists()


def test_several_logs_need_a_mapping(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", "a.csv", "b.csv", "--robot", "five_bar"]) == 2
    assert "got 2 logs; --mapping MAP.toml imports several" in capsys.readouterr().err


@pytest.mark.parametrize("words", [[], ["log.csv"], ["--robot", "five_bar"]])
def test_a_log_and_a_robot_are_asked_for(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["import", *words]) == 2
    assert "give a log and --robot, or --mapping" in capsys.readouterr().err
