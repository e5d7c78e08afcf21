"""Too few equations: what stands still, or how long or how fast sampled the logs have to be."""

from dataclasses import replace

import numpy as np
import pytest

from bench.api.diagnose import diagnose
from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.identification.identify import identify
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.truth.dataset import as_dataset
from bench.truth.simulate import Simulation

NOISE = 1e-4  # rad


def with_positions(recording: Recording, joints: list[int]) -> Recording:
    """The recording with joints that stand still: their encoders show noise."""
    position = recording.position.copy()
    noise = np.random.default_rng(5).normal(size=(len(position), len(joints)))
    position[:, joints] = position[0, joints] + NOISE * noise
    return replace(recording, position=position)


def refusal(dataset: Dataset, recordings: list[Recording]) -> str:
    few = replace(dataset, recordings=tuple(recordings), payloads={})
    with pytest.raises(BenchError) as caught:
        identify(prepare(problem_of(few, ["viscous_friction", "coulomb_friction"])))
    said = str(caught.value)
    assert "\n" not in said
    assert " are too few for " in said
    return said


def test_joints_that_stand_still_are_named(five_bar_simulation: Simulation) -> None:
    dataset = as_dataset(five_bar_simulation)
    log = replace(dataset.recordings[0], payload=None)
    said = refusal(dataset, [with_positions(log, [0, 1])])
    assert "left and right stand still, their positions show only noise" in said
    assert said.endswith("record motions that keep all joints moving")


def test_a_diagnosis_says_how_long_a_log_has_to_be(five_bar_simulation: Simulation) -> None:
    dataset = as_dataset(five_bar_simulation)
    log = dataset.recordings[0]
    short = replace(dataset, recordings=(log.part(slice(1000, 1300)),))
    with pytest.raises(
        BenchError, match=r"has 300 samples, the last 90 of which are too few .* at least 334 samples"
    ):
        diagnose(short)


def test_logs_that_are_too_short_or_too_slow_are_told_what_would_do(five_bar_simulation: Simulation) -> None:
    dataset = as_dataset(five_bar_simulation)
    log = replace(dataset.recordings[0], payload=None)
    step = round(log.rate / 10.0)
    slow = replace(
        log, time=log.time[::step], position=log.position[::step], current=log.current[::step], extra={}
    )
    said = refusal(dataset, [slow])
    seconds, rate = np.ptp(slow.time), slow.rate
    assert f"{seconds:.3g} s of log at {rate:.3g} Hz are too little" in said
    equations, needed = int(said.split(": ")[1].split()[0]), int(said.split("at least ")[1].split()[0])
    longer = needed / max(equations, 1)
    assert said.endswith(
        f"record such motions for {np.ceil(longer * seconds):.0f} s, or log them at {np.ceil(longer * rate):.0f} Hz"
    )
