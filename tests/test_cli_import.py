"""`bench import`: from a log to a dataset that loads."""

import os
import shutil

import numpy as np
import pytest

from bench import load_dataset, load_robot
from bench.cli import main
from bench.cli.import_log import CHECKS
from bench.dataset.joint_facts import joint_facts
from bench.dataset.recording_checks import CHECKS as KNOWN_CHECKS

COUNT = 1000


@pytest.fixture
def log():
    """What a controller of the five-bar might log, under other names: ten seconds about its home pose."""
    left, right = (joint.home for joint in joint_facts(load_robot("five_bar")))
    time = np.arange(COUNT) / 100.0
    rng = np.random.default_rng(1)
    return {
        "t": time,
        "q1": left + 0.3 * np.sin(2.0 * time),
        "q2": right + 0.3 * np.cos(3.0 * time),
        "i1": 2.0 * np.sin(2.0 * time) + 0.01 * rng.normal(size=COUNT),
        "i2": 1.5 * np.cos(3.0 * time) + 0.01 * rng.normal(size=COUNT),
        "temperature": 20.0 + time,
    }


MAPS = [
    *("--map", "position.left=q1", "--map", "position.right=q2"),
    *("--map", "current.left=i1", "--map", "current.right=i2"),
]


@pytest.fixture
def run(log, tmp_path, monkeypatch):
    """Run `bench import log.npz --robot five_bar ...` in an empty folder; gives the exit code."""
    monkeypatch.chdir(tmp_path)
    np.savez(tmp_path / "log.npz", **log)
    return lambda *arguments: main(["import", "log.npz", "--robot", "five_bar", *arguments])


def test_checks_are_those_of_the_package():
    assert CHECKS == KNOWN_CHECKS


def test_log_becomes_a_dataset(run, log, tmp_path, capsys):
    assert run(*MAPS, "--map", "time=t", "--map", "motor_temperature=temperature") == 0
    out, err = capsys.readouterr()
    assert out.splitlines() == ["wrote log/log.csv (identify)", "next: bench identify log"]
    assert err == ""
    (recording,) = load_dataset(tmp_path / "log").recordings
    np.testing.assert_array_equal(recording.position[:, 1], log["q2"])
    np.testing.assert_array_equal(recording.current[:, 0], log["i1"])
    np.testing.assert_array_equal(recording.extra["motor_temperature"], log["temperature"])


def test_rate_scale_and_a_part_for_validation(run, log, tmp_path, capsys):
    scale = ("--scale", "current.left=0.5", "--validate-fraction", "0.25")
    assert run(*MAPS, "--rate", "200", *scale, "-o", "data", "--name", "run.parquet") == 0
    assert capsys.readouterr().out.splitlines() == [
        "wrote data/run.parquet (identify)",
        "wrote data/run-validate.parquet (validate)",
        "next: bench identify data",
    ]
    fitted, kept = load_dataset(tmp_path / "data").recordings
    assert (fitted.use, kept.use) == ("identify", "validate")
    assert (len(fitted.time), len(kept.time)) == (750, 250)
    assert fitted.rate == pytest.approx(200.0)
    np.testing.assert_array_equal(kept.current[:, 0], 0.5 * log["i1"][750:])


def test_units_are_named_and_hold_for_all_joints(run, log, tmp_path):
    foreign = {**log, "t": 1e3 * log["t"]}
    foreign |= {name: np.rad2deg(log[name]) for name in ("q1", "q2")}
    foreign |= {name: 1e3 * log[name] for name in ("i1", "i2")}
    np.savez(tmp_path / "log.npz", **foreign)
    units = ("--scale", "time=ms", "--scale", "position=deg", "--scale", "current=mA")
    assert run(*MAPS, "--map", "time=t", *units, "-o", "data") == 0
    (recording,) = load_dataset(tmp_path / "data").recordings
    np.testing.assert_allclose(recording.position[:, 0], log["q1"], rtol=1e-12)
    np.testing.assert_allclose(recording.current[:, 1], log["i2"], rtol=1e-12)
    assert recording.rate == pytest.approx(100.0)


@pytest.mark.parametrize(
    ("names", "factor", "cure"),
    [
        (["t"], 1e3, "add --scale time=ms"),
        (["q1", "q2"], 180.0 / np.pi, "add --scale position=deg"),
        (["q1", "q2"], 1e3, "add --scale position=mrad"),
        (["q1", "q2"], 1e-3, "looks 1000 times too small for radians"),
        (["i1", "i2"], 1e6, "(--accept units if that is meant); add --scale current=mA"),
    ],
)
def test_a_wrong_unit_is_told_with_its_cure(run, log, tmp_path, capsys, names, factor, cure):
    np.savez(tmp_path / "log.npz", **{**log, **{name: factor * log[name] for name in names}})
    assert run(*MAPS, "--map", "time=t", "-o", "data") == 2
    err = capsys.readouterr().err
    assert cure in err
    assert "accept =" not in err
    assert not (tmp_path / "data").exists()


