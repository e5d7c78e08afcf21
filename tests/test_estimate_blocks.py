"""Deviations from the scatter between parts of the recordings: as large as noise makes them, and larger where not."""

from dataclasses import replace

import numpy as np
import pytest

from bench.identification import standard_errors
from bench.identification.compressed import Stack, compress
from bench.identification.identify import identify
from bench.identification.model_json import from_json, to_json
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.scatter import Block, block_scatter, blocks_in
from bench.identification.solution import Solution
from bench.identification.standard_errors import _enlarged, uncertainty
from bench.scenario.scenario import load_scenario
from bench.signals.returning import Course
from bench.truth.dataset import as_dataset
from bench.truth.machine import true_gains
from bench.truth.simulate import Simulation, simulate
from tests.hidden_kit import STEP

ROWS, UNKNOWNS = 800, 6


def scattered(error, jacobian, blocks=16):
    """The scatter of a least-squares fit with these errors."""
    left = error - jacobian @ np.linalg.lstsq(jacobian, error)[0]
    rows = np.array_split(np.arange(len(error)), blocks)
    return block_scatter([Block(jacobian[i].T @ jacobian[i], jacobian[i].T @ left[i]) for i in rows])


def test_of_noise_the_scatter_is_the_covariance_of_least_squares():
    random = np.random.default_rng(1)
    jacobian = random.normal(size=(ROWS, UNKNOWNS)) * np.linspace(0.5, 2.0, ROWS)[:, None]
    known = np.linalg.inv(jacobian.T @ jacobian)
    every = [scattered(random.normal(size=ROWS), jacobian) for _ in range(200)]
    ratio = np.mean([np.diag(one.covariance) / np.diag(known) for one in every], axis=0)
    assert np.all(np.abs(ratio - 1.0) < 0.15)
    assert np.mean([one.beyond(known) for one in every]) <= 0.01


def test_an_error_that_lasts_is_beyond_noise_and_its_deviations_hold():
    random = np.random.default_rng(2)
    within = []
    for _ in range(40):
        jacobian = random.normal(size=(ROWS, UNKNOWNS))
        lasting = np.repeat(
            random.normal(size=(16, UNKNOWNS)), ROWS // 16, axis=0
        )  # other values in every part
        error = 0.1 * random.normal(size=ROWS) + (lasting * jacobian).sum(axis=1)
        scatter = scattered(error, jacobian)
        noise = np.linalg.inv(jacobian.T @ jacobian) * float(error.var())
        assert scatter.beyond(noise)
        off = np.linalg.lstsq(jacobian, error)[0]
        within.append(np.abs(off) < 2.0 * np.sqrt(np.diag(scatter.covariance)))
    assert np.mean(within) > 0.9


def test_blocks_cover_every_row_once_and_are_never_too_short():
    found = list(blocks_in((0, 400, 420), 1000))
    assert [one.start for one in found[1:]] == [one.stop for one in found[:-1]]
    assert (found[0].start, found[-1].stop, len(found)) == (0, 1000, 8 + 1 + 8)
    assert block_scatter([Block(np.eye(2), np.zeros(2))]) is None


def test_wider_deviations_keep_their_correlation():
    own = np.array([[1.0, 0.5], [0.5, 1.0]])
    wide = _enlarged(own, np.diag([9.0, 0.25]))
    assert np.allclose(wide, [[9.0, 1.5], [1.5, 1.0]])


@pytest.fixture(scope="module")
def simulations() -> dict[str, Simulation]:
    recordings = [
        {"name": "unloaded", "use": "identify", "design": {"seed": 11}},
        {"name": "loaded", "use": "identify", "payload": "disc", "design": {"seed": 12}},
    ]
    common = {"design": {"optimise": False, "duration": 10.0}, "recordings": recordings, "step": STEP}
    hidden = {
        "noise": [],
        "saturation": [
            {"effect": "gain_saturation", "joint": joint, "k": 0.02} for joint in ("left", "right")
        ],
    }
    return {
        name: simulate(load_scenario("five_bar", {**common, "hidden": entries}))
        for name, entries in hidden.items()
    }


def test_simulated_noise_keeps_its_deviations(simulations):
    result = identify(prepare(problem_of(as_dataset(simulations["noise"]))))
    assert result.std_from == "noise"
    truth = true_gains(simulations["noise"].scenario)
    for gain, true in zip(result.drive_gains.values(), truth, strict=True):
        assert abs(gain.value - true) < 3.0 * gain.std
        assert gain.std < 1e-3 * true


