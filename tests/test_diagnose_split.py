"""What a diagnosis holds out: the last part of the motion, wherever a log goes on at rest."""

from dataclasses import replace

import numpy as np
import pytest

from bench.basics.errors import BenchError
from bench.dataset.dataset import Dataset
from bench.dataset.recording import Recording
from bench.dataset.robot import load_robot
from bench.diagnosis.split import with_held_out_parts
from bench.diagnosis.split_problem import split_and_fitted
from bench.identification.problem import problem_of
from tests.shown import RATE, dataset_of


def fitted_only() -> Dataset:
    """Two motions of eight seconds, with the noise of an encoder."""
    dataset = dataset_of(load_robot("five_bar"), duration=8.0)
    logs = []
    for i, log in enumerate(dataset.recordings[:2]):
        noise = np.random.default_rng(i).normal(scale=1e-5, size=log.position.shape)
        logs.append(replace(log, position=log.position + noise))
    return replace(dataset, recordings=tuple(logs))


def resting(log: Recording, before: float, after: float) -> Recording:
    """The log with so many seconds of rest, with the same noise, before and after its motion."""
    count = [round(before * RATE), round(after * RATE)]
    random = np.random.default_rng(7)
    parts = [
        position + random.normal(scale=1e-5, size=(n, log.position.shape[1]))
        for position, n in zip((log.position[0], log.position[-1]), count, strict=True)
    ]
    samples = len(log.time) + sum(count)
    ends = [np.full((n, log.current.shape[1]), 0.5) for n in count]
    return replace(
        log,
        time=log.time[0] + np.arange(samples) / RATE,
        position=np.concatenate((parts[0], log.position, parts[1])),
        current=np.concatenate((ends[0], log.current, ends[1])),
    )


@pytest.mark.parametrize(
    ("before", "after", "fitted"),
    [(0.0, 0.0, 5.6), (0.0, 8.0, 5.6), (2.0, 3.0, 7.6), (0.0, 0.2, 5.74)],
    ids=["no rest", "parked at the end", "rest at both ends", "a short rest"],
)
def test_the_last_part_of_the_motion_is_held_out(before: float, after: float, fitted: float) -> None:
    dataset = fitted_only()
    dataset = replace(dataset, recordings=tuple(resting(log, before, after) for log in dataset.recordings))
    split, share = with_held_out_parts(dataset)
    assert share == 0.3
    for log, first, second in zip(
        dataset.recordings, split.recordings[::2], split.recordings[1::2], strict=True
    ):
        assert (first.use, second.use) == ("identify", "validate")
        assert len(first.time) / RATE == pytest.approx(fitted, abs=0.1)
        assert len(first.time) + len(second.time) == len(log.time)


def test_a_motor_that_only_has_noise_hides_no_rest() -> None:
    dataset = fitted_only()
    logs = [resting(log, 0.0, 8.0) for log in dataset.recordings]
    noise = np.random.default_rng(3).normal(scale=1e-5, size=len(logs[0].time))
    held = [replace(log, position=np.column_stack((log.position[:, 0], 0.3 + noise))) for log in logs]
    split, _ = with_held_out_parts(replace(dataset, recordings=tuple(held)))
    assert len(split.recordings[0].time) / RATE == pytest.approx(5.6, abs=0.1)


def test_recordings_at_rest_judge_nothing() -> None:
    dataset = fitted_only()
    log = dataset.recordings[0]
    still = replace(
        log, name="still.csv", use="validate", position=np.tile(log.position[0], (len(log.time), 1))
    )
    with pytest.raises(
        BenchError, match=r"no joint moves in still\.csv, on which effects are judged: record"
    ):
        split_and_fitted(problem_of(replace(dataset, recordings=(*dataset.recordings, still))))
