"""A log in which samples were lost is cut there, on request; what is dropped is said."""

from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.cli import main
from bench.dataset.dataset import load_dataset
from bench.dataset.logs.columns import LogMap
from bench.dataset.recording import write_table
from bench.dataset.robot import load_robot
from tests.good_data import COUNT, JOINTS, movement, time_stamps, write_robot
from tests.logs_kit import told

COLUMNS = ["time", *(f"position.{j}" for j in JOINTS), *(f"current.{j}" for j in JOINTS)]


@pytest.fixture
def robot(tmp_path: Path) -> str:
    return str(write_robot(tmp_path / "robot"))


def with_lost(folder: Path, *lost: int) -> Path:
    """Two thousand samples in 4 s, without these rows."""
    position, current = movement(time_stamps())
    table = np.delete(np.column_stack([time_stamps(), position, current]), lost, axis=0)
    write_table(folder / "log.csv", dict(zip(COLUMNS, table.T, strict=True)))
    return folder / "log.csv"


def test_a_gap_is_refused_with_the_option_that_cuts_there(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path, 800, 801)
    with pytest.raises(BenchError, match=r"line 802: a gap of 0\.006 s .*; add --split-gaps") as caught:
        told(file, robot, LogMap(), tmp_path / "out")
    assert "\n" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_a_log_is_cut_at_its_gaps_and_no_sample_moves(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path, 800, 801)
    found = told(file, robot, LogMap(), tmp_path / "out", shortest=1.0)
    assert [note for _, note in found.notes] == ["cut at 1 gap (0.006 s at 1.598 s); no sample is dropped"]
    first, second = load_dataset(tmp_path / "out").recordings
    assert (first.name, second.name) == ("log-1.csv", "log-2.csv")
    kept = np.delete(time_stamps(), [800, 801])
    assert np.array_equal(np.concatenate([first.time, second.time]), kept)
    assert second.time[0] == time_stamps()[802]


def test_a_log_is_cut_where_its_time_goes_back(tmp_path: Path, robot: str) -> None:
    """A clock that was set back, and a late row: samples stay in their order, and none is moved."""
    file = with_lost(tmp_path)
    header, *rows = file.read_text(encoding="utf-8").splitlines()
    rows[1100], rows[1101] = rows[1101], rows[1100]
    second = [f"{float(row.partition(',')[0]) - 1.0:.9g},{row.partition(',')[2]}" for row in rows[500:]]
    file.write_text("\n".join([header, *rows[:500], *second]) + "\n", encoding="utf-8")
    with pytest.raises(
        BenchError, match=r"line 502: 0 s goes back: it follows 0.998 s \(and 1 more\); add --split"
    ):
        told(file, robot, LogMap(), tmp_path / "out")
    found = told(file, robot, LogMap(), tmp_path / "out", shortest=0.5)
    (note,) = [note for _, note in found.notes]
    assert note.startswith(
        "cut at 2 gaps (0.004 s at 1.198 s, 0.004 s at 1.2 s) and where time runs backwards or stops (0.998 s to 0 s, "
    )
    first, second, third = load_dataset(tmp_path / "out").recordings
    assert [one.time.size for one in (first, second, third)] == [500, 600, 898]
    assert all(np.diff(one.time).min() > 0.0 for one in (first, second, third))


def test_pieces_that_are_too_short_are_dropped_and_told(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path, 800, 801, 1000, 1001, 1002)
    found = told(file, robot, LogMap(), tmp_path / "out", shortest=1.0)
    (note,) = [note for _, note in found.notes]
    assert note == (
        "cut at 2 gaps (0.006 s at 1.598 s, 0.008 s at 1.998 s); 1 piece shorter than 1 s or 100 samples dropped:"
        " 198 of 1995 samples, 0.394 s"
    )
    assert [entry.file for entry in found.entries] == ["log-1.csv", "log-2.csv"]
    with pytest.raises(BenchError, match=r"nothing remains; --shortest 1\.99 keeps the longest"):
        told(file, robot, LogMap(), tmp_path / "other", shortest=3.0)
    assert not (tmp_path / "other").exists()


def test_one_piece_keeps_its_name_and_a_whole_log_is_not_cut(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path, 50, 51)
    assert [one.file for one in told(file, robot, LogMap(), tmp_path / "a", shortest=1.0).entries] == [
        "log.csv"
    ]
    whole = with_lost(tmp_path)
    found = told(whole, robot, LogMap(), tmp_path / "b", shortest=1.0)
    assert ([one.file for one in found.entries], found.notes) == (["log.csv"], ())


