"""Files are whole or not there."""

import os
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.basics.files.atomic import atomic_path, whole_folder, write_json_atomically, write_text_atomically


def test_writes_and_replaces(tmp_path):
    target = tmp_path / "answer.json"
    write_text_atomically(target, "first")
    write_text_atomically(str(target), "second: µ")
    assert target.read_text(encoding="utf-8") == "second: µ"
    assert os.listdir(tmp_path) == ["answer.json"]


@pytest.mark.parametrize("failure", [KeyboardInterrupt, SystemExit, ValueError])
def test_failure_leaves_what_was_there(tmp_path, failure):
    target = tmp_path / "recording.csv"
    target.write_text("old")
    with pytest.raises(failure), atomic_path(target) as partial:
        partial.write_text("ha")
        assert target.read_text() == "old"
        raise failure
    assert target.read_text() == "old"
    assert os.listdir(tmp_path) == ["recording.csv"]


def test_interrupt_leaves_no_new_file(tmp_path):
    with pytest.raises(KeyboardInterrupt), atomic_path(tmp_path / "new.csv") as partial:
        partial.write_text("ha")
        raise KeyboardInterrupt
    assert os.listdir(tmp_path) == []


def test_stand_in_keeps_folder_and_suffix(tmp_path):
    with atomic_path(tmp_path / "motion.v2.parquet") as partial:
        assert partial.parent == tmp_path
        assert partial.suffix == ".parquet"
        assert partial.name.startswith(".")


def test_usual_permissions(tmp_path):
    (tmp_path / "plain").write_text("")
    write_text_atomically(tmp_path / "atomic", "")
    assert (tmp_path / "atomic").stat().st_mode == (tmp_path / "plain").stat().st_mode


def test_symbolic_link_stays(tmp_path):
    (tmp_path / "real").write_text("old")
    (tmp_path / "link").symlink_to(tmp_path / "real")
    write_text_atomically(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "real").read_text() == "new"


def test_device_is_written_directly():
    before = set(os.listdir("/dev"))
    with atomic_path("/dev/null") as partial:
        assert partial == Path("/dev/null")
    assert Path("/dev/null").is_char_device()
    assert set(os.listdir("/dev")) <= before


@pytest.mark.parametrize("where", ["", "file/answer.json", "file/folder/answer.json"])
def test_unwritable_is_told_in_one_line(tmp_path, where):
    (tmp_path / "file").write_text("")
    with pytest.raises(BenchError) as caught:
        write_text_atomically(tmp_path / where, "text")
    assert str(tmp_path / where) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_missing_folders_are_made(tmp_path):
    write_text_atomically(tmp_path / "a" / "b" / "answer.json", "text")
    assert (tmp_path / "a" / "b" / "answer.json").read_text() == "text"


def test_json_refuses_nan_and_writes_nothing(tmp_path):
    with pytest.raises(ValueError, match="JSON"):
        write_json_atomically(tmp_path / "answer.json", {"value": float("nan")})
    assert os.listdir(tmp_path) == []


def test_json_keeps_every_digit(tmp_path):
    write_json_atomically(tmp_path / "answer.json", {"größe": 0.1 + 0.2})
    assert "0.30000000000000004" in (tmp_path / "answer.json").read_text(encoding="utf-8")
    assert "größe" in (tmp_path / "answer.json").read_text(encoding="utf-8")


def test_a_folder_is_replaced_whole_or_stays_as_it_was(tmp_path):
    folder = tmp_path / "data"
    with whole_folder(folder) as partial:
        (partial / "a").write_text("first")
    with pytest.raises(KeyboardInterrupt), whole_folder(folder) as partial:
        (partial / "b").write_text("half")
        raise KeyboardInterrupt
    assert [path.name for path in tmp_path.iterdir()] == ["data"]
    assert [path.name for path in folder.iterdir()] == ["a"]
    with whole_folder(folder) as partial:
        (partial / "c").write_text("second")
    assert [path.name for path in folder.iterdir()] == ["c"]
    assert [path.name for path in tmp_path.iterdir()] == ["data"]
