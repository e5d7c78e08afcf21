"""A log in the place of a recording that a dataset has: the way back after a wrong import."""

from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.joint_facts import joint_facts
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.importing import LogRequest, import_log
from bench.dataset.robot import load_robot

COUNT = 1000
MAP = LogMap(
    {"time": "t"}
    | {
        f"{kind}.{joint}": f"{letter}_{joint}"
        for kind, letter in (("position", "q"), ("current", "i"))
        for joint in ("left", "right")
    }
)


def write_log(path: Path, current: float = 1.0, *, gap: float = 0.0) -> Path:
    """A log of 10 s; gap: s that are lost in its middle."""
    time = np.arange(COUNT) / 100.0
    time[COUNT // 2 :] += gap
    rng = np.random.default_rng(1)
    columns = {"t": time}
    for joint in joint_facts(load_robot("five_bar")):
        columns[f"q_{joint.name}"] = joint.home + 0.3 * np.sin(2.0 * time)
        columns[f"i_{joint.name}"] = current * np.cos(3.0 * time) + 0.01 * rng.normal(size=COUNT)
    np.savez(path, **columns)
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A dataset of two recordings, of which the second has the wrong mass and another window than it should."""
    out = tmp_path / "data"
    for name, payload in (("free", []), ("held", ["--payload", "disc", "--payload-mass", "2.5"])):
        log = write_log(tmp_path / f"{name}.npz")
        words = [word for pair in MAP.columns.items() for word in ("--map", "=".join(pair))]
        assert main(["import", str(log), "--robot", "five_bar", *words, *payload, "-o", str(out)]) == 0
    toml = out / "dataset.toml"
    toml.write_text("# by hand\n" + toml.read_text() + "window = [[0.0, 5.0]]  # the first half\n")
    return out


def command(folder: Path, *options: str, gap: float = 0.0) -> int:
    """Import the second log of the folder's anew."""
    log = write_log(folder.parent / "held.npz", current=3.0, gap=gap)
    words = [word for pair in MAP.columns.items() for word in ("--map", "=".join(pair))]
    return main(["import", str(log), "--robot", "five_bar", *words, *options, "-o", str(folder)])


def test_a_recording_and_its_payload_are_replaced_where_they_stand(folder: Path, capsys) -> None:
    (folder / "dataset.toml").write_text(
        (folder / "dataset.toml").read_text()
        + '[[recordings]]\nfile = "free-2.csv"\nuse = "validate"\npayload = "disc"\n'
    )
    shorter = (folder / "free.csv").read_text().splitlines()[:-1]
    (folder / "free-2.csv").write_text("\n".join(shorter) + "\n")
    capsys.readouterr()
    assert command(folder, "--payload", "disc", "--payload-mass", "0.5", "--replace") == 0
    assert "the payload disc was 2.5 kg and is 0.5 kg now, in free-2.csv as well" in capsys.readouterr().out
    data = load_dataset(folder)
    assert [recording.name for recording in data.recordings] == ["free.csv", "held.csv", "free-2.csv"]
    assert data.payloads["disc"].mass == 0.5
    held = data.recordings[1]
    assert len(held.time) == COUNT
    assert np.abs(held.current).max() > 2.5
    assert (folder / "dataset.toml").read_text().startswith("# by hand\n")
    assert sorted(path.name for path in folder.iterdir()) == [
        "dataset.toml",
        "free-2.csv",
        "free.csv",
        "held.csv",
    ]


def test_without_replace_nothing_changes_and_the_way_is_told(folder: Path, capsys) -> None:
    before = {path: path.read_bytes() for path in folder.iterdir()}
    assert command(folder, "--payload", "disc") == 2
    assert "--replace to replace it by this log" in capsys.readouterr().err
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


@pytest.mark.parametrize("broken", ["write_text_atomically", "write_table"])
def test_what_is_replaced_stays_where_the_new_one_cannot_be_written(
    folder: Path, broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_arguments: object) -> None:
        raise BenchError("the disk is full")

    before = {path: path.read_bytes() for path in folder.iterdir()}
    monkeypatch.setattr(f"bench.dataset.logs.importing.{broken}", fail)
    request = LogRequest(write_log(folder.parent / "held.npz", current=3.0), MAP, payload="disc")
    with pytest.raises(BenchError, match="the disk is full"):
        import_log("five_bar", request, folder, replace=True)
    assert {path: path.read_bytes() for path in folder.iterdir()} == before


def test_a_file_that_no_recording_names_is_not_replaced(folder: Path, capsys) -> None:
    (folder / "notes.csv").write_text("mine")
    assert command(folder, "--name", "notes.csv", "--payload", "disc", "--replace") == 2
    assert "dataset.toml does not list it" in capsys.readouterr().err
    assert (folder / "notes.csv").read_text() == "mine"


def test_pieces_of_an_earlier_import_are_told_and_stay(folder: Path, capsys) -> None:
    capsys.readouterr()
    assert command(folder, "--payload", "disc", "--split-gaps", "--replace", gap=1.0) == 0
    said = capsys.readouterr().out
    assert "dataset.toml: held.csv stays as it was: delete pieces of held.npz from an earlier import" in said
    assert command(folder, "--payload", "disc", "--split-gaps", "--replace", gap=2.0) == 0
    assert "held.csv stays as it was" in capsys.readouterr().out
    assert command(folder, "--payload", "disc", "--replace") == 0
    said = capsys.readouterr().out
    assert "dataset.toml: held-1.csv, held-2.csv stay as they were: " in said
    assert "free" not in said
    held = ["held.csv", "held-1.csv", "held-2.csv"]
    assert [recording.name for recording in load_dataset(folder).recordings] == ["free.csv", *held]


def test_a_log_that_is_cut_as_before_leaves_nothing_to_tell(folder: Path, capsys) -> None:
    assert command(folder, "--payload", "disc", "--replace") == 0
    assert "stay" not in capsys.readouterr().out
