"""A dataset read and written: what comes back, bit for bit, and what is left when writing fails."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.dataset import RecordingEntry, load_dataset, write_dataset_toml
from bench.dataset.payload import Payload, payload_fault
from bench.dataset.recording import write_recording
from tests.good_data import COUNT, JOINTS, RATE, movement, time_stamps, write_good_dataset, write_robot


def test_a_dataset_is_read_as_it_was_written(tmp_path: Path) -> None:
    dataset = load_dataset(write_good_dataset(tmp_path))
    assert dataset.folder == tmp_path
    assert dataset.robot.joints == JOINTS
    assert [(r.name, r.use, r.payload) for r in dataset.recordings] == [
        ("unloaded.csv", "identify", None),
        ("loaded.parquet", "validate", "disc"),
    ]
    disc = dataset.payloads["disc"]
    assert disc.mass == 0.5
    assert disc.center_of_mass is not None
    assert disc.center_of_mass.tolist() == [0.0, 0.0, 0.02]
    assert disc.inertia is not None
    assert disc.inertia.tolist() == [1e-3, 1e-3, 2e-3, 0.0, 0.0, 0.0]
    assert dataset.recordings[0].rate == pytest.approx(RATE, rel=1e-12)


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_numbers_come_back_bit_for_bit(suffix: str, tmp_path: Path) -> None:
    write_robot(tmp_path / "robot")
    time = time_stamps() * (1 + 1e-16) + 1e-17
    position, current = movement(time)
    current[:, 1] *= 1e-300
    current[::2, 2] = np.nextafter(current[::2, 2], np.inf)
    extra = {"temperature": 1 / np.arange(3.0, COUNT + 3), "odd, name": np.full(COUNT, np.nan)}
    write_recording(tmp_path / f"a.{suffix}", time, position, current, JOINTS, extra)
    write_dataset_toml(tmp_path, "robot", [RecordingEntry(f"a.{suffix}", "identify")])
    recording = load_dataset(tmp_path).recordings[0]
    assert np.array_equal(recording.time, time)
    assert np.array_equal(recording.position, position)
    assert np.array_equal(recording.current, current)
    assert list(recording.extra) == list(extra)
    assert np.array_equal(recording.extra["temperature"], extra["temperature"])
    assert np.isnan(recording.extra["odd, name"]).all()


def test_columns_are_taken_by_name_and_text_is_left_aside(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    lines = (folder / "unloaded.csv").read_text().splitlines()
    turned = [",".join(reversed(line.split(","))) for line in lines]
    turned = [line + (",state" if i == 0 else ",moving") for i, line in enumerate(turned)]
    before = load_dataset(folder).recordings[0]
    (folder / "unloaded.csv").write_text("\n".join(turned))
    after = load_dataset(folder).recordings[0]
    assert np.array_equal(before.position, after.position)
    assert np.array_equal(before.current, after.current)
    assert dict(after.extra) == {}


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_an_interrupted_write_leaves_the_older_file_whole(
    suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / f"a.{suffix}"
    write_recording(path, time_stamps(), *movement(time_stamps()), JOINTS)
    before = path.read_bytes()
    writer = (
        "bench.dataset.recording._write_csv" if suffix == "csv" else "bench.dataset.recording._write_parquet"
    )

    def half(target: Path, *_: object) -> None:
        target.write_text("time,posi")
        raise KeyboardInterrupt

    monkeypatch.setattr(writer, half)
    with pytest.raises(KeyboardInterrupt):
        write_recording(path, time_stamps(), *movement(time_stamps(), 1), JOINTS)
    assert path.read_bytes() == before
    assert [found.name for found in tmp_path.iterdir()] == [path.name]


def test_shapes_that_do_not_agree_are_refused(tmp_path: Path) -> None:
    position, current = movement(time_stamps())
    with pytest.raises(ValueError, match=r"current has shape \(2000, 2\), expected \(2000, 3\)"):
        write_recording(tmp_path / "a.csv", time_stamps(), position, current[:, :2], JOINTS)
    with pytest.raises(BenchError, match=r"a\.txt: "):
        write_recording(tmp_path / "a.txt", time_stamps(), position, current, JOINTS)


def test_the_robot_is_found_beside_the_dataset_or_anywhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = write_good_dataset(tmp_path / "dataset")
    monkeypatch.chdir("/")
    assert load_dataset(folder).robot.folder == folder / "robot"
    shutil.move(folder / "robot", tmp_path / "elsewhere")
    recordings = [RecordingEntry("unloaded.csv", "identify")]
    for reference in ("../elsewhere", str(tmp_path / "elsewhere")):
        write_dataset_toml(folder, reference, recordings)
        assert load_dataset(folder).robot.folder == tmp_path / "elsewhere"
    assert load_dataset(folder / "dataset.toml").robot.name == "bench_robot"


def test_effect_files_are_found_beside_the_dataset(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    (folder / "my_effect.py").write_text("")
    write_dataset_toml(
        folder, "robot", [RecordingEntry("unloaded.csv", "identify")], effects=["my_effect.py"]
    )
    assert load_dataset(folder).effect_files == (folder / "my_effect.py",)


def test_names_that_toml_must_quote_come_back(tmp_path: Path) -> None:
    folder = write_good_dataset(tmp_path)
    name = 'disc "1", 0.5 kg'
    (folder / "unloaded.csv").rename(folder / "läufer.csv")
    entry = RecordingEntry("läufer.csv", "identify", name)
    write_dataset_toml(folder, "robot", [entry], [Payload(name, mass=0.1 + 0.2)])
    dataset = load_dataset(folder)
    assert dataset.recordings[0].payload == name
    assert dataset.payloads[name].mass == 0.1 + 0.2
    assert dataset.payloads[name].inertia is None


@pytest.mark.parametrize(
    "inertia",
    [
        [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],  # a point
        [0.0, 1e-3, 1e-3, 0.0, 0.0, 0.0],  # a thin rod
        [1e-3, 1e-3, 2e-3, 0.0, 0.0, 0.0],  # a thin disc: the triangle inequality holds as an equality
        [2e-3, 3e-3, 4e-3, 1e-4, -2e-4, 3e-4],
    ],
)
def test_bodies_that_exist_are_no_fault(inertia: list[float]) -> None:
    assert payload_fault(Payload("p", 0.5, np.zeros(3), np.array(inertia))) is None
