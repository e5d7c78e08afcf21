"""A log whose positions lead through a singular pose is refused with the recording, the time and what helps."""

from dataclasses import replace

import numpy as np
import pytest

from bench import identify
from bench.basics.errors import BenchError
from tests.report_kit import dataset


def test_the_refusal_says_what_to_check_and_how_to_leave_the_part_out():
    data = dataset()
    first = data.recordings[0]
    away = np.linspace(0.0, 3.0, len(first.time))[:, None] * [-1.0, 1.0]
    wrong = replace(data, recordings=(replace(first, position=first.position + away), *data.recordings[1:]))
    with pytest.raises(BenchError) as refused:
        identify(wrong)
    message = str(refused.value)
    assert message.startswith(f"{first.name}: t = ")
    assert "units, signs and zeros" in message
    assert "`exclude = [[start, end]]`" in message
