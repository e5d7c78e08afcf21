"""Broken recordings: files, cells, time and signals."""

import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from bench.dataset.recording import write_table
from tests.broken_kit import CSV, PARQUET, broken, change_column, edit, edit_lines, read_columns, set_cell
from tests.good_data import COUNT

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


@broken(CSV, "the last line was cut off", "remove it")
def csv_cut_off_in_a_number(folder: Path) -> None:
    lines = (folder / CSV).read_text().splitlines()
    rows = [
        ",".join([*cells[:-1], f"{float(cells[-1]):.3f}"])
        for cells in (line.split(",") for line in lines[1:])
    ]
    (folder / CSV).write_text("\n".join([lines[0], *rows])[:-2])


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


@broken(PARQUET, "not a complete Parquet file")
def parquet_truncated(folder: Path) -> None:
    content = (folder / PARQUET).read_bytes()
    (folder / PARQUET).write_bytes(content[: len(content) // 2])


@broken(PARQUET, "not a complete Parquet file")
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
