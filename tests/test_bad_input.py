"""Every broken dataset and robot is refused in one line that names the culprit."""

import random
from pathlib import Path

import pytest

from bench.basics.errors import BenchError
from bench.dataset.dataset import load_dataset
from tests.broken import BROKEN
from tests.good_data import write_good_dataset


@pytest.mark.parametrize("name", BROKEN)
def test_is_refused_in_one_line_that_names_the_culprit(name: str, tmp_path: Path) -> None:
    spoil, expected = BROKEN[name]
    folder = write_good_dataset(tmp_path / "dataset")
    spoil(folder)
    with pytest.raises(BenchError) as caught:
        load_dataset(folder)
    message = str(caught.value)
    assert "\n" not in message
    assert [text for text in expected if text not in message] == [], message


def test_the_dataset_that_they_spoil_is_good(tmp_path: Path) -> None:
    dataset = load_dataset(write_good_dataset(tmp_path / "dataset"))
    assert [recording.name for recording in dataset.recordings] == ["unloaded.csv", "loaded.parquet"]


@pytest.mark.parametrize("name", ["unloaded.csv", "loaded.parquet", "dataset.toml"])
def test_whatever_happens_to_a_file_it_is_read_or_refused(name: str, tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path / "dataset")
    path = folder / name
    good = path.read_bytes()
    chance = random.Random(name)
    pieces = (b'"', b"\n", b",", b";", b"\r", b"\x00", b"nan", b"1e400", b"[", b"\xc3\xa4", b"\xff", b"-")
    messages = []
    for _ in range(60):
        spoilt = bytearray(good)
        for _ in range(chance.choice((1, 1, 5))):
            at = chance.randrange(min(len(spoilt), chance.choice((200, len(spoilt)))))
            length = chance.choice((0, 1, 40))
            spoilt[at : at + length] = chance.choice(pieces)
        path.write_bytes(spoilt)
        try:
            load_dataset(folder)
        except BenchError as error:
            messages.append(str(error))
    assert len(messages) > 20
    assert [message for message in messages if "\n" in message] == []
