"""Measured logs: gains from different logs agree within the deviations that are stated, and so do known ones."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.dataset.dataset import load_dataset
from bench.identification.identify import fit
from bench.identification.nonlinear import converged
from bench.identification.prepare import prepare
from bench.identification.problem import problem_of
from bench.identification.result import Identification

FRICTION = ("viscous_friction", "coulomb_friction")
LOAD = "load_dependent_friction"
PAIRS = (("identify", "identify", "validate", "validate"), ("validate", "validate", "identify", "identify"))
KNOWN = np.array([11.93, 11.98, 9.84, 10.75, 10.70, 10.68])  # N*m/A: the controller's own, to 2 %


def gains(result: Identification) -> tuple[np.ndarray, np.ndarray]:
    found = result.drive_gains.values()
    return np.array([one.value for one in found]), np.array([one.std for one in found])


@pytest.fixture(scope="module")
def arm_by_logs(measured_data: Path) -> list[Identification]:
    """The arm with friction that grows with the load, from one day's logs and from another's."""
    folder = measured_data / "ur10e"
    if not folder.is_dir():
        pytest.skip("the measured UR10e data are not here (set PARABENCH_DATA)")
    dataset = load_dataset(folder)
    answers = []
    for uses in PAIRS:
        logs = tuple(replace(one, use=use) for one, use in zip(dataset.recordings, uses, strict=True))
        prepared = prepare(problem_of(replace(dataset, recordings=logs), (*FRICTION, LOAD)))
        answers.append(fit(converged(prepared)))
    return answers


def test_gains_of_an_arm_from_two_days_agree_within_twice_their_deviations(arm_by_logs):
    (one, one_std), (other, other_std) = (gains(result) for result in arm_by_logs)
    assert np.all(np.abs(one - other) < 2.0 * np.hypot(one_std, other_std))


def test_what_an_arm_s_model_lacks_is_in_its_deviations(arm_by_logs):
    assert all(result.std_from == "blocks" for result in arm_by_logs)
    value, std = gains(arm_by_logs[0])
    payload_says_much = slice(1, None)  # of the vertical first joint a payload says little
    off = np.abs(value - KNOWN)[payload_says_much]
    assert np.all(off < (2.0 * std + 0.02 * KNOWN)[payload_says_much])


@pytest.fixture(scope="module")
def greased_by_logs(measured_data: Path) -> list[Identification]:
    """The arm with grease that thins, from one day's logs and from another's."""
    folder = measured_data / "ur10e"
    if not folder.is_dir():
        pytest.skip("the measured UR10e data are not here (set PARABENCH_DATA)")
    dataset = load_dataset(folder)
    days = (
        tuple(replace(one, use=use) for one, use in zip(dataset.recordings, uses, strict=True))
        for uses in PAIRS
    )
    return [
        fit(
            prepare(
                problem_of(
                    replace(dataset, recordings=day), ("coulomb_friction", "shear_thinning_friction", LOAD)
                )
            )
        )
        for day in days
    ]


def test_an_arm_s_grease_thins_alike_on_two_days(arm_by_logs, greased_by_logs):
    one, other = (result.effect_parameters["shear_thinning_friction"] for result in greased_by_logs)
    for joint in one:
        for name in ("Fa", "va"):
            a, b = one[joint][name], other[joint][name]
            assert min(a.value, b.value) > 0.0
            assert abs(a.value - b.value) < 2.5 * np.hypot(a.std, b.std), (joint, name)
    for greased, viscous in zip(greased_by_logs, arm_by_logs, strict=True):
        assert greased.error.validate < 0.85 * viscous.error.validate


def test_an_arm_s_gains_with_grease_that_thins(greased_by_logs):
    value, _ = gains(greased_by_logs[0])
    assert np.all(np.abs(value / KNOWN - 1.0) < [0.10, 0.05, 0.05, 0.05, 0.05, 0.05])
