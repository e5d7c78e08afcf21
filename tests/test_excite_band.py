"""Motions keep their currents in the band of a fit: those with narrow peaks are refused, or made smaller."""

from dataclasses import replace

import numpy as np
import pytest

from bench.dataset.robot import load_robot
from bench.excitation import current_band
from bench.excitation.bounds import DESIGN
from bench.excitation.current_band import band_shares
from bench.excitation.design import Movement, design_trajectories
from bench.excitation.experiment.nominal import seen
from bench.excitation.experiment.plan import Aim, plan_experiment
from bench.excitation.experiment.request import ExperimentTable
from bench.model.model import build_model
from bench.model.motion import motion_of
from bench.model.regressor import projected_regressor
from bench.scenario.scenario import home_position
from bench.scenario.trajectory import random_trajectory

BOTH = {"crank": 10.0, "carriage": 10.0}
RATE, FAST = 400.0, {"duration": 5.0, "velocity": BOTH, "acceleration": {"crank": 200.0, "carriage": 200.0}}


@pytest.fixture(scope="module")
def crank_slide():
    return load_robot("crank_slide")


def test_a_narrow_peak_is_out_of_the_band_and_a_wide_one_in_it():
    time = np.arange(2000) / RATE
    trajectory = random_trajectory(1, [0.0], 1.0, 4.0, harmonics=4, base_frequency=0.5, duration=5.0)
    peaks = np.stack([np.exp(-(((time - 2.5) / width) ** 2)) for width in (0.5, 0.02)], axis=1)
    shares = band_shares(10.0 + peaks, RATE, trajectory)
    assert shares[0] < 0.1
    assert shares[1] > 3.0
    np.testing.assert_allclose(shares, band_shares(7.0 * peaks, RATE, trajectory), atol=1e-9)


def test_a_current_that_does_not_vary_has_no_band():
    trajectory = random_trajectory(1, [0.0], 1.0, 4.0, harmonics=4, base_frequency=0.5, duration=5.0)
    rounded = 9.81 + 1e-15 * np.random.default_rng(1).normal(size=(2000, 1))
    for current in (rounded, np.zeros((2000, 1))):
        assert band_shares(current, RATE, trajectory) == pytest.approx(0.0)


def test_a_plan_refuses_a_motion_with_narrow_peaks_and_makes_it_smaller(crank_slide, monkeypatch):
    table = ExperimentTable.model_validate(FAST)
    monkeypatch.setattr(current_band, "DESIGN", replace(DESIGN, current_band=1e3))
    wide = plan_experiment(crank_slide, table, Aim(steps=0))
    monkeypatch.undo()
    search, sharp = wide.search, wide.motions[0].trajectory
    assert (
        band_shares(seen(wide.nominal, wide.motions[0].motion, None).current, search.shape.rate, sharp).max()
        > 1.5
    )
    assert search.tried(sharp, None) is None
    smaller = search.shrunk(sharp, None)
    assert smaller is not None
    assert np.abs(smaller.trajectory.a).max() < np.abs(sharp.a).max()


def test_all_motions_of_a_plan_keep_the_band(crank_slide):
    plan = plan_experiment(crank_slide, ExperimentTable.model_validate(FAST), Aim(steps=8))
    assert len(plan.recordings) == 2
    for recording in plan.recordings:
        current = seen(plan.nominal, recording.proven.tried.motion, recording.payload).current
        assert band_shares(current, plan.search.shape.rate, recording.trajectory).max() <= 1.0


def test_designed_movements_keep_the_band(crank_slide, monkeypatch):
    movement = Movement(
        name="movement",
        fitted=True,
        payload=None,
        center=home_position(crank_slide),
        span=np.array([1.0, 0.1]),
        velocity=np.full(2, 5.0),
        acceleration=np.full(2, 60.0),
        harmonics=6,
        base_frequency=0.25,
        duration=6.0,
        ramp=1.0,
        seed=3,
    )
    movements = [movement, replace(movement, name="check", fitted=False)]
    kept = {name: _share(crank_slide, one) for name, one in _designed(crank_slide, movements).items()}
    assert max(kept.values()) < 1.05
    monkeypatch.setattr(current_band, "DESIGN", replace(DESIGN, current_band=1e3))
    free = {name: _share(crank_slide, one) for name, one in _designed(crank_slide, movements).items()}
    assert max(free.values()) > 1.5


def _designed(robot, movements):
    return design_trajectories(robot, movements).trajectories


def _share(robot, trajectory):
    """Of the torques of bodies as guessed, over the whole movement, at a rate of its own."""
    model = build_model(robot)
    time = np.arange(int(trajectory.duration * RATE)) / RATE
    motion = motion_of(model.geometry, time, *trajectory.evaluate(time))
    torque = projected_regressor(model.geometry, motion, model.base.columns) @ model.guessed
    frequency = np.fft.rfftfreq(len(time), 1.0 / RATE)
    power = np.abs(np.fft.rfft(np.hanning(len(time))[:, None] * (torque - torque.mean(axis=0)), axis=0)) ** 2
    above = power[frequency > 3.0 * trajectory.harmonics * trajectory.base_frequency].sum(axis=0)
    return float(np.sqrt(above / (1e-3 * power.sum(axis=0))).max())
