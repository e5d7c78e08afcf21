"""How far the gains move if the drives differ with and without payload: forecast, and done."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identification.finding import Code
from bench.identification.finding_words import sentence
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import as_dataset
from tests.hidden_kit import plain


def identified(dataset):
    return identify(prepare(problem_of(dataset)))


def warmer(dataset, share):
    """The drives give less for their current in recordings with payload."""
    recordings = tuple(
        replace(one, current=one.current * (1.0 + share)) if one.payload else one
        for one in dataset.recordings
    )
    return replace(dataset, recordings=recordings)


@pytest.mark.parametrize("robot", ["five_bar", "orthoglide"])
def test_the_move_that_is_forecast_is_the_one_that_warmer_drives_make(robot: str):
    dataset = as_dataset(plain(robot))
    before = identified(dataset)
    (finding,) = [one for one in before.findings if one.code is Code.GAINS_ASSUMED_EQUAL]
    (joint,), drift = finding.names, finding.numbers["drift"]
    after = identified(warmer(dataset, drift))
    moves = {
        name: abs(after.drive_gains[name].value / gain.value - 1.0)
        for name, gain in before.drive_gains.items()
    }
    assert joint == max(moves, key=lambda name: moves[name])
    assert finding.numbers["move"] == pytest.approx(moves[joint], rel=0.02)
    assert moves[joint] > before.drive_gains[joint].std / before.drive_gains[joint].value
    assert "as of magnets 1 K warmer" in sentence(finding)


def test_nothing_is_forecast_where_noise_is_larger_or_all_recordings_are_alike():
    dataset = as_dataset(plain("five_bar"))
    noise = np.random.default_rng(1)
    loud = tuple(
        replace(one, current=one.current + noise.normal(0.0, 1.0, one.current.shape))
        for one in dataset.recordings
    )
    for other in (
        replace(dataset, recordings=loud),
        replace(dataset, recordings=tuple(one for one in dataset.recordings if not one.payload)),
    ):
        assert Code.GAINS_ASSUMED_EQUAL not in {one.code for one in identified(other).findings}