def test_the_last_part_is_kept_apart_across_gaps(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path, 400, 401, 1700, 1701)
    found = told(file, robot, LogMap(), tmp_path / "out", validate_fraction=0.3, shortest=0.4)
    assert [(one.file, one.use) for one in found.entries] == [
        ("log-1.csv", "identify"),
        ("log-2.csv", "identify"),
        ("log-3-validate.csv", "validate"),
        ("log-4-validate.csv", "validate"),
    ]
    fitted = [one for one in load_dataset(tmp_path / "out").recordings if one.use == "identify"]
    assert fitted[-1].time[-1] < time_stamps()[round(0.7 * COUNT) + 5]


def test_faults_behind_a_gap_are_named_by_their_line(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path, 800, 801)
    lines = file.read_text(encoding="utf-8").splitlines()
    cells = lines[1200].split(",")
    lines[1200] = ",".join([*cells[:2], "90", *cells[3:]])
    file.write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(BenchError, match=r"column position\.rail, line 1201: spikes"):
        told(file, robot, LogMap(), tmp_path / "out", shortest=1.0)


def test_the_command_says_what_it_cut(tmp_path: Path, robot: str, capsys: pytest.CaptureFixture[str]) -> None:
    file = with_lost(tmp_path, 800, 801)
    words = ["import", str(file), "--robot", robot, "-o", str(tmp_path / "out")]
    assert main([*words, "--shortest", "1"]) == 2
    assert "--shortest needs --split-gaps" in capsys.readouterr().err
    assert main([*words, "--split-gaps", "--shortest", "1"]) == 0
    assert f"{file}: cut at 1 gap" in capsys.readouterr().out


def with_unmeasured(folder: Path, *rows: int) -> Path:
    """The same log whole, with no current in these rows."""
    position, current = movement(time_stamps())
    table = np.column_stack([time_stamps(), position, current])
    table[list(rows), -1] = np.nan
    write_table(folder / "log.csv", dict(zip(COLUMNS, table.T, strict=True)))
    return folder / "log.csv"


def test_rows_without_a_measurement_are_left_out_where_the_log_may_be_cut(tmp_path: Path, robot: str) -> None:
    file = with_unmeasured(tmp_path, 0, 800, 801)
    found = told(file, robot, LogMap(), tmp_path / "out", shortest=1.0)
    assert [note for _, note in found.notes] == [
        "3 rows without a measurement omitted",
        "cut at 1 gap (0.006 s at 1.598 s); no sample is dropped",
    ]
    first, second = load_dataset(tmp_path / "out").recordings
    kept = np.delete(time_stamps(), [0, 800, 801])
    assert np.array_equal(np.concatenate([first.time, second.time]), kept)


def test_lines_that_were_written_twice_are_read_once(tmp_path: Path, robot: str) -> None:
    file = with_lost(tmp_path)
    lines = file.read_text().splitlines()
    file.write_text("\n".join([*lines[:500], *lines[499:900], lines[899], *lines[900:]]) + "\n")
    found = told(file, robot, LogMap(), tmp_path / "out")
    assert [note for _, note in found.notes] == ["2 rows written twice omitted"]
    (recording,) = load_dataset(tmp_path / "out").recordings
    assert np.array_equal(recording.time, time_stamps())


def refused(folder: Path, lines: list[str], robot: str) -> str:
    """What is said of a dataset with a log of these lines."""
    (folder / "log.csv").write_text("\n".join(lines) + "\n")
    recording = '[[recordings]]\nfile = "log.csv"\nuse = "identify"\n'
    (folder / "dataset.toml").write_text(f'robot = "{robot}"\n{recording}')
    with pytest.raises(BenchError) as caught:
        load_dataset(folder)
    return str(caught.value)


def mended(folder: Path, key: str) -> list:
    """The recordings of the dataset with what was advised."""
    with (folder / "dataset.toml").open("a") as file:
        file.write(f"{key}\n")
    return load_dataset(folder).recordings


def test_what_is_advised_for_a_dataset_mends_it(tmp_path: Path, robot: str) -> None:
    lines = with_unmeasured(tmp_path, 800, 801, 1000).read_text().splitlines()
    said = refused(tmp_path, lines, robot)
    advised = "exclude = [[1.599, 1.603], [1.999, 2.001]]"
    assert said.endswith(f"; {advised} under its file name in dataset.toml excludes it")
    assert len(mended(tmp_path, advised)) == 3
    lines = with_lost(tmp_path, 800, 801).read_text().splitlines()
    said = refused(tmp_path, lines, robot)
    advised = "window = [[0, 1.598], [1.604, 3.998]]"
    assert "a gap of 0.006 s" in said
    assert f"; {advised} under its file name" in said
    assert len(mended(tmp_path, advised)) == 2


def test_a_file_that_breaks_off_is_told_so(tmp_path: Path, robot: str) -> None:
    lines = with_unmeasured(tmp_path, 1999).read_text().splitlines()
    assert refused(tmp_path, lines, robot).endswith("the file breaks off there: remove that line")
    lines[-1] = lines[-1].rpartition(",")[0]
    assert "the file breaks off there: remove that line" in refused(tmp_path, lines, robot)
    lines[-1], lines[900] = lines[-2], lines[900].rpartition(",")[0]
    assert refused(tmp_path, lines, robot).endswith("; mend or remove that line")


