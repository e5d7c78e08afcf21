"""Logs that are text: preambles, comments, units, no header, any separator; what was assumed is said."""

from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.basics.files.cut_off import refuse_cut_off
from bench.dataset.dataset import load_dataset
from bench.dataset.logs.clock import seconds_from_first
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.log_file import Reading, read_log
from bench.dataset.logs.units import UNITS, unit_named
from tests.good_data import COUNT, JOINTS, movement, time_stamps, write_robot
from tests.logs_kit import told

NAMES = ("t", "qa", "qr", "qw", "ia", "ir", "iw")
COLUMNS = ["time", *(f"position.{j}" for j in JOINTS), *(f"current.{j}" for j in JOINTS)]
BY_NAME = LogMap(dict(zip(COLUMNS, NAMES, strict=True)))
BY_NUMBER = LogMap({column: str(i + 1) for i, column in enumerate(COLUMNS)})


def rows(**factors: float) -> np.ndarray:
    """The good data, columns divided by factors."""
    position, current = movement(time_stamps())
    table = np.column_stack([time_stamps(), position, current])
    return table / [factors.get(name, 1.0) for name in NAMES]


def text(table: np.ndarray, separator: str = ",", decimal: str = ".") -> str:
    lines = (separator.join(map(repr, row)) for row in table.tolist())
    return "".join(line.replace(".", decimal) + "\n" for line in lines)


@pytest.fixture
def robot(tmp_path: Path) -> str:
    return str(write_robot(tmp_path / "robot"))


HEAD = ",".join(NAMES) + "\n"
NUMBERED = "no line names the columns: they are called 1 to 7 in their order"
LOGS: dict[str, tuple[Callable[[], str], str, LogMap, list[str]]] = {
    "plain": (lambda: HEAD + text(rows()), "log.csv", BY_NAME, []),
    "no header": (lambda: text(rows()), "log.csv", BY_NUMBER, [NUMBERED]),
    "columns named by number": (lambda: "1,2,3,4,5,6,7\n" + text(rows()), "log.csv", BY_NUMBER, []),
    "no header, blanks": (lambda: text(rows(), "   "), "log.txt", BY_NUMBER, [NUMBERED]),
    "semicolons and decimal commas": (
        lambda: HEAD.replace(",", ";") + text(rows(), ";", ","),
        "log.csv",
        BY_NAME,
        [],
    ),
    "blanks and decimal commas": (lambda: text(rows(), " ", ","), "log.dat", BY_NUMBER, [NUMBERED]),
    "tabs": (lambda: HEAD.replace(",", "\t") + text(rows(), "\t"), "log.tsv", BY_NAME, []),
    "a preamble": (
        lambda: "Controller 4.2\nDate: Monday, cell 3\n\n" + HEAD + text(rows()),
        "log.csv",
        BY_NAME,
        ["the preamble up to line 2 is skipped"],
    ),
    "a preamble with separators up to the width of the table": (
        lambda: (
            "Axis logger v2.1;;;;;;\nstarted 2026-11-20 09:14\nCell;3;;;;;\n"
            + HEAD.replace(",", ";")
            + text(rows(), ";")
        ),
        "log.csv",
        BY_NAME,
        ["the preamble up to line 3 is skipped"],
    ),
    "such a preamble above samples without names": (
        lambda: "Axis logger v2.1,,,,,,\n" + text(rows()),
        "log.csv",
        BY_NUMBER,
        ["the preamble up to line 1 is skipped", NUMBERED],
    ),
    "a header in a comment": (
        lambda: "# made by np.savetxt\n# " + HEAD.replace(",", " ") + text(rows(), " "),
        "log.txt",
        BY_NAME,
        ["the preamble up to line 2 is skipped"],
    ),
    "comments above a header": (
        lambda: "% run 7\n% cold\n" + HEAD + text(rows()),
        "log.log",
        BY_NAME,
        ["the preamble up to line 2 is skipped"],
    ),
    "separators at the ends of lines, but not of the header": (
        lambda: HEAD.replace(",", ";") + text(rows(), ";").replace("\n", ";\n"),
        "log.csv",
        BY_NAME,
        [],
    ),
    "separators at the ends of all lines": (
        lambda: (HEAD.replace(",", "\t") + text(rows(), "\t")).replace("\n", "\t\n"),
        "log.txt",
        BY_NAME,
        [],
    ),
    "a line of units": (
        lambda: HEAD + "ms,deg,mm,rad,mA,V,A\n" + text(rows(t=1e-3, qa=np.pi / 180, qr=1e-3, ia=1e-3)),
        "log.csv",
        BY_NAME,
        [
            "line 2 is read as units",
            "time: in ms, as the log says",
            "position.arm: in deg, as the log says",
            "position.rail: in mm, as the log says",
            "current.arm: in mA, as the log says",
        ],
    ),
    "units in brackets": (
        lambda: HEAD.replace("qa", "qa [deg]") + text(rows(qa=np.pi / 180)),
        "log.csv",
        LogMap({**BY_NAME.columns, "position.arm": "qa [deg]"}),
        ["position.arm: in deg, as the log says"],
    ),
    "a scale overrides the log's own unit": (
        lambda: HEAD + "s,deg,m,rad,A,V,A\n" + text(rows()),
        "log.csv",
        LogMap(BY_NAME.columns, {"position.arm": 1.0}),
        ["line 2 is read as units"],
    ),
}