def test_a_built_in_robot_is_named_and_another_found_from_the_dataset(run, log, tmp_path, monkeypatch):
    own = tmp_path / "robots" / "mine"
    shutil.copytree(load_robot("five_bar").folder, own)
    for robot, name in ((load_robot("five_bar").folder, "five_bar"), ("robots/mine", "../../robots/mine")):
        folder = tmp_path / "data" / name.rpartition("/")[2]
        assert run(*MAPS, "--map", "time=t", "--robot", str(robot), "-o", str(folder)) == 0
        assert f'robot = "{name}"' in (folder / "dataset.toml").read_text()
        monkeypatch.chdir("/")
        assert load_dataset(folder).robot.joints == ("left", "right")
        monkeypatch.chdir(tmp_path)


def test_payload_is_defined_and_then_named(run, tmp_path):
    common = (*MAPS, "--map", "time=t", "-o", "data")
    assert run(*common, "--name", "a.csv") == 0
    other, third, fourth = (("--scale", f"current={factor}") for factor in (1.01, 1.02, 1.03))
    assert run(*common, *other, "--name", "b.csv", "--payload", "disc", "--payload-mass", "0.5") == 0
    assert run(*common, *third, "--name", "c.csv", "--payload", "disc", "--use", "validate") == 0
    dataset = load_dataset(tmp_path / "data")
    assert [recording.payload for recording in dataset.recordings] == [None, "disc", "disc"]
    assert [recording.use for recording in dataset.recordings] == ["identify", "identify", "validate"]
    assert dataset.payloads["disc"].mass == 0.5
    known = ("--payload-center=0,0,-0.02", "--payload-inertia", "1e-3,1e-3,2e-3,0,0,0")
    bar = ("--name", "d.csv", "--payload", "bar", "--payload-mass", "1")
    assert run(*common, *fourth, *bar, *known) == 0
    bar = load_dataset(tmp_path / "data").payloads["bar"]
    assert bar.center_of_mass.tolist() == [0.0, 0.0, -0.02]
    assert bar.inertia.tolist() == [1e-3, 1e-3, 2e-3, 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("arguments", "culprit"),
    [
        ([*MAPS], "time"),
        ([*MAPS, "--map", "time=clock"], "'clock'"),
        ([*MAPS], "--map time=t (with --scale time=ms where it is in ms)"),
        ([*MAPS[:-1], "current.right=temprature", "--map", "time=t"], "did you mean 'temperature'?"),
        ([*MAPS[:-1], "curent.right=i2", "--map", "time=t"], "did you mean 'current.right'?"),
        ([*MAPS, "--map", "time=t", "--map", "time=t"], "'time' is given twice"),
        ([*MAPS, "--map", "time"], "'time'"),
        ([*MAPS, "--map", "time=t", "--scale", "time=fortnight"], "no unit 'fortnight'"),
        ([*MAPS, "--map", "time=t", "--map", "position.elbow=q1"], "'position.elbow'"),
        ([*MAPS, "--map", "time=t", "--payload-mass", "1"], "--payload"),
        ([*MAPS, "--map", "time=t", "--payload", "disc", "--payload-mass", "-1"], "mass"),
        ([*MAPS, "--map", "time=t", "--payload", "disc"], "disc"),
        ([*MAPS, "--payload", "disc", "--payload-center", "0,0,0"], "need --payload-mass"),
        ([*MAPS, "--payload", "disc", "--payload-mass", "1", "--payload-center", "0,0"], "3 numbers"),
        ([*MAPS, "--payload", "disc", "--payload-mass", "1", "--payload-inertia", "1,1,9,0,0,0"], "inertia"),
        ([*MAPS, "--map", "time=t", "--validate-fraction", "2"], "2"),
        ([*MAPS, "--map", "time=t", "--name", "sub/a.csv"], "sub/a.csv"),
        ([*MAPS, "--map", "time=t", "-o", "log.npz"], "log.npz"),
        ([*MAPS, "--rate", "0"], "rate"),
        ([*MAPS, "--map", "time=t", "--scale", "position.left=57.3"], "position.left"),
    ],
)
def test_mistake_is_one_line_and_writes_nothing(run, capsys, tmp_path, arguments, culprit):
    assert run(*arguments) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("bench: ")
    assert err.count("\n") == 1
    assert culprit in err
    assert os.listdir(tmp_path) == ["log.npz"]


