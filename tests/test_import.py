"""Logs of other programs become recordings of a dataset."""

import shlex
from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from scipy.io import savemat

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.importing import LogRequest, import_log
from bench.dataset.payload import Payload
from bench.dataset.recording import write_table
from tests.good_data import COUNT, JOINTS, RATE, movement, time_stamps, write_robot
from tests.logs_kit import imported, told

NAMES = {"t": "time", "qa": "position.arm", "qr": "position.rail", "qw": "position.wheel"} | {
    "ia": "current.arm",
    "ir": "current.rail",
    "iw": "current.wheel",
}
MAP = LogMap({target: source for source, target in NAMES.items()})


def log(seed: int = 0) -> dict[str, np.ndarray]:
    position, current = movement(time_stamps(), seed)
    return dict(zip(NAMES, [time_stamps(), *position.T, *current.T], strict=True))


def save_mat(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    savemat(path, {name: values[:, None] for name, values in columns.items()} | {"kp": 160.0, "who": "me"})


def save_npz(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    np.savez(path, **columns, note=np.array(["me"]), objects=np.array([{}], dtype=object))


def save_parquet(path: Path, columns: Mapping[str, np.ndarray]) -> None:
    pq.write_table(pa.table({**columns, "who": ["me"] * COUNT}), path)


WRITERS: dict[str, Callable[[Path, Mapping[str, np.ndarray]], None]] = {
    "mat": save_mat,
    "npz": save_npz,
    "parquet": save_parquet,
    "csv": write_table,
}


@pytest.fixture
def robot(tmp_path: Path) -> str:
    return str(write_robot(tmp_path / "robot"))


@pytest.fixture
def mat(tmp_path: Path) -> Path:
    save_mat(tmp_path / "log.mat", log())
    return tmp_path / "log.mat"


@pytest.mark.parametrize("suffix", WRITERS)
def test_every_kind_of_log_gives_the_same_recording(suffix: str, tmp_path: Path, robot: str) -> None:
    file = tmp_path / f"log.{suffix}"
    WRITERS[suffix](file, log())
    entries = imported(file, robot, MAP, tmp_path / "out")
    assert [(entry.file, entry.use) for entry in entries] == [("log.csv", "identify")]
    dataset = load_dataset(tmp_path / "out")
    assert dataset.robot.folder == tmp_path / "robot"
    position, current = movement(time_stamps())
    (recording,) = dataset.recordings
    assert np.array_equal(recording.time, time_stamps())
    assert np.array_equal(recording.position, position)
    assert np.array_equal(recording.current, current)


def test_columns_that_have_their_name_already_need_no_map(tmp_path: Path, robot: str) -> None:
    write_table(tmp_path / "log.csv", {NAMES[name]: values for name, values in log().items()})
    imported(tmp_path / "log.csv", robot, LogMap({}), tmp_path / "out", name="run.parquet")
    assert load_dataset(tmp_path / "out").recordings[0].name == "run.parquet"


def test_matrices_and_structs_are_named_by_column_and_field(tmp_path: Path, robot: str) -> None:
    position, current = movement(time_stamps())
    savemat(tmp_path / "a.mat", {"log": {"t": time_stamps(), "q": position.T, "motor": {"i": current}}})
    columns = {"time": "log.t"}
    for i, joint in enumerate(JOINTS):
        columns |= {f"position.{joint}": f"log.q[{i}]", f"current.{joint}": f"log.motor.i[{i}]"}
    imported(tmp_path / "a.mat", robot, LogMap(columns), tmp_path / "out")
    recording = load_dataset(tmp_path / "out").recordings[0]
    assert np.array_equal(recording.position, position)
    assert np.array_equal(recording.current, current)


def test_units_are_converted_rates_become_time_and_others_are_kept(tmp_path: Path, robot: str) -> None:
    columns = log()
    columns |= {"qa": np.degrees(columns["qa"]), "hot": np.linspace(20, 40, COUNT)}
    del columns["t"]
    save_npz(tmp_path / "log.npz", columns)
    targets = {target: source for target, source in MAP.columns.items() if target != "time"}
    mapping = LogMap(targets | {"temperature": "hot"}, {"position.arm": np.pi / 180}, RATE)
    imported(tmp_path / "log.npz", robot, mapping, tmp_path / "out")
    recording = load_dataset(tmp_path / "out").recordings[0]
    assert recording.rate == pytest.approx(RATE)
    np.testing.assert_allclose(recording.position, movement(time_stamps())[0], rtol=1e-12, atol=1e-15)
    assert np.array_equal(recording.extra["temperature"], columns["hot"])


def test_a_second_log_is_added_and_comments_stay(tmp_path: Path, robot: str, mat: Path) -> None:
    out = tmp_path / "out"
    imported(mat, robot, MAP, out)
    toml = out / "dataset.toml"
    toml.write_text("# weighed on Monday\n" + toml.read_text())
    save_mat(tmp_path / "second.mat", log(1))
    disc = Payload("disc", 0.5)
    imported(tmp_path / "second.mat", robot, MAP, out, payload=disc)
    save_mat(tmp_path / "third.mat", log(2))
    imported(tmp_path / "third.mat", robot, MAP, out, "validate", "disc")
    assert toml.read_text().startswith("# weighed on Monday\n")
    dataset = load_dataset(out)
    assert [(r.name, r.use, r.payload) for r in dataset.recordings] == [
        ("log.csv", "identify", None),
        ("second.csv", "identify", "disc"),
        ("third.csv", "validate", "disc"),
    ]
    assert dataset.payloads["disc"].mass == 0.5


def test_the_last_part_is_kept_apart_for_validation(tmp_path: Path, robot: str, mat: Path) -> None:
    imported(mat, robot, MAP, tmp_path / "out", validate_fraction=0.25)
    first, last = load_dataset(tmp_path / "out").recordings
    assert (first.name, first.use, last.name, last.use) == (
        "log.csv",
        "identify",
        "log-validate.csv",
        "validate",
    )
    assert np.array_equal(np.concatenate([first.time, last.time]), time_stamps())
    assert last.time.size == COUNT // 4


def without(target: str) -> LogMap:
    return LogMap({key: source for key, source in MAP.columns.items() if key != target})


BAD_MAPS: dict[str, tuple[LogMap, tuple[str, ...]]] = {
    "a name that the log lacks": (
        LogMap({**MAP.columns, "current.rail": "vir"}),
        ("'vir'", "current.rail", "ir (2000)"),
    ),
    "a column without source": (without("position.rail"), ("position.rail", "qr (2000)")),
    "a joint that the robot lacks": (
        LogMap({**MAP.columns, "current.elbow": "ia"}),
        ("'current.elbow'", "arm, rail, wheel"),
    ),
    "vectors of different length": (
        LogMap({**MAP.columns, "gain": "kp"}),
        ("'kp'", "gain", "1 sample,", "2000"),
    ),
    "time and a rate": (LogMap(MAP.columns, rate=500.0), ("rate", "time")),
    "a rate of nothing": (LogMap(without("time").columns, rate=0.0), ("rate", "0 Hz")),
    "a scale of nothing": (LogMap(MAP.columns, {"time": 0.0}), ("scale", "time")),
    "a scale without column": (LogMap(MAP.columns, {"speed": 2.0}), ("'speed'", "scale")),
    "degrees": (
        LogMap(MAP.columns, {"position.arm": 180 / np.pi}),
        ("log.mat", "column position.arm", "degrees"),
    ),
    "milliseconds": (LogMap(MAP.columns, {"time": 1e3}), ("log.mat", "column time", "milliseconds")),
}


@pytest.mark.parametrize("name", BAD_MAPS)
def test_a_map_that_does_not_fit_is_refused_and_nothing_is_written(
    name: str, tmp_path: Path, robot: str, mat: Path
) -> None:
    mapping, expected = BAD_MAPS[name]
    with pytest.raises(BenchError) as caught:
        imported(mat, robot, mapping, tmp_path / "out")
    message = str(caught.value)
    assert "\n" not in message
    assert [text for text in expected if text not in message] == [], message
    assert not (tmp_path / "out").exists()


def test_where_nothing_is_mapped_the_options_are_proposed_that_the_names_tell(
    tmp_path: Path, robot: str, capsys: pytest.CaptureFixture[str]
) -> None:
    columns = log()
    columns["t"] = 1e3 * columns["t"]
    names = {"t": "Zeit_ms", "qa": "Winkel arm", "qr": "Weg rail", "qw": "Winkel wheel"}
    names |= {"ia": "Strom arm", "ir": "Strom rail", "iw": "Strom wheel"}
    write_table(tmp_path / "log.csv", {names[name]: values for name, values in columns.items()})
    words = ["import", str(tmp_path / "log.csv"), "--robot", robot, "-o", str(tmp_path / "out")]
    assert main(words) == 2
    said = capsys.readouterr().err
    proposed = said.partition("by their names these may be right, look at each: ")[2].strip()
    assert proposed == (
        "--map time=Zeit_ms --map position.arm='Winkel arm' --map position.rail='Weg rail'"
        " --map position.wheel='Winkel wheel' --map current.arm='Strom arm'"
        " --map current.rail='Strom rail' --map current.wheel='Strom wheel' --scale time=ms"
    )
    assert main([*words, *shlex.split(proposed)]) == 0
    columns["arm"] = columns.pop("qa")  # a name that may be anything
    write_table(tmp_path / "log.csv", {names.get(name, name): values for name, values in columns.items()})
    assert main(words) == 2
    assert "say which is which, as in --map time=Zeit_ms (with --scale time=ms" in capsys.readouterr().err


def truncate(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])


def garbage(path: Path) -> None:
    path.write_bytes(bytes(range(256)) * 40)


def hdf(path: Path) -> None:
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + b"\x00\x02IM"
    path.write_bytes(head + b"\x89HDF\r\n\x1a\n".rjust(512, b"\0"))


@pytest.mark.parametrize(
    ("suffix", "spoil", "expected"),
    [
        ("mat", truncate, "MATLAB"),
        ("mat", garbage, "MATLAB"),
        ("mat", hdf, "-v7"),
        ("npz", truncate, "NumPy"),
        ("npz", garbage, "NumPy"),
        ("parquet", truncate, "Parquet"),
        ("csv", garbage, "not a text"),
        ("csv", Path.unlink, "no such file"),
    ],
)
def test_a_file_that_is_broken_is_named(
    suffix: str, spoil: Callable[[Path], None], expected: str, tmp_path: Path, robot: str
) -> None:
    file = tmp_path / f"log.{suffix}"
    WRITERS[suffix](file, log())
    spoil(file)
    with pytest.raises(BenchError) as caught:
        imported(file, robot, MAP, tmp_path / "out")
    assert str(file) in str(caught.value)
    assert expected in str(caught.value)
    assert "\n" not in str(caught.value)


def spoilt(path: Path, line: int, column: int, cell: str) -> Path:
    """A CSV log with another text in one cell; the file's first line, of names, is 1."""
    write_table(path, log())
    lines = path.read_text().splitlines()
    cells = lines[line - 1].split(",")
    cells[column] = cell
    lines[line - 1] = ",".join(cells)
    path.write_text("\n".join(lines) + "\n")
    return path


FAULTY_CELLS = {
    "text": (1201, 4, "ERR", "column ia, line 1201: 'ERR' is not a number"),
    "not a number": (
        1201,
        4,
        "nan",
        "column current.arm ('ia' of the log), line 1201: is 'nan', which is no measurement; add --split-gaps",
    ),
    "empty": (1201, 1, "", "column position.arm ('qa' of the log), line 1201: is empty; add --split-gaps"),
    "time": (1201, 0, "0.1", "column time ('t' of the log), line 1201: 0.1 s goes back"),
}


@pytest.mark.parametrize("fraction", [0.0, 0.75])
@pytest.mark.parametrize("fault", FAULTY_CELLS)
def test_a_faulty_cell_is_named_by_its_line_in_the_log(
    fault: str, fraction: float, tmp_path: Path, robot: str
) -> None:
    line, column, cell, expected = FAULTY_CELLS[fault]
    file = spoilt(tmp_path / "log.csv", line, column, cell)
    with pytest.raises(BenchError) as caught:
        imported(file, robot, MAP, tmp_path / "out", validate_fraction=fraction)
    assert str(caught.value).startswith(f"{file}: {expected}")
    assert not (tmp_path / "out").exists()


def test_text_in_a_column_that_nobody_needs_does_no_harm_and_is_told_where_one_is_missing(
    tmp_path: Path, robot: str
) -> None:
    file = tmp_path / "log.csv"
    write_table(file, log())
    head, *lines = file.read_text().splitlines()
    file.write_text("\n".join([f"{head},state", *(f"{line},RUN" for line in lines)]) + "\n")
    imported(file, robot, MAP, tmp_path / "out")
    with pytest.raises(BenchError, match=r"no 'status' for state: did you mean 'state'.*state \(with text\)"):
        imported(file, robot, LogMap({**MAP.columns, "state": "status"}), tmp_path / "other")


def test_rows_of_a_log_without_lines_are_those_of_the_log(tmp_path: Path, robot: str) -> None:
    columns = log()
    columns["qr"][1600] = np.nan
    save_npz(tmp_path / "log.npz", columns)
    with pytest.raises(BenchError, match=r"column position.rail \('qr' of the log\), row 1600: is nan"):
        imported(tmp_path / "log.npz", robot, MAP, tmp_path / "out", validate_fraction=0.5)


def test_the_same_payload_may_be_told_again_and_another_one_of_its_name_not(
    tmp_path: Path, robot: str, mat: Path
) -> None:
    (tmp_path / "out").mkdir()
    path = tmp_path / "out" / "dataset.toml"
    text = f'robot = "{robot}"\n\n[payloads.disc]\nmass = 1.0\n\n[[recordings]]\nfile = "a.csv"\nuse = "identify"\n'
    path.write_text(text)
    with pytest.raises(
        BenchError, match=r"already defined with 1 kg, not 2 kg; give its name alone, another name"
    ):
        imported(mat, robot, MAP, tmp_path / "out", payload=Payload("disc", 2.0))
    with pytest.raises(BenchError, match="already defined with other numbers"):
        imported(mat, robot, MAP, tmp_path / "out", payload=Payload("disc", 1.0, np.zeros(3)))
    assert path.read_text() == text
    imported(mat, robot, MAP, tmp_path / "out", payload=Payload("disc", 1.0))
    assert path.read_text().count("[payloads.disc]") == 1


def test_nothing_is_overwritten_and_nothing_of_another_robot_added(
    tmp_path: Path, robot: str, mat: Path
) -> None:
    out = tmp_path / "out"
    imported(mat, robot, MAP, out)
    before = {path: path.read_bytes() for path in out.iterdir()}
    other = write_robot(tmp_path / "other")
    for arguments, expected in (
        ({"robot": robot}, "or --replace to replace it by this log"),
        ({"robot": str(other), "name": "b.csv"}, "robot"),
        ({"robot": robot, "name": "b.csv", "payload": "disk"}, "'disk' is not defined"),
        ({"robot": robot, "name": "b.csv", "payload": Payload("disc", -1.0)}, "mass must be positive"),
        ({"robot": robot, "name": "../b.csv"}, "../b.csv"),
        ({"robot": robot, "name": "b.csv", "validate_fraction": 1.5}, "1.5"),
    ):
        with pytest.raises(BenchError, match=expected.replace(".", r"\.")):
            imported(mat, log_map=MAP, folder=out, **arguments)
        assert {path: path.read_bytes() for path in out.iterdir()} == before


def test_a_failing_write_leaves_no_recording_without_its_entry(
    tmp_path: Path, robot: str, mat: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(path: Path, text: str) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("bench.dataset.logs.importing.write_text_atomically", interrupt)
    with pytest.raises(KeyboardInterrupt):
        imported(mat, robot, MAP, tmp_path / "out")
    assert list((tmp_path / "out").iterdir()) == []


SLIDE = """<mujoco>
  <worldbody>
    <body>
      <joint name="axis" type="slide" axis="1 0 0"/>
      <geom size="0.1" mass="1"/>
    </body>
  </worldbody>
</mujoco>
"""

AXIS = """name = "axis"
model = "axis.xml"

[[actuators]]
joint = "axis"
gain = 35.15065
gain_unit = "N/V"
"""


def test_the_measured_log_of_an_axis_is_imported(measured_data: Path, tmp_path: Path) -> None:
    file = measured_data / "emps" / "DATA_EMPS.mat"
    if not file.is_file():
        pytest.skip(f"no measured log {file}")
    robot = tmp_path / "axis"
    robot.mkdir()
    (robot / "axis.xml").write_text(SLIDE)
    (robot / "robot.toml").write_text(AXIS)
    mapping = LogMap({"time": "t", "position.axis": "qm", "current.axis": "vir", "reference": "qg"})
    imported(file, str(robot), mapping, tmp_path / "out", validate_fraction=0.2)
    first, last = load_dataset(tmp_path / "out").recordings
    assert first.rate == pytest.approx(1000.0)
    assert first.time.size + last.time.size == 24841
    assert np.abs(first.position - first.extra["reference"][:, None]).max() < 0.01


def test_a_unit_in_a_name_is_told_where_nobody_gave_one(tmp_path: Path, robot: str) -> None:
    columns = {name.replace("ia", "ia_mA").replace("qa", "qa_deg"): values for name, values in log().items()}
    save_npz(tmp_path / "log.npz", columns)
    names = {**MAP.columns, "current.arm": "ia_mA", "position.arm": "qa_deg"}
    request = LogRequest(tmp_path / "log.npz", LogMap(names, {"position.arm": "rad"}))
    notes = [note for _, note in import_log(robot, request, tmp_path / "data").notes]
    assert "ia_mA for current.arm: assumed to be in A; if it is in mA, add --scale current.arm=mA" in notes
    assert not any("qa_deg" in note for note in notes)


@pytest.mark.parametrize(("mass", "asked"), [(1500.0, True), (0.5, False), (4.0, False)])
def test_a_payload_in_grams_is_asked_about_before_it_is_taken(
    mass: float, asked: bool, tmp_path: Path, robot: str
) -> None:
    write_table(tmp_path / "log.csv", log())
    payload, out = Payload("disc", mass), tmp_path / "out"
    if asked:
        with pytest.raises(
            BenchError, match=r"is that in grams, 1\.5 kg\? .* --accept mass if 1500 kg is meant"
        ):
            told(tmp_path / "log.csv", robot, MAP, out, payload=payload)
        assert not out.exists()
    told(tmp_path / "log.csv", robot, MAP, out, payload=payload, accept=("mass",) if asked else ())
    assert load_dataset(out).payloads["disc"].mass == mass
