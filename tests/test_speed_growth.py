"""How cost grows: the exponent of known series, and a figure and numbers that can be read again."""

import json

import pytest

from bench.benchmarks.speed import growth
from bench.benchmarks.speed.long_log import write_long_dataset
from bench.dataset.dataset import load_dataset

pytestmark = pytest.mark.pictures


def test_the_exponent_is_that_of_the_power_law():
    assert growth.Growth("", "", (1, 10, 100), (2.0, 20.0, 200.0)).exponent == pytest.approx(1.0)
    assert growth.Growth("", "", (2, 4, 8), (1.0, 8.0, 64.0)).exponent == pytest.approx(3.0)


def test_series_are_drawn_and_kept(tmp_path, monkeypatch):
    monkeypatch.setattr(growth, "RESULT", tmp_path / "growth.json")
    monkeypatch.setattr(growth, "PICTURE", tmp_path / "growth.png")
    series = [
        growth.Growth("identify", "samples", (1, 2, 4), (1.0, 2.0, 4.0)),
        growth.Growth("diagnose", "motors", (1, 2, 3), (1.0, 4.0, 9.0)),
    ]
    growth.keep(series)
    rows = json.loads((tmp_path / "growth.json").read_text())
    assert [(row["command"], row["of"], row["exponent"]) for row in rows] == [
        ("identify", "samples", pytest.approx(1.0)),
        ("diagnose", "motors", pytest.approx(2.0)),
    ]
    assert (tmp_path / "growth.png").stat().st_size > 0
    drawing = growth.growth_figure(series)
    assert [axes.get_xlabel() for axes in drawing.axes] == ["samples", "motors"]


def test_a_long_log_passes_the_checks_of_recordings(tmp_path):
    dataset = load_dataset(write_long_dataset(tmp_path / "d", 65.0))
    assert [len(one.time) for one in dataset.recordings] == [65_000, 65_000]
    assert [one.payload for one in dataset.recordings] == [None, "disc"]