def test_logs_that_were_joined_a_column_of_nothing_and_zeros_at_the_end_are_named(
    tmp_path: Path, robot: str
) -> None:
    lines = with_lost(tmp_path).read_text().splitlines()
    said = refused(tmp_path, [*lines, *lines], robot)
    assert "line 2002: names the columns once more: two logs were joined there" in said
    empty = [lines[0], *(f"{line.rpartition(',')[0]}," for line in lines[1:])]
    said = refused(tmp_path, empty, robot)
    assert said.endswith("the column has no measurement at all: is it the right one?")
    said = refused(tmp_path, [*lines, 8 * "\0"], robot)
    assert "not a text file" in said  # a line follows
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n" + 8 * "\0")
    with pytest.raises(BenchError, match=r"line 2002: 8 zero bytes up to the end: .*; remove them"):
        load_dataset(tmp_path)


@pytest.mark.parametrize(
    ("written", "given", "advised"),
    [
        (1e3, 1e3, "--scale time=0.001 in place of --scale time=1000"),  # stamps in ms, scaled the wrong way
        (1.0, 1e3, "--scale time=1 in place of --scale time=1000"),
        (1e6, "ms", "--scale time=1e-06 in place of --scale time=ms"),
    ],
)
def test_advice_on_units_counts_the_scale_that_was_given(
    tmp_path: Path, robot: str, written: float, given: float | str, advised: str
) -> None:
    position, current = movement(time_stamps())
    table = np.column_stack([written * time_stamps(), position, current])
    write_table(tmp_path / "log.csv", dict(zip(COLUMNS, table.T, strict=True)))
    with pytest.raises(BenchError, match="looks like") as caught:
        told(tmp_path / "log.csv", robot, LogMap(scale={"time": given}), tmp_path / "out")
    assert str(caught.value).endswith(f"; give {advised}")
    mends = float(advised.split("=")[1].split(maxsplit=1)[0])
    told(tmp_path / "log.csv", robot, LogMap(scale={"time": mends}), tmp_path / "out")


def swapped_log(tmp_path: Path, header: str = "") -> Path:
    """A palletiser's log, degrees, in which the columns of two motors with ranges apart have changed places."""
    home = {"motor_1": 0.0, "motor_2": 1.8, "motor_3": -0.2, "motor_4": 0.0}
    names = ["motor_1", "motor_3", "motor_2", "motor_4"]
    time = np.arange(0.0, 2.0, 1e-3)
    rng = np.random.default_rng(0)
    columns = {"time": time}
    for name, source in zip(home, names, strict=True):
        moved = np.rad2deg(home[source] + 0.1 * np.sin(3.0 * time + len(columns)))
        columns[f"position.{name}{header}"] = moved + 1e-4 * rng.normal(size=time.size)
    columns |= {f"current.{name}": np.cos(2.0 * time) + 0.01 * rng.normal(size=time.size) for name in home}
    write_table(tmp_path / "log.csv", columns)
    return tmp_path / "log.csv"


@pytest.mark.parametrize("header", ["", " [deg]"])
def test_columns_that_lie_in_each_others_ranges_are_told_so(tmp_path: Path, header: str) -> None:
    """Not that they are in degrees once more, which they are not."""
    robot = load_robot("palletiser")
    log = swapped_log(tmp_path, header)
    columns = {f"position.{joint}": f"position.{joint}{header}" for joint in robot.joints}
    log_map = LogMap(columns=columns, scale={} if header else {"position": "deg"})
    with pytest.raises(BenchError, match="are the two columns swapped") as caught:
        told(log, robot, log_map, tmp_path / "out")
    lines = str(caught.value).splitlines()
    assert len(lines) == 2
    assert "column position.motor_2" in lines[0]
    assert "lies in the range of motor_3, [-0.8, 0.45]" in lines[0]
    assert "lies in the range of motor_2, [1, 2.1]" in lines[1]
    assert "looks like degrees" not in str(caught.value)
    assert not (tmp_path / "out").exists()


def test_what_was_turned_from_degrees_is_not_to_be_turned_again(tmp_path: Path) -> None:
    robot = load_robot("palletiser")
    log = swapped_log(tmp_path)
    columns = {
        "position.motor_2": "position.motor_3"
    }  # one column twice: no swap, and far from motor_3's range
    with pytest.raises(BenchError, match="looks like degrees") as caught:
        told(log, robot, LogMap(columns=columns, scale={"position": "deg"}), tmp_path / "out")
    assert "is turned by --scale position=deg already: is this its column?" in str(caught.value)
    assert "in place of" not in str(caught.value)