def test_a_model_file_says_what_deviations_are_from(simulations):
    result = replace(identify(prepare(problem_of(as_dataset(simulations["noise"])))), std_from="blocks")
    content = to_json(result)
    assert content["std_from"] == from_json(content).std_from == "blocks"
    del content["std_from"]
    assert from_json(content).std_from == "noise"


def test_an_unmodelled_saturation_is_not_taken_for_noise(simulations):
    dataset = as_dataset(simulations["saturation"])
    assert identify(prepare(problem_of(dataset))).std_from == "periods"
    never = [recording.part(slice(0, 4500)) for recording in dataset.recordings]  # the motion does not return
    assert identify(prepare(problem_of(replace(dataset, recordings=tuple(never))))).std_from == "blocks"


def test_errors_that_return_with_the_state_are_not_taken_for_noise():
    """A function of the position that the model lacks, in a motion that never returns as a whole."""
    random = np.random.default_rng(3)
    ratios = {False: [], True: []}
    for _ in range(60):
        position = random.uniform(-1.0, 1.0, (ROWS, 1))
        jacobian = position ** np.arange(3)
        steps = random.normal(size=8)[np.floor(4.0 * (position[:, 0] + 1.0)).astype(int)]
        error = steps + 0.3 * random.normal(size=ROWS)
        off = np.linalg.lstsq(jacobian, error)[0]
        for known, each in ratios.items():
            each.append(off / stated(jacobian, error, (Course(position),) if known else ()))
    without, with_states = (float(np.sqrt(np.mean(np.square(ratios[known])))) for known in ratios)
    assert without > 10.0
    assert 0.7 < with_states < 2.0


def test_an_error_that_changes_with_time_does_not_hide_one_of_the_position(monkeypatch):
    """Every scatter is compared with noise, so that their order does not matter."""
    random = np.random.default_rng(5)
    scatters = standard_errors._scatters
    for _ in range(20):
        position, other = random.uniform(-1.0, 1.0, (ROWS, 1)), random.normal(size=(ROWS, 1))
        jacobian = np.hstack((position, position**2, other))
        of_position = random.normal(size=8)[np.floor(4.0 * (position[:, 0] + 1.0)).astype(int)]
        of_time = np.repeat(random.normal(size=8), ROWS // 8) * other[:, 0]
        error = 0.5 * of_position + of_time + random.normal(size=ROWS)
        stds = []
        for order in (1, -1):
            monkeypatch.setattr(
                standard_errors, "_scatters", lambda *a, order=order, **k: scatters(*a, **k)[::order]
            )
            stds.append(stated(jacobian, error, (Course(position),)))
        assert np.allclose(*stds, rtol=1e-12)


def test_few_errors_that_follow_each_other_are_as_uncertain_as_they_say():
    random = np.random.default_rng(4)
    within = []
    for _ in range(300):
        error, jacobian = (smooth(random, columns) for columns in (1, 8))
        off = np.linalg.lstsq(jacobian, error[:, 0])[0]
        within.append(np.abs(off) < 1.96 * stated(jacobian, error[:, 0]))
    assert np.mean(within) > 0.845  # 0.82 by the number of rows, of which few are independent


def smooth(random: np.random.Generator, columns: int) -> np.ndarray:
    """Signals (80, columns) whose neighbours are alike, with a correlation of 0.8."""
    signals = random.normal(size=(80, columns))
    for row in range(1, len(signals)):
        signals[row] = 0.8 * signals[row - 1] + 0.6 * signals[row]
    return signals


def stated(jacobian: np.ndarray, error: np.ndarray, courses: tuple[Course, ...] = ()) -> np.ndarray:
    """Standard errors of a least-squares fit of one motor."""
    phi, kappa, current = jacobian[:, None], np.zeros((len(error), 1)), error[:, None]
    moving = np.ones((len(error), 1), bool)
    stack = Stack(phi, kappa, current, moving, (0,), compress(phi, kappa, current), courses)
    solution = Solution(
        np.linalg.lstsq(jacobian, error)[0], np.ones(1), np.ones(1), "current", gains_fitted=False
    )
    covariance = uncertainty(stack, solution, "autocorrelated").covariance
    return np.sqrt(np.diag(covariance)[: jacobian.shape[1]])