def test_a_mapping_says_what_goes_beside_it(log, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    np.savez("log.npz", **log)
    columns = ["'{}' = '{}'".format(*target.split("=")) for target in (*MAPS[1::2], "time=t")]
    (tmp_path / "map.toml").write_text(
        "\n".join(["robot = 'five_bar'", "[columns]", *columns, "[[logs]]", "files = 'log.npz'", ""])
    )
    assert main(["import", "--mapping", "map.toml", "-o", "data", "-q"]) == 0
    assert capsys.readouterr().out == ""
    assert main(["import", "--mapping", "map.toml", "-o", "data", "--replace"]) == 0
    assert main(["import", "--mapping", "map.toml", "-o", "data", "--rate", "5"]) == 2
    assert "--rate belongs in the mapping file" in capsys.readouterr().err


def test_all_that_is_wrong_with_many_logs_is_told_at_once_with_what_mends_it(log, tmp_path, capsys):
    first = {**log, "t": 1e3 * log["t"], "q1": np.rad2deg(log["q1"]), "i2": 1e6 * log["i2"]}
    second = {name: np.delete(values, slice(300, 400)) for name, values in log.items()}
    second["q2"][700:702] += [3.0, 0.0]
    second["i1"][:] = 1.0
    for name, broken in (("first", first), ("second", second)):
        np.savez(tmp_path / f"{name}.npz", **broken)
    columns = ["'{}' = '{}'".format(*target.split("=")) for target in (*MAPS[1::2], "time=t")]
    lines = ["robot = 'five_bar'", "[columns]", *columns]
    (tmp_path / "map.toml").write_text(
        "\n".join([*lines, "[[logs]]", "files = ['first.npz', 'second.npz']", ""])
    )
    assert main(["import", "--mapping", str(tmp_path / "map.toml"), "-o", str(tmp_path / "data")]) == 2
    told = capsys.readouterr().err.splitlines()
    for name, column, cure in (
        ("first", "time", "--scale time=ms"),
        ("first", "position.left", "--scale position.left=deg"),
        ("first", "current.right", "--scale current.right=mA"),
        ("second", "time", "--split-gaps"),
        ("second", "position.right", "--accept spikes"),
        ("second", "current.left", "--accept constant"),
    ):
        assert any(f"{name}.npz: column {column} " in line and cure in line for line in told), (
            name,
            column,
            told,
        )
    assert all(line.startswith("bench: ") for line in told)
    assert not (tmp_path / "data").exists()
    np.savez(tmp_path / "second.npz", **first)
    assert main(["import", "--mapping", str(tmp_path / "map.toml"), "-o", str(tmp_path / "data")]) == 2
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 3
    assert all(line.endswith("; likewise in second.npz") for line in told)


def test_a_cell_that_is_no_number_hides_nothing_else(log, tmp_path, capsys):
    rows = np.column_stack([log[name] for name in ("t", "q1", "q2", "i1", "i2")]).astype(str)
    rows[500, 4], rows[700, 2] = "ERR", "nan"
    text = "\n".join(["time,position.left,position.right,current.left,current.right", *map(",".join, rows)])
    (tmp_path / "log.csv").write_text(text)
    assert (
        main(["import", str(tmp_path / "log.csv"), "--robot", "five_bar", "-o", str(tmp_path / "data")]) == 2
    )
    text, hole = capsys.readouterr().err.splitlines()
    assert "column current.right, line 502: 'ERR' is not a number" in text
    assert "column position.right, line 702: is 'nan', which is no measurement; add --split-gaps" in hole


def test_logs_of_one_layout_say_it_once(log, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    rows = np.column_stack([1e3 * log["t"], *(log[name] for name in ("q1", "q2", "i1", "i2"))])
    names = ["time", "position.left", "position.right", "current.left", "current.right"]
    lines = [",".join(names), "ms,rad,rad,A,A", *(",".join(map(repr, row)) for row in rows.tolist())]
    for name in ("a", "b", "c"):
        (tmp_path / f"{name}.csv").write_text("\n".join(lines))
    (tmp_path / "map.toml").write_text('robot = "five_bar"\n[[logs]]\nfiles = ["a.csv", "b.csv", "c.csv"]\n')
    assert main(["import", "--mapping", "map.toml", "-o", "data"]) == 0
    told = [
        line for line in capsys.readouterr().out.splitlines() if ": " in line and ".csv" in line.split(":")[0]
    ]
    assert told == [
        "a.csv and 2 more: line 2 is read as units",
        "a.csv and 2 more: time: in ms, as the log says",
    ]
