"""A large log: its columns are seen from pieces of it, and it is read in blocks; a small one stands for it."""

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.basics.files import csv_text, table
from bench.dataset import recording
from bench.dataset.logs import columns as log_columns
from bench.dataset.logs.columns import LogMap
from bench.dataset.logs.importing import LogRequest, import_log
from bench.dataset.logs.log_file import AS_FOUND, read_log

ROWS = 3000
NAMES = ["t", "q1", "q2", "i1", "i2"]
NEEDED = ["time", "position.left", "position.right", "current.left", "current.right"]


@pytest.fixture
def small(monkeypatch):
    """A log of some hundred kilobytes is a large one."""
    for module, name, size in (
        (log_columns, "LARGE", 1 << 14),
        (log_columns, "HEAD", 1 << 12),
        (log_columns, "PIECE", 1 << 9),
        (table, "BLOCK", 1 << 14),
        (csv_text, "KEPT", 1 << 10),
        (recording, "WRITTEN", 700),
    ):
        monkeypatch.setattr(module, name, size)


def columns():
    time = np.arange(ROWS) * 5.0
    wave = np.sin(1e-3 * time)
    return [time, -137.0 + 20.0 * wave, -40.0 + 20.0 * wave, 0.3 * wave, np.cos(1e-3 * time)]


def write(path, change=lambda lines: None):
    """The log, with its unit row; change: what is done to its lines."""
    rows = np.column_stack(columns()).tolist()
    lines = ["t;q1;q2;i1;i2", "ms;deg;deg;A;A"]
    lines += [";".join(repr(value).replace(".", ",") for value in row) for row in rows]
    change(lines)
    path.write_text("\r\n".join(lines) + "\r\n")
    return path


def test_the_columns_of_a_large_log_are_seen_from_pieces(tmp_path, small):
    log = write(tmp_path / "log.csv")
    seen, whole = log_columns.glimpse(log, AS_FOUND), read_log(log)
    assert list(seen.vectors) == list(whole.vectors)
    assert seen.units == whole.units
    assert "255 pieces" in seen.notes[-1]
    for name, values in seen.vectors.items():
        assert values.size < 2 * ROWS
        assert set(values) <= set(whole.vectors[name])
    assert seen.vectors["t"][0] == 0.0
    assert seen.vectors["t"].max() > 0.99 * whole.vectors["t"].max()


def test_a_fault_between_the_lines_is_told_as_of_the_whole_log(tmp_path, small):
    def cut_short(lines):
        lines[2001:] = [line.rpartition(";")[0] for line in lines[2001:]]

    log = write(tmp_path / "log.csv", cut_short)
    with pytest.raises(BenchError, match="line 2002: has 4 values, the header names 5"):
        log_columns.glimpse(log, AS_FOUND)


def test_blocks_and_pieces_give_what_one_read_gives(tmp_path, monkeypatch):
    def odd(lines):
        lines[1500] = lines[1500].rpartition(";")[0] + ";1_0"  # only Python reads it as a number
        lines[4:4] = [""]

    log = write(tmp_path / "log.csv", odd)
    at_once = read_log(log)
    monkeypatch.setattr(table, "BLOCK", 1 << 12)
    monkeypatch.setattr(csv_text, "KEPT", 1 << 10)
    in_blocks = read_log(log)
    assert in_blocks.texts == at_once.texts == ["i2"]
    for name in NAMES:
        assert np.array_equal(in_blocks.numbers(name), at_once.numbers(name))
    for row in (0, 1, 1497, ROWS - 1):
        assert in_blocks.lines.line(row) == at_once.lines.line(row)
        assert in_blocks.lines.cell(row, 4) == at_once.lines.cell(row, 4)


class Heard:
    """Progress that is written down."""

    def __init__(self):
        self.phases = []

    def phase(self, name, total=None):
        self.phases.append([name, total, 0])

    def advance(self, steps=1):
        self.phases[-1][2] += steps


def test_an_import_tells_its_phases_and_rows(tmp_path, small):
    log = write(tmp_path / "log.csv")
    heard = Heard()
    map_ = LogMap(dict(zip(NEEDED, NAMES, strict=True)))
    import_log("five_bar", LogRequest(log, map_), tmp_path / "data", progress=heard)
    assert heard.phases == [
        ["reading log.csv", None, 0],
        ["checking log.csv", None, 0],
        ["writing the recordings", ROWS, ROWS],
    ]
    found = read_log(tmp_path / "data" / "log.csv")
    time, left, *_ = columns()
    assert np.array_equal(found.vectors["time"], time * 1e-3)
    assert np.array_equal(found.vectors["position.left"], left * (np.pi / 180))
