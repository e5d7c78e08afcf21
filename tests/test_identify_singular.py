"""A log whose positions lead through a singular pose is refused with the recording, the time and what helps."""

from dataclasses import replace

import numpy as np
import pytest

from bench import identify
from bench.basics.errors import BenchError
from bench.signals.settings import FilterSettings
from bench.viewer.body_motion import recorded_motion
from tests.report_kit import dataset


@pytest.mark.parametrize("command", ["identify", "view"])
def test_the_refusal_says_what_to_check_and_how_to_leave_the_part_out(command):
    data = dataset()
    first = data.recordings[0]
    away = np.linspace(0.0, 3.0, len(first.time))[:, None] * [-1.0, 1.0]
    wrong = replace(first, position=first.position + away)
    with pytest.raises(BenchError) as refused:
        if command == "view":
            recorded_motion(data.robot, wrong, FilterSettings(position_cutoff=20.0, decimation=10))
        else:
            identify(replace(data, recordings=(wrong, *data.recordings[1:])))
    message = str(refused.value)
    assert message.startswith(f"{first.name}: t = ")
    assert "units, signs and zeros" in message
    assert "`exclude = [[start, end]]`" in message
