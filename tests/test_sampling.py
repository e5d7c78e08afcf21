"""What is said of a time column: its unit, its rate, and the stretches between its gaps."""

import numpy as np
import pytest

from bench.basics.files.recording_fault import Remedy
from bench.dataset.recording_faults import _between_gaps
from bench.dataset.sampling import time_fault


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
