"""What is said of a time column: its unit, its rate, and the stretches between its gaps."""

from ast import literal_eval
from pathlib import Path

import numpy as np
import pytest

from bench.basics.files.recording_fault import Remedy
from bench.dataset.logs.segments import UNCUT, cut
from bench.dataset.recording_faults import _between_gaps, _left_out
from bench.dataset.sampling import on_uniform_grid, repeated_rows, time_fault


@pytest.mark.parametrize(
    ("step", "said", "remedy"),
    [
        (0.1, "steps by 0.1 s, 10 Hz: too slow", None),
        (0.2, "steps by 0.2 s, 5 Hz: too slow", None),
        (0.25001, "looks like milliseconds", Remedy.FROM_MILLISECONDS),
        (1.0, "looks like milliseconds", Remedy.FROM_MILLISECONDS),
        (500.0, "looks like microseconds", Remedy.FROM_MICROSECONDS),
        (1e6, "looks like nanoseconds", Remedy.FROM_NANOSECONDS),
    ],
)
def test_a_unit_is_guessed_where_a_controller_of_that_rate_is_usual(step, said, remedy):
    fault = time_fault(step * np.arange(200))
    assert said in fault.what
    assert fault.remedy is remedy


def test_windows_are_offered_that_have_enough_samples():
    lost = np.delete(0.002 * np.arange(600), [0, 1, 200, 202, 203])  # one sample between two gaps
    assert _between_gaps(lost).startswith("window = [[0.004, 0.398], [0.408, 1.198]] under its file name")
    short = np.delete(0.002 * np.arange(300), [80, 81, 82, 160, 161, 162, 240, 241, 242])
    assert _between_gaps(short) == "no stretch between gaps has the 100 samples that are needed"


@pytest.mark.parametrize("start", [0.0, 1.7e9], ids=["from zero", "since 1970"])
def test_a_window_and_an_exclusion_that_are_offered_hold_their_samples_whatever_the_clock(start):
    time = start + np.delete(0.002 * np.arange(600), [250, 251])
    ((first, second),) = [literal_eval(_between_gaps(time).split(" = ")[1].split(" under ")[0])]
    for (begin, end), rows in ((first, time[:250]), (second, time[250:])):
        np.testing.assert_array_equal(time[(time >= begin) & (time <= end)], rows)
    said, _ = _left_out(time, np.array([120, 121, 300]))
    spans = literal_eval(said.split(" = ")[1].split(" under ")[0])
    outside = [k for k, stamp in enumerate(time) if any(begin <= stamp <= end for begin, end in spans)]
    assert outside == [120, 121, 300]


@pytest.mark.parametrize("step", [0.0016, 0.0025, 0.0034])
def test_stamps_that_are_cut_to_milliseconds_have_no_gaps(step):
    time = np.floor(1e3 * (0.3e-3 + step * np.arange(2000)) + 1e-6) / 1e3
    assert time_fault(time) is None
    lost = np.delete(time, [900, 901, 902])
    assert time_fault(lost).row == 900
    assert f"samples are {step:.2g} s apart" in time_fault(lost).what


@pytest.mark.parametrize("often", [0.01, 0.004], ids=["a few", "many"])
def test_stamps_that_repeat_ask_for_the_rate(often):
    time = 0.002 * np.arange(1000)
    time[1::5] = time[::5]
    fault = time_fault(np.floor(time / often) * often)
    assert "repeats" in fault.what
    assert "bench import --rate 50" in fault.what
    assert fault.remedy is None


def test_rows_that_a_fast_logger_repeats_are_not_measurements():
    time = 0.005 * np.arange(400)
    smooth = np.stack([np.sin(3.0 * time), np.cos(2.0 * time)], axis=1)
    source = np.maximum.accumulate(np.where(np.arange(400) % 7 == 3, 0, np.arange(400)))
    held = repeated_rows(smooth[source], smooth[source])
    np.testing.assert_array_equal(np.flatnonzero(held), np.arange(3, 400, 7))
    _, position, _, extra = on_uniform_grid(
        time, smooth[source], smooth[source], {"more": np.arange(400.0)}, held
    )
    assert np.abs(position - smooth).max() < 1e-6
    assert np.abs(smooth[source] - smooth).max() > 1e-2
    np.testing.assert_array_equal(extra["more"], np.arange(400.0))


def test_a_robot_that_stands_still_repeats_nothing():
    values = np.zeros((400, 2))
    values[200:] = np.sin(0.01 * np.arange(200))[:, None]
    assert not repeated_rows(values, values).any()


@pytest.mark.parametrize(
    ("late", "parts", "gap"),
    [
        ([0], 1, 0.02),
        ([0], 1, 1.7e9),
        ([10_000], 2, 0.02),
        ([10_000], 1, 60.0),
        (list(range(200, 20_000, 200)), 1, 0.02),
    ],
    ids=["first", "first at zero", "one", "one of a minute", "many"],
)
def test_a_gap_costs_that_place_and_not_the_log(late, parts, gap):
    """Of 40 s; where much is lost, or so often that no piece is long enough, the log stays whole, and is refused."""
    steps = np.full(20_000, 0.002)
    steps[late] = gap
    time = np.concatenate(([0.0], np.cumsum(steps)))
    segments, notes = cut(Path("log.csv"), {"time": time}, "identify", "log.csv", UNCUT)
    assert len(segments) == parts
    assert sum(len(segment.columns["time"]) for segment in segments) >= 0.99 * time.size
    assert bool(notes) == (len(late) == 1 and gap != 60.0)
