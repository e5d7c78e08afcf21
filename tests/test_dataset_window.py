"""Parts of recordings that are used: `window` and `exclude` of dataset.toml."""

import re
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.dataset import load_dataset
from bench.dataset.sampling import FEWEST
from bench.page.folder import dataset_digest
from tests.good_data import COUNT, RATE, write_good_dataset

END = (COUNT - 1) / RATE


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A good dataset, the third quarter of whose CSV has what no log may have."""
    folder = write_good_dataset(tmp_path)
    lines = (folder / "unloaded.csv").read_text().splitlines()
    for row in range(COUNT // 2, 3 * COUNT // 4):
        cells = lines[row + 1].split(",")
        lines[row + 1] = ",".join([cells[0], "ERR", "nan", *cells[3:]])
    (folder / "unloaded.csv").write_text("\n".join(lines) + "\n")
    return folder


def loaded(folder: Path, keys: str):
    path = folder / "dataset.toml"
    text = path.read_text()
    assert text.count('file = "unloaded.csv"') == 1
    path.write_text(text.replace('file = "unloaded.csv"', f'file = "unloaded.csv"\n{keys}'))
    return load_dataset(folder)


def test_only_what_is_used_is_checked(folder: Path) -> None:
    with pytest.raises(BenchError, match="'ERR' is not a number"):
        load_dataset(folder)
    half = END / 2 - 0.5 / RATE
    recording = loaded(folder, f"window = [0.0, {half}]").recordings[0]
    assert (recording.name, recording.log) == ("unloaded.csv", "unloaded.csv")
    assert recording.time[0] == 0.0
    assert recording.time[-1] <= half
    assert len(recording.time) == COUNT // 2


def test_a_cut_makes_two_recordings(folder: Path) -> None:
    bad = (COUNT // 2 / RATE - 1e-6, (3 * COUNT // 4 - 1) / RATE + 1e-6)
    dataset = loaded(folder, f"exclude = [[{bad[0]}, {bad[1]}]]")
    first, second, other = dataset.recordings
    assert re.fullmatch(r"unloaded\.csv \(0 to .* s\)", first.name)
    assert first.log == second.log == "unloaded.csv"
    assert first.name != second.name
    assert first.use == second.use == "identify"
    assert len(first.time) == COUNT // 2
    assert len(second.time) == COUNT - 3 * COUNT // 4
    assert second.time[0] == pytest.approx(3 * COUNT // 4 / RATE)
    assert (first.began, second.began) == (0.0, 0.0)  # it warms up from then on
    assert other.name == "loaded.parquet"
    assert dataset_digest(dataset)


def test_window_and_exclude_go_together(folder: Path) -> None:
    keys = f"window = [[0.0, {END / 4}], [{0.8 * END}, {END}]]\nexclude = [[{0.85 * END}, {0.86 * END}]]"
    spans = [(one.time[0] / END, one.time[-1] / END) for one in loaded(folder, keys).recordings[:-1]]
    expected = [(0.0, 0.25), (0.8, 0.85), (0.86, 1.0)]
    assert np.allclose(spans, expected, atol=2.0 / COUNT)


def test_what_is_wrong_in_a_used_part_is_named_by_its_line(folder: Path) -> None:
    with pytest.raises(BenchError, match=f"line {COUNT // 2 + 2}: 'ERR' is not a number"):
        loaded(folder, f"window = [{END / 4}, {END}]")


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ("window = [2.0, 1.0]", r"window: \[2, 1\] does not start before it ends"),
        ("window = [1.0]", r"window: should be \[start, end\] in seconds, or several of them"),
        ('window = "all"', r"window: should be \[start, end\] in seconds"),
        ("exclude = [[0.0, true]]", r"exclude: should be \[start, end\] in seconds"),
        ("exclude = [[0.0, 1.0], [0.5, 2.0]]", r"exclude: \[0, 1\] and \[0.5, 2\] overlap"),
        (
            "window = [1000.0, 2000.0]",
            r"unloaded.csv: window \[1000, 2000\]: no sample is there; time runs from 0 to",
        ),
        ("exclude = [[-2.0, -1.0]]", r"exclude \[-2, -1\]: no sample is there"),
        (
            f"window = [0.0, {0.5 * FEWEST / RATE}]",
            r"samples are used between 0 and .* s, at least 100 are needed",
        ),
    ],
)
def test_what_cannot_be_is_refused(folder: Path, keys: str, said: str) -> None:
    with pytest.raises(BenchError, match=said):
        loaded(folder, keys)


def test_parts_of_a_log_with_the_clock_of_a_controller_have_names_of_their_own(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    lines = (folder / "unloaded.csv").read_text().splitlines()
    since = [line.split(",", 1) for line in lines[1:]]
    rows = [f"{1.7e9 + float(stamp):.6f},{rest}" for stamp, rest in since]
    (folder / "unloaded.csv").write_text("\n".join([lines[0], *rows]) + "\n")
    middle = 1.7e9 + END / 2
    first, second, _ = loaded(folder, f"exclude = [{middle - 0.01!r}, {middle + 0.01!r}]").recordings
    assert first.name != second.name
    assert second.name.startswith(f"unloaded.csv ({middle:.1f}"[:24])