@pytest.mark.parametrize("name", LOGS)
def test_a_log_of_any_layout_gives_the_same_recording(name: str, tmp_path: Path, robot: str) -> None:
    write, file, log_map, notes = LOGS[name]
    (tmp_path / file).write_text(write(), encoding="utf-8")
    found = told(tmp_path / file, robot, log_map, tmp_path / "out")
    assert [note for _, note in found.notes] == notes
    (recording,) = load_dataset(tmp_path / "out").recordings
    position, current = movement(time_stamps())
    np.testing.assert_allclose(recording.time, time_stamps(), rtol=1e-12)
    np.testing.assert_allclose(recording.position, position, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(recording.current, current, rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize(
    ("encoding", "said"),
    [("cp1252", "Windows-1252"), ("utf-16", "UTF-16"), ("utf-16-le", "UTF-16"), ("utf-16-be", "UTF-16")],
)
def test_texts_of_controllers_and_spreadsheets_are_read(
    encoding: str, said: str, tmp_path: Path, robot: str
) -> None:
    head = "Zeit [ms];qa [°];qr [mm];qw [°];ia [mA];ir;iw\n"
    degree = np.pi / 180.0
    table = rows(t=1e-3, qa=degree, qr=1e-3, qw=degree, ia=1e-3)
    log = tmp_path / "log.csv"
    log.write_text("Prüfstand 7\n\n" + head + text(table, ";", ","), encoding=encoding)
    names = LogMap(dict(zip(COLUMNS, head.strip().split(";"), strict=True)))
    notes = told(log, robot, names, tmp_path / "out")
    assert any(said in note for _, note in notes.notes)
    (recording,) = load_dataset(tmp_path / "out").recordings
    np.testing.assert_allclose(recording.position, movement(time_stamps())[0], rtol=1e-9, atol=1e-12)


def test_rows_are_skipped_and_a_header_denied_on_request(tmp_path: Path, robot: str) -> None:
    file = tmp_path / "log.csv"
    file.write_text("1,2,3,4,5,6,7\n" + text(rows()), encoding="utf-8")
    found = told(file, robot, BY_NUMBER, tmp_path / "out", reading=Reading(skip_rows=1))
    assert found.notes[0][1] == "the first 1 lines are skipped, as requested"
    assert load_dataset(tmp_path / "out").recordings[0].time.size == COUNT
    file.write_text("nan" + text(rows())[3:], encoding="utf-8")
    with pytest.raises(BenchError, match=r"line 1: is 'nan'"):
        told(file, robot, BY_NUMBER, tmp_path / "other", reading=Reading(header=False))


FAULTS: dict[str, tuple[str, LogMap, str]] = {
    "another unit": (
        HEAD + "s,A,m,rad,A,V,A\n",
        BY_NAME,
        "'qa' is in 'A', a current, and position.arm must be an angle",
    ),
    "an unknown unit": (
        HEAD + "s,furlong,m,rad,A,V,A\n",
        BY_NAME,
        "'qa' is in 'furlong', which is not a known unit",
    ),
    "torques for currents": (HEAD + "s,rad,m,rad,Nm,V,A\n", BY_NAME, 'gain_unit = "1" in robot.toml'),
    "a header with too few names": (
        "t,qa,qr,qw,ia,ir\n",
        BY_NAME,
        "line 1: names 6 columns, the lines below have 7 values",
    ),
    "text in the first row": (
        HEAD + "0,ERR,0,0,0,0,0\n",
        BY_NAME,
        "column qa, line 2: 'ERR' is not a number",
    ),
}


@pytest.mark.parametrize("name", FAULTS)
def test_what_cannot_be_told_is_refused(name: str, tmp_path: Path, robot: str) -> None:
    head, log_map, expected = FAULTS[name]
    (tmp_path / "log.csv").write_text(head + text(rows()), encoding="utf-8")
    with pytest.raises(BenchError) as caught:
        told(tmp_path / "log.csv", robot, log_map, tmp_path / "out")
    assert expected in str(caught.value)
    assert str(caught.value).startswith(str(tmp_path / "log.csv"))
    assert not (tmp_path / "out").exists()


def test_where_no_column_fits_it_says_how_a_preamble_is_left_out(tmp_path: Path, robot: str) -> None:
    log = tmp_path / "log.csv"
    log.write_text("Axis,logger,of,cell,3,on,Monday\n" + HEAD + text(rows()), encoding="utf-8")
    with pytest.raises(BenchError, match="skip it with --skip-rows N"):
        told(log, robot, BY_NAME, tmp_path / "out")
    told(log, robot, BY_NAME, tmp_path / "out", reading=Reading(skip_rows=1))
    with pytest.raises(BenchError, match="there is no 'qx'") as caught:
        told(
            log,
            robot,
            LogMap({**BY_NAME.columns, "position.arm": "qx"}),
            tmp_path / "other",
            reading=Reading(1),
        )
    assert "--skip-rows" not in str(caught.value)


def test_names_of_few_columns_above_samples_are_no_preamble(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("t;q;;;\n0;1;;;\n1;1;2;2;3\n2;2;2;2;3\n", encoding="utf-8")
    assert set(read_log(tmp_path / "log.csv").vectors) == {"t", "q"}


def test_a_faulty_cell_is_named_by_its_line_below_a_preamble_and_units(tmp_path: Path, robot: str) -> None:
    lines = ("Controller 4.2\n\n" + HEAD + "s,rad,m,rad,A,V,A\n" + text(rows())).splitlines()
    cells = lines[1200].split(",")
    lines[1200] = ",".join([*cells[:4], "ERR", *cells[5:]])
    (tmp_path / "log.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    with pytest.raises(BenchError, match="column ia, line 1201: 'ERR' is not a number"):
        told(tmp_path / "log.csv", robot, BY_NAME, tmp_path / "out")


@pytest.mark.parametrize(
    "content", ["", "\n\n", "# nothing\n", "a,b,c\n", "only words here\nand more words\n"]
)
def test_a_text_without_a_table_is_refused_in_one_line(content: str, tmp_path: Path, robot: str) -> None:
    (tmp_path / "log.txt").write_text(content, encoding="utf-8")
    with pytest.raises(BenchError, match=r"log\.txt: ") as caught:
        told(tmp_path / "log.txt", robot, BY_NAME, tmp_path / "out")
    assert "\n" not in str(caught.value)


def test_skipping_is_refused_where_there_are_no_lines(tmp_path: Path) -> None:
    np.savez(tmp_path / "log.npz", t=np.arange(3.0))
    with pytest.raises(BenchError, match="in a text only"):
        read_log(tmp_path / "log.npz", Reading(skip_rows=2))


@pytest.mark.parametrize(
    ("spelt", "unit"), [("[deg]", "deg"), ("°", "deg"), ("µs", "us"), ("Nm", "N*m"), ("(mA)", "mA")]
)
def test_units_are_known_in_other_spellings(spelt: str, unit: str) -> None:
    assert unit_named(spelt) is UNITS[unit]


def test_torques_of_a_large_robot_are_no_thousandths_of_a_current(tmp_path: Path, robot: str) -> None:
    description = Path(robot) / "robot.toml"
    original = description.read_text(encoding="utf-8")
    (tmp_path / "log.csv").write_text(HEAD + text(rows(ia=1e-3)), encoding="utf-8")
    with pytest.raises(BenchError, match="A or V are expected"):
        told(tmp_path / "log.csv", robot, BY_NAME, tmp_path / "out")
    description.write_text(original.replace('"N*m/A"', '"1"').replace('"N/V"', '"1"'), encoding="utf-8")
    told(tmp_path / "log.csv", robot, BY_NAME, tmp_path / "out")
    assert load_dataset(tmp_path / "out").robot.actuators[0].gain_unit == "N*m/(N*m)"


def fixed(table: np.ndarray) -> str:
    """As controllers write it: two decimals in the last column, decimal commas."""
    lines = (";".join([*map(repr, row[:-1]), f"{row[-1]:.2f}"]) for row in table.tolist())
    return HEAD.replace(",", ";") + "\n".join(lines).replace(".", ",")


def test_a_last_line_that_was_cut_off_is_refused(tmp_path: Path, robot: str) -> None:
    file, whole = tmp_path / "log.csv", fixed(rows())
    file.write_text(whole)
    told(file, robot, BY_NAME, tmp_path / "whole")
    for less in (1, 2, 3):
        file.write_text(whole[:-less])
        with pytest.raises(BenchError, match=r"the last line was cut off: it ends in .*: remove it"):
            told(file, robot, BY_NAME, tmp_path / "out")
    file.write_text(HEAD + text(rows()).rstrip())  # as many digits as each value has
    told(file, robot, BY_NAME, tmp_path / "free")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("end", ["-9.87654321", "1.25e-02"], ids=["digits as needed", "exponent"])
@pytest.mark.parametrize("delimiter", [",", ";", "\t", " "])
def test_a_number_that_was_cut_off_has_fewer_decimals_than_all_others(delimiter: str, end: str) -> None:
    lines = [delimiter.join(["0.1", end if i % 2 else f"{end[:3]}4567{end[3:]}"]) for i in range(50)]
    text = "\n".join(lines)
    refuse_cut_off(Path("log.csv"), text, delimiter)
    for less in (1, 2, len(end) - 2):
        refuse_cut_off(Path("log.csv"), f"{text[:-less]}\n", delimiter)  # a line that was written whole
        with pytest.raises(BenchError, match="the last line was cut off"):
            refuse_cut_off(Path("log.csv"), text[:-less], delimiter)


@pytest.mark.parametrize(
    ("begins", "form"),
    [
        (datetime(2026, 11, 20, 9, 14, 5, 250_000, tzinfo=UTC), "%Y-%m-%dT%H:%M:%S.%fZ"),
        (datetime(2026, 12, 31, 23, 59, 58, tzinfo=UTC), "%Y-%m-%d %H:%M:%S.%f+01:00"),
        (datetime(2026, 12, 31, 23, 59, 58, tzinfo=UTC), "%d.%m.%Y %H:%M:%S.%f"),
        (datetime(2026, 12, 31, 23, 59, 58, tzinfo=UTC), "%H:%M:%S.%f"),
    ],
    ids=["ISO", "over midnight", "German", "time of day, over midnight"],
)
def test_dates_and_times_of_day_become_seconds(
    begins: datetime, form: str, tmp_path: Path, robot: str
) -> None:
    table = rows()
    stamps = [(begins + timedelta(seconds=stamp)).strftime(form) for stamp in table[:, 0].tolist()]
    values = (";".join(map(repr, row)) for row in table[:, 1:].tolist())
    lines = (f"{stamp};{row}\n" for stamp, row in zip(stamps, values, strict=True))
    (tmp_path / "log.csv").write_text(HEAD.replace(",", ";") + "".join(lines))
    found = told(tmp_path / "log.csv", robot, BY_NAME, tmp_path / "out")
    assert ["time of day or a date" in note for _, note in found.notes] == [True]
    (recording,) = load_dataset(tmp_path / "out").recordings
    np.testing.assert_allclose(recording.time, time_stamps(), atol=1e-6)


def test_what_is_no_time_of_day_is_named(tmp_path: Path, robot: str) -> None:
    assert seconds_from_first(["2026-02-30 10:00:00"]) is None
    assert seconds_from_first(["10:00"]) is None
    assert seconds_from_first([]) is None
    later = (f"soon,{row.partition(',')[2]}\n" for row in text(rows()).splitlines())
    (tmp_path / "log.csv").write_text(HEAD + "".join(later))
    with pytest.raises(BenchError, match=r"is not a number"):
        told(tmp_path / "log.csv", robot, BY_NAME, tmp_path / "out")


def test_numbers_without_decimals_and_words_at_the_end_are_not_cut_off() -> None:
    for rows in ("0,395\n1,395\n2,39", "0,1.5\n1,0\n2,1", "0,1.5\n1,2.5\nend of log", "0,1.5", ""):
        refuse_cut_off(Path("log.csv"), rows, ",")


def test_a_name_without_its_unit_is_enough_to_be_asked_whether_it_was_meant(
    tmp_path: Path, robot: str
) -> None:
    file = tmp_path / "log.csv"
    file.write_text(HEAD.replace("t,", "Zeit [ms],") + text(rows()))
    mapped = LogMap({**BY_NAME.columns, "time": "Zeitt"})
    with pytest.raises(BenchError, match=r"there is no 'Zeitt' for time: did you mean 'Zeit \[ms\]'\?"):
        told(file, robot, mapped, tmp_path / "out")
