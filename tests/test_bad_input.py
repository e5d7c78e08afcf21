"""Every broken dataset and robot is refused in one line that names the culprit."""

from pathlib import Path

import pytest

from bench.dataset import load_dataset
from bench.errors import BenchError
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
