"""Broken datasets and robots: each a good dataset with one thing spoilt, and what its error must name.

BROKEN maps a name to (spoil, expected): `spoil(folder)` breaks the dataset that
`tests.good_data.write_good_dataset(folder)` wrote; every text of `expected` must stand in the one-line error.
"""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bench.recording import write_table
from tests.good_data import COUNT

CSV = "unloaded.csv"
PARQUET = "loaded.parquet"
Spoil = Callable[[Path], None]
BROKEN: dict[str, tuple[Spoil, tuple[str, ...]]] = {}


def broken(*expected: str) -> Callable[[Spoil], Spoil]:
    def register(spoil: Spoil) -> Spoil:
        BROKEN[spoil.__name__] = (spoil, expected)
        return spoil

    return register


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert old in text, f"{old!r} is not in {path}"
    path.write_text(text.replace(old, new, 1), encoding="utf-8")


def edit_lines(path: Path, change: Callable[[list[str]], None]) -> None:
    lines = path.read_text(encoding="utf-8").splitlines()
    change(lines)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def set_cell(folder: Path, line: int, column: str, cell: str) -> None:
    """Replace one cell of the CSV; line 1 is the header."""

    def change(lines: list[str]) -> None:
        cells = lines[line - 1].split(",")
        cells[lines[0].split(",").index(column)] = cell
        lines[line - 1] = ",".join(cells)

    edit_lines(folder / CSV, change)


def read_columns(path: Path) -> dict[str, np.ndarray]:
    if path.suffix == ".parquet":
        table = pq.read_table(path)
        return {name: table[name].to_numpy().copy() for name in table.column_names}
    lines = path.read_text().splitlines()
    values = np.array([[float(cell) for cell in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), values.T.copy(), strict=True))


def change_column(
    folder: Path, column: str, change: Callable[[np.ndarray], np.ndarray], file: str = CSV
) -> None:
    columns = read_columns(folder / file)
    columns[column] = change(columns[column])
    write_table(folder / file, columns)


# --- dataset.toml -------------------------------------------------------------------------------------------


@broken("dataset.toml")
def no_dataset_toml(folder: Path) -> None:
    (folder / "dataset.toml").unlink()


@broken("dataset.toml", "line 1")
def dataset_toml_does_not_parse(folder: Path) -> None:
    edit(folder / "dataset.toml", "robot = ", "robot : ")


@broken("dataset.toml", "recordings[1].purpose", "unknown")
def unknown_key(folder: Path) -> None:
    edit(folder / "dataset.toml", 'payload = "disc"', 'purpose = "disc"')


@broken("dataset.toml", "robot", "missing")
def robot_key_missing(folder: Path) -> None:
    edit(folder / "dataset.toml", 'robot = "./robot"', "")


@broken("nobody")
def robot_unknown(folder: Path) -> None:
    edit(folder / "dataset.toml", "./robot", "nobody")


@broken("dataset.toml", "recordings[0].use", "identify", "fit")
def use_unknown(folder: Path) -> None:
    edit(folder / "dataset.toml", '"identify"', '"fit"')


@broken("dataset.toml", "recordings")
def no_recordings(folder: Path) -> None:
    text = (folder / "dataset.toml").read_text()
    (folder / "dataset.toml").write_text(text.split("[[recordings]]")[0])


@broken("dataset.toml", "recordings[0].file", "elsewhere.csv")
def recording_file_missing(folder: Path) -> None:
    edit(folder / "dataset.toml", CSV, "elsewhere.csv")


@broken("dataset.toml", "recordings[1].file", CSV, "twice")
def recording_listed_twice(folder: Path) -> None:
    edit(folder / "dataset.toml", PARQUET, CSV)


@broken("dataset.toml", "recordings[1].payload", "'disk'", "disc")
def payload_undefined(folder: Path) -> None:
    edit(folder / "dataset.toml", 'payload = "disc"', 'payload = "disk"')


