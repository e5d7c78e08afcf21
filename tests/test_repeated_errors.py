"""Errors that come again with the motion count once; noise counts every time."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.dataset import Dataset
from bench.identification.autocorrelation_time import autocorrelation_time
from bench.identification.compressed import Stack, compress
from bench.identification.identify import fit
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.solution import Solution
from bench.identification.standard_errors import uncertainty
from bench.scenario.scenario import load_scenario
from bench.signals.returning import Course, rows_until_return
from bench.truth.dataset import as_dataset
from bench.truth.simulate import simulate
from tests.hidden_kit import STEP

ROWS, PERIOD, UNKNOWNS, HARMONICS = 240, 48.4, 4, 16


def waves(random: np.random.Generator, count: int) -> np.ndarray:
    """Random signals (ROWS, count) that return after PERIOD rows."""
    angle = 2.0 * np.pi * np.outer(np.arange(ROWS), np.arange(1, HARMONICS)) / PERIOD
    parts = np.concatenate((np.cos(angle), np.sin(angle)), axis=1)
    return parts @ random.normal(size=(parts.shape[1], count)) / np.sqrt(HARMONICS)


def fitted(columns: np.ndarray, error: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """What an error (ROWS,) does to a fit, and its stated deviations."""
    phi, kappa = columns[:, None, :], np.zeros((ROWS, 1))
    current = error[:, None]
    position = columns[:, :2]
    stack = Stack(
        phi,
        kappa,
        current,
        np.ones((ROWS, 1), bool),
        (0,),
        compress(phi, kappa, current),
        (Course(position),),
    )
    theta = np.linalg.lstsq(columns, error)[0]
    solution = Solution(theta, np.ones(1), np.ones(1), "current", gains_fitted=False)
    covariance = uncertainty(stack, solution, "autocorrelated").covariance
    return theta, np.sqrt(np.diag(covariance)[:UNKNOWNS])


@pytest.mark.parametrize(("repeated", "noise"), [(1.0, 0.0), (0.7, 0.7), (0.0, 1.0)])
def test_deviations_hold_whatever_share_of_the_error_returns(repeated: float, noise: float) -> None:
    random = np.random.default_rng(5)
    ratios = []
    for _ in range(120):
        error = repeated * waves(random, 1)[:, 0] + noise * random.normal(size=ROWS)
        off, std = fitted(waves(random, UNKNOWNS), error)
        ratios.append(off / std)
    ratio = np.sqrt(
        np.mean(np.square(ratios))
    )  # 3 where every row counts, though it says the same five times
    assert 0.9 < ratio < 1.1 + 0.5 * repeated


def test_rows_that_say_the_same_count_once() -> None:
    random = np.random.default_rng(6)
    again, noise = waves(random, 2), random.normal(size=(ROWS, 2))
    alone = autocorrelation_time([again])
    assert autocorrelation_time([again], [PERIOD]) == pytest.approx(alone * ROWS / PERIOD, rel=0.1)
    assert autocorrelation_time([again], [None]) == alone
    assert autocorrelation_time([noise], [PERIOD]) == autocorrelation_time([noise])


def test_a_motion_returns_after_its_period() -> None:
    random = np.random.default_rng(7)
    motion = waves(random, 3)
    assert rows_until_return(motion) == pytest.approx(PERIOD, abs=0.05)
    assert rows_until_return(motion[: round(PERIOD)]) is None
    assert rows_until_return(motion + 0.02 * np.arange(ROWS)[:, None]) is None
    assert rows_until_return(np.ones((ROWS, 2))) is None


def five_periods(hidden: list[dict[str, object]]) -> Dataset:
    """A five-bar that makes a motion of 2 s five times, between a start and a stop of its own."""
    recordings = [
        {"name": "unloaded", "use": "identify", "design": {"seed": 11}},
        {"name": "loaded", "use": "identify", "payload": "disc", "design": {"seed": 12}},
    ]
    motion = {"optimise": False, "duration": 10.0, "base_frequency": 0.5, "harmonics": 3}
    changes = {"design": motion, "recordings": recordings, "hidden": hidden, "step": STEP}
    return as_dataset(simulate(load_scenario("five_bar", changes)))


def deviations(dataset: Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Of the gains, from all of it and from its first 45 %."""
    prepared = prepare(problem_of(dataset))
    parts = (recording.part(slice(0, round(0.45 * len(recording.time)))) for recording in dataset.recordings)
    part = prepare(problem_of(replace(dataset, recordings=tuple(parts)), filters=prepared.settings))
    every, some = (
        np.array([gain.std for gain in fit(problem).drive_gains.values()]) for problem in (prepared, part)
    )
    return every, some


def test_a_motion_made_again_says_no_more_of_gains_where_the_model_lacks_something() -> None:
    saturated = [{"effect": "gain_saturation", "joint": joint, "k": 0.02} for joint in ("left", "right")]
    every, some = deviations(five_periods(saturated))
    assert np.all(every > 0.8 * some)


def test_a_motion_made_again_says_more_where_only_noise_is_left() -> None:
    every, some = deviations(five_periods([]))
    assert np.all(every < 0.8 * some)