@broken("dataset.toml", "payloads.disc.mass", "positive", "-0.5")
def payload_mass_negative(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", "mass = -0.5")


@broken("dataset.toml", "payloads.disc.mass", "0.5 kg")
def payload_mass_is_text(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", 'mass = "0.5 kg"')


@broken("dataset.toml", "payloads.disc.mass", "nan")
def payload_mass_nan(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", "mass = nan")


@broken("dataset.toml", "payloads.disc.center_of_mass", "3")
def payload_center_of_two_numbers(folder: Path) -> None:
    edit(folder / "dataset.toml", "[0.0, 0.0, 0.02]", "[0.0, 0.02]")


@broken("dataset.toml", "payloads.disc.center_of_mass", "metres")
def payload_center_in_millimetres(folder: Path) -> None:
    edit(folder / "dataset.toml", "[0.0, 0.0, 0.02]", "[0.0, 0.0, 20.0]")


@broken("dataset.toml", "payloads.disc.inertia", "not positive")
def payload_inertia_indefinite(folder: Path) -> None:
    edit(folder / "dataset.toml", "0.002, 0.0, 0.0, 0.0]", "0.002, 0.0, 0.0, 0.5]")


@broken("dataset.toml", "payloads.disc.inertia", "triangle")
def payload_inertia_impossible(folder: Path) -> None:
    edit(folder / "dataset.toml", "[0.001, 0.001, 0.002", "[0.001, 0.001, 0.005")


@broken("dataset.toml", "payloads.disc.weight", "unknown")
def payload_key_unknown(folder: Path) -> None:
    edit(folder / "dataset.toml", "mass = 0.5", "weight = 0.5")


@broken("dataset.toml", "effects", "my_effect.py")
def effect_file_missing(folder: Path) -> None:
    edit(folder / "dataset.toml", 'robot = "./robot"', 'robot = "./robot"\neffects = ["my_effect.py"]')


@broken("dataset.toml", "recordings[0].accept", "everything")
def accepts_an_unknown_check(folder: Path) -> None:
    edit(folder / "dataset.toml", 'use = "identify"', 'use = "identify"\naccept = ["everything"]')


# --- the robot ----------------------------------------------------------------------------------------------


@broken("robot.toml", "gain_units", "unknown")
def robot_key_unknown(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", "gain_unit =", "gain_units =")


@broken("robot.toml", "gone.xml")
def robot_model_missing(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", "robot.xml", "gone.xml")


@broken("robot.xml")
def robot_model_does_not_compile(folder: Path) -> None:
    edit(folder / "robot" / "robot.xml", "</body>", "</bodi>")


@broken("robot.toml", "elbow")
def robot_joint_not_in_model(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '"wheel"', '"elbow"')


@broken("robot.toml", "floating", "free")
def robot_drives_a_free_joint(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '"wheel"', '"floating"')


@broken("robot.toml", "gain_unit", "rail", "slide")
def robot_gain_unit_of_the_wrong_kind(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '"N/V"', '"N*m/V"')


@broken("robot.toml", "gain", "-3.0")
def robot_gain_negative(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", "gain = 3.0", "gain = -3.0")


@broken("robot.toml", "flange")
def robot_tool_site_not_in_model(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", 'site = "tool"', 'site = "flange"')


@broken("dataset.toml", "recordings[1].payload", "tool")
def payload_without_a_tool(folder: Path) -> None:
    edit(folder / "robot" / "robot.toml", '[tool]\nsite = "tool"\n', "")


# --- files that are not what they should be -----------------------------------------------------------------


@broken(CSV, "empty")
def csv_empty(folder: Path) -> None:
    (folder / CSV).write_bytes(b"")


@broken(CSV, "no rows")
def csv_header_only(folder: Path) -> None:
    edit_lines(folder / CSV, lambda lines: lines.__delitem__(slice(1, None)))


@broken(CSV, "line 1", "header")
def csv_without_header(folder: Path) -> None:
    edit_lines(folder / CSV, lambda lines: lines.__delitem__(0))


@broken(CSV, "not a text file")
def csv_is_binary(folder: Path) -> None:
    (folder / CSV).write_bytes(bytes(range(256)) * 40)


@broken(CSV, "Parquet")
def csv_is_a_parquet_file(folder: Path) -> None:
    (folder / CSV).write_bytes((folder / PARQUET).read_bytes())


@broken(CSV, "UTF-16")
def csv_is_utf16(folder: Path) -> None:
    text = (folder / CSV).read_text()
    (folder / CSV).write_text(text, encoding="utf-16")


@broken(CSV, "column current.rail", "2 times")
def csv_column_twice(folder: Path) -> None:
    edit(folder / CSV, "current.wheel", "current.rail")


@broken(CSV, "current.wheel", "amps.wheel")
def csv_column_missing(folder: Path) -> None:
    edit(folder / CSV, "current.wheel", "amps.wheel")


@broken(CSV, "position.arm", "'Position.arm' meant")
def csv_column_misspelt(folder: Path) -> None:
    edit(folder / CSV, "position.arm", "Position.arm")


@broken(CSV, "line 2001", "3 values", "7")
def csv_cut_in_the_last_line(folder: Path) -> None:
    def cut(lines: list[str]) -> None:
        lines[-1] = ",".join(lines[-1].split(",")[:3])

    edit_lines(folder / CSV, cut)


@broken(CSV, "line 2", "14 values", "decimal comma")
def csv_with_decimal_commas_between_commas(folder: Path) -> None:
    def comma(lines: list[str]) -> None:
        lines[1:] = [re.sub(r"\.", ",", line) for line in lines[1:]]

    edit_lines(folder / CSV, comma)


@broken(CSV, "column time, line 2", "'s'")
def csv_with_a_line_of_units(folder: Path) -> None:
    edit_lines(folder / CSV, lambda lines: lines.insert(1, "s,rad,m,rad,A,V,A"))


@broken(PARQUET, "not a whole Parquet file")
def parquet_truncated(folder: Path) -> None:
    content = (folder / PARQUET).read_bytes()
    (folder / PARQUET).write_bytes(content[: len(content) // 2])


@broken(PARQUET, "not a whole Parquet file")
def parquet_is_garbage(folder: Path) -> None:
    (folder / PARQUET).write_bytes(bytes(range(256)) * 40)


@broken(PARQUET, "column time", "string")
def parquet_time_is_text(folder: Path) -> None:
    columns = read_columns(folder / PARQUET)
    text = pa.array([str(t) for t in columns.pop("time")])
    pq.write_table(pa.table({"time": text, **columns}), folder / PARQUET)


@broken("loaded.xlsx", ".csv")
def recording_suffix_unknown(folder: Path) -> None:
    (folder / PARQUET).rename(folder / "loaded.xlsx")
    edit(folder / "dataset.toml", PARQUET, "loaded.xlsx")


# --- cells --------------------------------------------------------------------------------------------------


@broken(CSV, "column position.rail, line 17", "'NaN'")
def cell_nan(folder: Path) -> None:
    set_cell(folder, 17, "position.rail", "NaN")


@broken(CSV, "column current.arm, line 1203", "'-inf'")
def cell_infinite(folder: Path) -> None:
    set_cell(folder, 1203, "current.arm", "-inf")


@broken(CSV, "column current.wheel, line 44", "empty", "1 more")
def cells_empty(folder: Path) -> None:
    set_cell(folder, 44, "current.wheel", "")
    set_cell(folder, 45, "current.wheel", "")


@broken(CSV, "column position.arm, line 1999", "'overflow'", "not a number")
def cell_text(folder: Path) -> None:
    set_cell(folder, 1999, "position.arm", "overflow")


@broken(CSV, "column current.rail, line 104", "'nan'")
def cell_nan_after_blank_lines(folder: Path) -> None:
    set_cell(folder, 101, "current.rail", "nan")
    edit_lines(folder / CSV, lambda lines: lines.__setitem__(slice(50, 50), [""] * 3))


@broken(PARQUET, "column current.rail, row 0", "nan")
def parquet_nan(folder: Path) -> None:
    def spoil(values: np.ndarray) -> np.ndarray:
        values[0] = np.nan
        return values

    change_column(folder, "current.rail", spoil, PARQUET)


@broken(PARQUET, "column position.wheel, row 5", "empty")
def parquet_null(folder: Path) -> None:
    columns = read_columns(folder / PARQUET)
    values = columns.pop("position.wheel").tolist()
    values[5] = None
    pq.write_table(pa.table({**columns, "position.wheel": pa.array(values)}), folder / PARQUET)


# --- time ---------------------------------------------------------------------------------------------------


@broken(CSV, "column time, line 12", "repeats")
def time_repeats(folder: Path) -> None:
    set_cell(folder, 12, "time", "0.018")


@broken(CSV, "column time, line 12", "goes back")
def time_goes_back(folder: Path) -> None:
    set_cell(folder, 12, "time", "0.0101")


@broken(CSV, "column time", "rounded")
def time_rounded_to_hundredths(folder: Path) -> None:
    change_column(folder, "time", lambda t: np.floor(t * 100) / 100)


@broken(CSV, "column time, line 802", "gap of 0.018 s")
def time_gap(folder: Path) -> None:
    edit_lines(folder / CSV, lambda lines: lines.__delitem__(slice(801, 809)))


@broken(PARQUET, "column time, row 700", "gap of 0.004 s", "2 more")
def time_lost_samples(folder: Path) -> None:
    columns = read_columns(folder / PARQUET)
    kept = np.delete(np.arange(columns["time"].size), [700, 1200, 1300])
    write_table(folder / PARQUET, {name: values[kept] for name, values in columns.items()})


@broken(CSV, "column time", "milliseconds")
def time_in_milliseconds(folder: Path) -> None:
    change_column(folder, "time", lambda t: 1e3 * t)


@broken(CSV, "column time", "microseconds")
def time_in_microseconds(folder: Path) -> None:
    change_column(folder, "time", lambda t: 1e6 * t)


@broken(PARQUET, "column time", "nanoseconds")
def time_in_nanoseconds(folder: Path) -> None:
    change_column(folder, "time", lambda t: np.round(1e9 * t), PARQUET)


@broken(PARQUET, "column time", "hours")
def time_in_hours(folder: Path) -> None:
    change_column(folder, "time", lambda t: t / 3600.0, PARQUET)


@broken(CSV, "column time", "50 samples")
def too_short(folder: Path) -> None:
    edit_lines(folder / CSV, lambda lines: lines.__delitem__(slice(51, None)))


# --- signals ------------------------------------------------------------------------------------------------


@broken(CSV, "column position.arm", "degrees")
def position_in_degrees(folder: Path) -> None:
    change_column(folder, "position.arm", np.degrees)


@broken(CSV, "column position.wheel", "degrees")
def position_in_degrees_without_a_range(folder: Path) -> None:
    change_column(folder, "position.wheel", np.degrees)


@broken(PARQUET, "column position.rail", "millimetres")
def position_in_millimetres(folder: Path) -> None:
    change_column(folder, "position.rail", lambda q: 1e3 * q, PARQUET)


@broken(CSV, "column position.arm, line", "range [-2, 2]")
def position_beyond_the_limits(folder: Path) -> None:
    change_column(folder, "position.arm", lambda q: q + 1.8)


@broken(CSV, "column position.rail", "constant (0.1")
def position_constant(folder: Path) -> None:
    change_column(folder, "position.rail", lambda q: np.full_like(q, 0.1))


@broken(CSV, "column position.rail", "does not move")
def position_only_noise(folder: Path) -> None:
    noise = 1e-5 * np.random.default_rng(3).standard_normal(COUNT)
    change_column(folder, "position.rail", lambda _: np.round(0.1 + noise, 5))


@broken(PARQUET, "column current.arm", "constant (0")
def current_constant(folder: Path) -> None:
    change_column(folder, "current.arm", np.zeros_like, PARQUET)


@broken(CSV, "column current.arm", "thousandths")
def current_in_milliamperes(folder: Path) -> None:
    change_column(folder, "current.arm", lambda i: 1e3 * i)


@broken(CSV, "column current.wheel, line", "clipped", "extreme")
def current_saturated(folder: Path) -> None:
    change_column(folder, "current.wheel", lambda i: np.minimum(i, 0.8 * i.max()))


@broken(PARQUET, "column current.wheel, row", "clipped", "extreme, -")
def current_saturated_and_quantised(folder: Path) -> None:
    change_column(folder, "current.wheel", lambda i: np.round(np.maximum(i, 0.85 * i.min()), 2), PARQUET)


@broken(CSV, "column position.wheel, line 902", "stuck", "200 samples")
def encoder_frozen(folder: Path) -> None:
    def freeze(q: np.ndarray) -> np.ndarray:
        q[900:1100] = q[900]
        return q

    change_column(folder, "position.wheel", freeze)


@broken(PARQUET, "column position.arm, row 1000", "stuck")
def encoder_dead_from_the_middle(folder: Path) -> None:
    def freeze(q: np.ndarray) -> np.ndarray:
        q[1000:] = q[1000]
        return q

    change_column(folder, "position.arm", freeze, PARQUET)


@broken(CSV, "column position.arm, line 502", "spikes by", "1 more")
def encoder_glitches(folder: Path) -> None:
    def spike(q: np.ndarray) -> np.ndarray:
        q[[500, 1500]] += 0.3
        return q

    change_column(folder, "position.arm", spike)


@broken(CSV, "column position.rail, line 902", "jumps by 0.049")
def encoder_loses_counts(folder: Path) -> None:
    def jump(q: np.ndarray) -> np.ndarray:
        q[900:] += 0.05
        return q

    change_column(folder, "position.rail", jump)


@broken(CSV, "column position.wheel, line", "unwrap")
def angle_wrapped(folder: Path) -> None:
    change_column(folder, "position.wheel", lambda q: (q - np.median(q)) % (2 * np.pi))


@broken(CSV, "column current.arm, line 1501", "spikes to")
def current_spike(folder: Path) -> None:
    set_cell(folder, 1501, "current.arm", "1e6")
